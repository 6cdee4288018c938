/* Deep pictures of Gaussian scenes: a sample for each Gaussian that a pixel is composited of. */
#include <stdlib.h>

#include "core/base/base.h"
#include "core/base/radix.h"
#include "core/pictures/image_exr_deep.h"
#include "gaussians/draw/gaussian_parts.h"
#include "gaussians/draw/surfaces_join.h"

typedef struct deep_picture {
  conic_context *context;
  conic_gaussian_picture *picture;
  const conic_image *surfaces; /* null: there are none */
  int is_linear, width, height;
  uint32_t first_id; /* of surfaces */
  uint32_t *counts;  /* of Gaussians, by pixel */
  conic_deep_writer *writer;
  /* Of a band of rows: */
  int first_row, n_rows;
  conic_gaussian_steps steps;
  size_t room;
  conic_deep_packed *packed; /* by row */
  conic_status *statuses;
} deep_picture;

CONIC_DEFINE_ORDER_BY_TWO(compare_samples, conic_deep_sample, depth, weight)

/* Where a surface is, it is the last sample. */
static int find_surface(const deep_picture *d, size_t pixel, conic_deep_sample *sample) {
  const float *rgba = d->surfaces ? (const float *)d->surfaces->planes[CONIC_PLANE_RGBA] + 4 * pixel : NULL;
  if (!rgba || !(rgba[3] > 0.0f))
    return 0;
  const uint32_t *id = d->surfaces->planes[CONIC_PLANE_ID];
  *sample = (conic_deep_sample){.depth = ((const float *)d->surfaces->planes[CONIC_PLANE_Z])[pixel],
                                .id = d->first_id + id[pixel]};
  for (int c = 0; c < 3; c++)
    sample->rgba[c] = conic_surface_shown(rgba[c], rgba[3], d->is_linear);
  sample->rgba[3] = rgba[3];
  return 1;
}

static size_t samples_of_pixel(const deep_picture *d, size_t pixel, conic_deep_sample *to) {
  const size_t end = d->steps.next[pixel - (size_t)d->first_row * (size_t)d->width];
  const uint32_t n = d->counts[pixel];
  for (uint32_t i = 0; i < n; i++) {
    const conic_gaussian_step *step = &d->steps.steps[end - n + i];
    to[i] = (conic_deep_sample){{0.0f, 0.0f, 0.0f, step->alpha}, step->z, (float)i, step->index};
    for (int c = 0; c < 3; c++)
      to[i].rgba[c] = step->alpha * step->color[c];
  }
  qsort(to, n, sizeof *to, compare_samples); /* which is the order already, but for profiles that have another */
  size_t n_all = n + (size_t)find_surface(d, pixel, &to[n]);
  float T = 1.0f;
  for (size_t i = 0; i < n_all; i++) {
    to[i].weight = T * to[i].rgba[3];
    T *= 1.0f - to[i].rgba[3];
  }
  return n_all;
}

static void pack_row(void *data, size_t i_row) {
  deep_picture *d = data;
  const size_t width = (size_t)d->width, first = ((size_t)d->first_row + i_row) * width;
  size_t n = 0, most = width;
  for (size_t x = 0; x < width; x++)
    most += d->counts[first + x];
  conic_deep_sample *samples = conic_memory_allocate(d->context, most, sizeof *samples);
  uint32_t *counts = conic_memory_allocate(d->context, width, sizeof *counts);
  d->statuses[i_row] = samples && counts ? CONIC_OK : CONIC_ERROR_MEMORY;
  for (size_t x = 0; x < width && samples && counts; x++) {
    const size_t of_pixel = samples_of_pixel(d, first + x, samples + n);
    counts[x] = (uint32_t)of_pixel;
    n += of_pixel;
  }
  const conic_deep_line line = {counts, n, samples};
  if (d->statuses[i_row] == CONIC_OK)
    d->statuses[i_row] = conic_deep_pack(d->context, &line, d->width, &d->packed[i_row]);
  conic_memory_release_these(d->context, samples, counts);
}

