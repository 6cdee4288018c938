/* Reduces pictures by means over boxes, whose edges may cut pixels: first across, then down. */

#include "core/image/compare.h"

typedef struct shrinking {
  const conic_image *from;
  conic_image *to;
  double *rows; /* as many as the image has, but as wide as the reduced image's */
} shrinking;

/* The part [*begin, *end) of n_from units that is unit i of n_to. */
static void span_of_box(size_t i, int n_from, int n_to, double *begin, double *end) {
  *begin = (double)i * (double)n_from / (double)n_to;
  *end = (double)(i + 1) * (double)n_from / (double)n_to;
}

/* How much of unit k lies in the box. */
static double share_in_span(size_t k, double begin, double end) {
  double first = begin > (double)k ? begin : (double)k, last = end < (double)(k + 1) ? end : (double)(k + 1);
  return last - first;
}

static void shrink_row(void *data, size_t y) {
  const shrinking *work = data;
  size_t width = (size_t)work->to->width;
  const float *from = (const float *)work->from->planes[CONIC_PLANE_RGBA] + 4 * y * (size_t)work->from->width;
  double *row = work->rows + 4 * y * width;
  for (size_t x = 0; x < width; x++) {
    double begin, end, sums[4] = {0};
    span_of_box(x, work->from->width, work->to->width, &begin, &end);
    for (size_t k = (size_t)begin; (double)k < end && k < (size_t)work->from->width; k++)
      for (int c = 0; c < 4; c++)
        sums[c] += share_in_span(k, begin, end) * (double)from[4 * k + (size_t)c];
    for (int c = 0; c < 4; c++)
      row[4 * x + (size_t)c] = sums[c] / (end - begin);
  }
}

static void shrink_column_part(void *data, size_t y) {
  const shrinking *work = data;
  size_t n = 4 * (size_t)work->to->width;
  float *to = (float *)work->to->planes[CONIC_PLANE_RGBA] + y * n;
  double begin, end;
  span_of_box(y, work->from->height, work->to->height, &begin, &end);
  for (size_t i = 0; i < n; i++) {
    double sum = 0.0;
    for (size_t k = (size_t)begin; (double)k < end && k < (size_t)work->from->height; k++)
      sum += share_in_span(k, begin, end) * work->rows[k * n + i];
    to[i] = (float)(sum / (end - begin));
  }
}

conic_status conic_image_reduce(conic_context *context, const conic_image *image, int width, int height,
                                conic_image *reduced) {
  shrinking work = {.from = image, .to = reduced};
  memset(reduced, 0, sizeof *reduced);
  if (!image->planes[CONIC_PLANE_RGBA] || width > image->width || height > image->height)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "reduce: the image has no colour, or is too small");
  conic_status status = conic_image_allocate(context, width, height, 1u << CONIC_PLANE_RGBA, reduced);
  if (status != CONIC_OK)
    return status;
  work.rows = conic_memory_allocate(context, (size_t)width * (size_t)image->height, 4 * sizeof *work.rows);
  if (!work.rows) {
    conic_image_release(context, reduced);
    return CONIC_ERROR_MEMORY;
  }
  conic_parallel_for(context, (size_t)image->height, shrink_row, &work);
  conic_parallel_for(context, (size_t)height, shrink_column_part, &work);
  conic_memory_release(context, work.rows);
  reduced->lacks_alpha = image->lacks_alpha;
  reduced->is_display = image->is_display;
  return CONIC_OK;
}
