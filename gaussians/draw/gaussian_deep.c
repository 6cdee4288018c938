/* Deep pictures of Gaussian scenes: a sample for each Gaussian that a pixel is composited of. */
#include <stdlib.h>

#include "core/base/base.h"
#include "core/pictures/image_exr_deep.h"
#include "gaussians/draw/gaussian_walk.h"
#include "gaussians/draw/surfaces_join.h"

typedef struct deep_picture {
  const conic_gaussian_walk *walk;
  int is_linear;
  uint32_t first_id; /* of surfaces */
  conic_deep_writer *writer;
  conic_deep_packed packed[CONIC_GAUSSIAN_TILE]; /* by row of a band */
  conic_status statuses[CONIC_GAUSSIAN_TILE];
} deep_picture;

CONIC_DEFINE_ORDER_BY_TWO(compare_samples, conic_deep_sample, depth, weight)

/* Where a surface is, it is the last sample. */
static int find_surface(const deep_picture *d, size_t pixel, conic_deep_sample *sample) {
  const conic_image *surfaces = d->walk->surfaces;
  const float *rgba = surfaces ? (const float *)surfaces->planes[CONIC_PLANE_RGBA] + 4 * pixel : NULL;
  if (!rgba || !(rgba[3] > 0.0f))
    return 0;
  const uint32_t *id = surfaces->planes[CONIC_PLANE_ID];
  *sample = (conic_deep_sample){.depth = ((const float *)surfaces->planes[CONIC_PLANE_Z])[pixel],
                                .id = d->first_id + id[pixel]};
  for (int c = 0; c < 3; c++)
    sample->rgba[c] = conic_surface_shown(rgba[c], rgba[3], d->is_linear);
  sample->rgba[3] = rgba[3];
  return 1;
}

static size_t samples_of_pixel(const deep_picture *d, size_t pixel, conic_deep_sample *to) {
  uint32_t n;
  const conic_gaussian_step *steps = conic_gaussian_walk_at(d->walk, pixel, &n);
  for (uint32_t i = 0; i < n; i++) {
    const conic_gaussian_step *step = &steps[i];
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
  conic_context *context = d->walk->context;
  const size_t width = (size_t)d->walk->width, first = ((size_t)d->walk->first_row + i_row) * width;
  size_t n = 0, most = width;
  for (size_t x = 0; x < width; x++)
    most += d->walk->counts[first + x];
  conic_deep_sample *samples = conic_memory_allocate(context, most, sizeof *samples);
  uint32_t *counts = conic_memory_allocate(context, width, sizeof *counts);
  d->statuses[i_row] = samples && counts ? CONIC_OK : CONIC_ERROR_MEMORY;
  for (size_t x = 0; x < width && samples && counts; x++) {
    const size_t of_pixel = samples_of_pixel(d, first + x, samples + n);
    counts[x] = (uint32_t)of_pixel;
    n += of_pixel;
  }
  const conic_deep_line line = {counts, n, samples};
  if (d->statuses[i_row] == CONIC_OK)
    d->statuses[i_row] = conic_deep_pack(context, &line, d->walk->width, &d->packed[i_row]);
  conic_memory_release_these(context, samples, counts);
}

static conic_status append_band(void *cookie, const conic_gaussian_walk *walk) {
  deep_picture *d = cookie;
  conic_status status =
      conic_parallel_told(walk->context, "deep", (double)walk->first_row / walk->height,
                          (double)(walk->first_row + walk->n_rows) / walk->height, (size_t)walk->n_rows, pack_row, d);
  for (int row = 0; row < walk->n_rows && status == CONIC_OK; row++)
    status = d->statuses[row] == CONIC_OK ? conic_deep_append(d->writer, &d->packed[row]) : d->statuses[row];
  return status;
}

static conic_status write_all(deep_picture *d, conic_gaussian_walk *walk, const char *path, const conic_image *header) {
  uint32_t most = 1;
  for (size_t i = 0; i < (size_t)walk->width * (size_t)walk->height; i++)
    most = walk->counts[i] >= most ? walk->counts[i] + 1 : most; /* and a surface */
  conic_log(walk->context, CONIC_LOG_INFO, "deep: %llu samples, %.1f MB before they are packed",
            (unsigned long long)walk->n_all, 1e-6 * (double)walk->n_all * sizeof(conic_deep_sample));
  conic_status status = conic_deep_open(walk->context, path, walk->width, walk->height, most, header, &d->writer);
  if (status == CONIC_OK)
    status = conic_gaussian_walk_run(walk, append_band, d);
  return conic_deep_end(d->writer, status);
}

conic_status conic_gaussians_write_deep(conic_context *context, const conic_gaussians *gaussians,
                                        const conic_camera *camera, const conic_gaussian_options *options,
                                        const conic_image *surfaces, const char *path, const conic_image *header) {
  conic_gaussian_walk walk;
  deep_picture d = {&walk, gaussians->is_linear, (uint32_t)gaussians->count, NULL, {{NULL}}, {CONIC_OK}};
  conic_status status = conic_gaussian_walk_begin(context, gaussians, camera, options, surfaces, &walk);
  if (status == CONIC_OK)
    status = write_all(&d, &walk, path, header);
  for (int row = 0; row < CONIC_GAUSSIAN_TILE; row++)
    conic_deep_packed_release(context, &d.packed[row]);
  conic_gaussian_walk_release(&walk);
  return status;
}