/* Composites the band once more, noting its steps, and appends its rows. */
static conic_status write_band(deep_picture *d) {
  const size_t n = (size_t)d->n_rows * (size_t)d->width, first = (size_t)d->first_row * (size_t)d->width;
  const conic_gaussian_window window = {{0, d->first_row}, {d->width, d->first_row + d->n_rows}};
  conic_gaussian_planes planes = {.width = d->width, .height = d->n_rows};
  size_t n_steps = 0;
  for (size_t i = 0; i < n; i++) {
    d->steps.next[i] = n_steps;
    n_steps += d->counts[first + i];
  }
  if (n_steps > d->room &&
      conic_memory_reserve(d->context, &d->steps.steps, 0, n_steps, &d->room, sizeof *d->steps.steps) != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  planes.surface_z = d->surfaces ? (const float *)d->surfaces->planes[CONIC_PLANE_Z] + first : NULL;
  conic_status status = conic_gaussian_picture_draw(d->picture, &window, &planes);
  if (status == CONIC_OK)
    status = conic_parallel_told(d->context, "deep", (double)d->first_row / d->height,
                                 (double)(d->first_row + d->n_rows) / d->height, (size_t)d->n_rows, pack_row, d);
  for (int row = 0; row < d->n_rows && status == CONIC_OK; row++)
    status = d->statuses[row] == CONIC_OK ? conic_deep_append(d->writer, &d->packed[row]) : d->statuses[row];
  return status;
}

/* How many samples there are is known before one is written. */
static conic_status count_samples(deep_picture *d, uint32_t *most) {
  const size_t n = (size_t)d->width * (size_t)d->height;
  const conic_gaussian_window whole = {{0, 0}, {d->width, d->height}};
  conic_gaussian_planes planes = {.width = d->width, .height = d->height, .count = d->counts};
  uint64_t sum = 0;
  planes.surface_z = d->surfaces ? d->surfaces->planes[CONIC_PLANE_Z] : NULL;
  conic_status status = conic_gaussian_picture_draw(d->picture, &whole, &planes);
  for (size_t i = 0; i < n && status == CONIC_OK; i++) {
    sum += d->counts[i];
    *most = d->counts[i] >= *most ? d->counts[i] + 1 : *most; /* and a surface */
  }
  if (status == CONIC_OK)
    conic_log(d->context, CONIC_LOG_INFO, "deep: %llu samples, %.1f MB before they are packed", (unsigned long long)sum,
              1e-6 * (double)sum * sizeof(conic_deep_sample));
  return status;
}

static conic_status write_all(deep_picture *d, const char *path, const conic_image *header) {
  uint32_t most = 1;
  conic_status status = count_samples(d, &most);
  if (status == CONIC_OK)
    status = conic_deep_open(d->context, path, d->width, d->height, most, header, &d->writer);
  if (status == CONIC_OK)
    conic_gaussian_picture_note(d->picture, &d->steps);
  for (d->first_row = 0; d->first_row < d->height && status == CONIC_OK; d->first_row += CONIC_GAUSSIAN_TILE) {
    const int left = d->height - d->first_row;
    d->n_rows = left < CONIC_GAUSSIAN_TILE ? left : CONIC_GAUSSIAN_TILE;
    status = write_band(d);
  }
  return conic_deep_end(d->writer, status);
}

conic_status conic_gaussians_write_deep(conic_context *context, const conic_gaussians *gaussians,
                                        const conic_camera *camera, const conic_gaussian_options *options,
                                        const conic_image *surfaces, const char *path, const conic_image *header) {
  deep_picture d = {.context = context, .surfaces = surfaces, .width = camera->width, .height = camera->height};
  conic_deep_packed packed[CONIC_GAUSSIAN_TILE];
  conic_status statuses[CONIC_GAUSSIAN_TILE];
  const size_t width = (size_t)camera->width;
  if (surfaces &&
      (surfaces->width != camera->width || surfaces->height != camera->height || !surfaces->planes[CONIC_PLANE_RGBA] ||
       !surfaces->planes[CONIC_PLANE_Z] || !surfaces->planes[CONIC_PLANE_ID]))
    return conic_fail(context, CONIC_ERROR_ARGUMENT,
                      "deep: the surfaces are not of the camera's size, or lack rgba, Z or id");
  memset(packed, 0, sizeof packed);
  d.packed = packed;
  d.statuses = statuses;
  d.is_linear = gaussians->is_linear;
  d.first_id = (uint32_t)gaussians->count;
  d.steps.width = camera->width;
  conic_status status = conic_memory_allocate_these(context, CONIC_ROOM(d.counts, width * (size_t)camera->height),
                                                    CONIC_ROOM(d.steps.next, width * CONIC_GAUSSIAN_TILE));
  if (status == CONIC_OK)
    status = conic_gaussian_picture_begin(context, gaussians, camera, options, 0, &d.picture);
  if (status == CONIC_OK)
    status = write_all(&d, path, header);
  for (int row = 0; row < CONIC_GAUSSIAN_TILE; row++)
    conic_deep_packed_release(context, &packed[row]);
  conic_gaussian_picture_release(d.picture);
  conic_memory_release_these(context, d.counts, d.steps.next, d.steps.steps);
  return status;
}
