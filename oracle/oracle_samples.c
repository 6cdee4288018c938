/* The oracle's pixel of N × N samples: docs/reference/picture.md, "Samples". */
#include "conic/oracle.h"

#include <string.h>

#include "core/base/message.h"
#include "oracle/oracle_pixel.h"

/* A mean normal shorter than this makes more of the samples' rounding than the bound of a normal allows. */
static const double shortest_mean = 0.1;

typedef struct fine_pixel {
  const conic_reference *fine;
  size_t n, left, top; /* N, and its first sample */
} fine_pixel;

static size_t sample_at(const fine_pixel *p, size_t column, size_t row) {
  return (p->top + row) * (size_t)p->fine->width + p->left + column;
}

/* How far a sample is from the centre, in half samples, squared. */
static double distance(const fine_pixel *p, size_t column, size_t row) {
  double dx = (double)(2 * column + 1) - (double)p->n, dy = (double)(2 * row + 1) - (double)p->n;
  return dx * dx + dy * dy;
}

static double mean_of(const fine_pixel *p, conic_plane plane, size_t channel) {
  size_t n_channels = (size_t)conic_plane_describe(plane)->n_channels;
  double sum = 0.0;
  for (size_t row = 0; row < p->n; row++)
    for (size_t column = 0; column < p->n; column++)
      sum += p->fine->planes[plane][n_channels * sample_at(p, column, row) + channel];
  return sum / (double)(p->n * p->n);
}

static double greatest_count(const fine_pixel *p) {
  double greatest = 0.0;
  for (size_t row = 0; row < p->n; row++)
    for (size_t column = 0; column < p->n; column++)
      greatest = oracle_max(greatest, p->fine->planes[CONIC_PLANE_COUNT][sample_at(p, column, row)]);
  return greatest;
}

/* The normalised mean over what is covered; the reasons why it is in doubt. */
static unsigned mean_normal(const fine_pixel *p, double normal[3]) {
  double sum[3] = {0.0, 0.0, 0.0}, n_covered = 0.0, least = 0.0;
  const double *central = NULL;
  for (size_t row = 0; row < p->n; row++)
    for (size_t column = 0; column < p->n; column++) {
      size_t at = sample_at(p, column, row);
      const double *sample = p->fine->planes[CONIC_PLANE_NORMAL] + 3 * at;
      if (p->fine->planes[CONIC_PLANE_COUNT][at] == 0.0)
        continue;
      if (!central || distance(p, column, row) < least) {
        central = sample;
        least = distance(p, column, row);
      }
      for (int axis = 0; axis < 3; axis++)
        sum[axis] += sample[axis];
      n_covered += 1.0;
    }
  double length = oracle_length(sum);
  for (int axis = 0; axis < 3 && central; axis++)
    normal[axis] = length > 0.0 ? sum[axis] / length : central[axis];
  return length < shortest_mean * n_covered ? 1u << CONIC_UNSTABLE_PRECISION : 0u;
}

static void reduce_pixel(const fine_pixel *p, size_t at, conic_reference *r) {
  static const conic_plane averaged[] = {CONIC_PLANE_RGBA, CONIC_PLANE_ALBEDO, CONIC_PLANE_WEIGHT};
  size_t middle = p->n % 2 ? p->n / 2 : p->n / 2 - 1, center = sample_at(p, middle, middle);
  unsigned doubt = 0;
  for (size_t i = 0; i < sizeof averaged / sizeof averaged[0]; i++) {
    size_t n_channels = (size_t)conic_plane_describe(averaged[i])->n_channels;
    for (size_t c = 0; c < n_channels; c++)
      r->planes[averaged[i]][n_channels * at + c] = mean_of(p, averaged[i], c);
  }
  doubt |= mean_normal(p, r->planes[CONIC_PLANE_NORMAL] + 3 * at);
  for (size_t row = 0; row < p->n; row++)
    for (size_t column = 0; column < p->n; column++)
      doubt |= p->fine->unstable[sample_at(p, column, row)];
  r->planes[CONIC_PLANE_COUNT][at] = greatest_count(p);
  r->planes[CONIC_PLANE_Z][at] = p->fine->planes[CONIC_PLANE_Z][center];
  r->planes[CONIC_PLANE_ID][at] = p->fine->planes[CONIC_PLANE_ID][center];
  r->tied_id[at] = p->fine->tied_id[center];
  r->unstable[at] = (uint8_t)doubt;
  r->unstable_pixels += doubt != 0;
  r->covered_pixels += r->planes[CONIC_PLANE_COUNT][at] > 0.0;
  r->undecided_ids += r->tied_id[at] == CONIC_ANY_ID;
}

/* Takes what was counted over the samples from the fine reference. */
static void reduce_all(const conic_reference *fine, int samples, conic_reference *r) {
  r->question = fine->question;
  r->white = fine->white;
  r->samples = samples;
  r->covered_samples = fine->covered_samples;
  r->unstable_samples = fine->unstable_samples;
  r->weight_error = fine->weight_error;
  memcpy(r->unstable_by_reason, fine->unstable_by_reason, sizeof r->unstable_by_reason);
  fine_pixel p = {.fine = fine, .n = (size_t)samples};
  for (size_t y = 0; y < (size_t)r->height; y++)
    for (size_t x = 0; x < (size_t)r->width; x++) {
      p.left = x * p.n;
      p.top = y * p.n;
      reduce_pixel(&p, y * (size_t)r->width + x, r);
    }
}

conic_status conic_oracle_render_drawing(conic_context *context, const conic_drawing *drawing,
                                         const conic_camera *camera, const conic_render_options *options,
                                         conic_oracle_question question, int samples, conic_reference *reference) {
  conic_reference fine_reference;
  if (samples == 1)
    return conic_oracle_draw(context, drawing, camera, options, question, reference);
  memset(reference, 0, sizeof *reference);
  if (!camera || samples < 1 || samples > CONIC_MAX_SAMPLES || camera->width > 65535 / samples ||
      camera->height > 65535 / samples)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "samples: 1 to %d, and that times the picture's size at most %d",
                      CONIC_MAX_SAMPLES, 65535);
  conic_camera fine = *camera;
  fine.width *= samples;
  fine.height *= samples;
  fine.fx *= samples;
  fine.fy *= samples;
  fine.cx *= samples;
  fine.cy *= samples;
  conic_status status = conic_oracle_draw(context, drawing, &fine, options, question, &fine_reference);
  if (status != CONIC_OK)
    return status;
  reference->width = camera->width;
  reference->height = camera->height;
  status = conic_oracle_allocate(context, reference);
  if (status == CONIC_OK)
    reduce_all(&fine_reference, samples, reference);
  else
    conic_reference_release(context, reference);
  conic_reference_release(context, &fine_reference);
  return status;
}

conic_status conic_oracle_render_samples(conic_context *context, const conic_splats *splats, const conic_camera *camera,
                                         const conic_render_options *options, conic_oracle_question question,
                                         int samples, conic_reference *reference) {
  const conic_drawing alone = {.splats = splats};
  if (samples == 1 || !splats)
    return conic_oracle_render(context, splats, camera, options, question, reference);
  return conic_oracle_render_drawing(context, &alone, camera, options, question, samples, reference);
}
