/* Whose the light of each pixel is, as mattes have it. */
#include "core/base/base.h"
#include "gaussians/draw/gaussian_walk.h"

typedef struct share_job {
  const conic_gaussian_walk *walk;
  int samples;
  float share; /* of a sample in its pixel */
  size_t n_names;
  uint32_t first_id; /* of surfaces */
  conic_gaussian_namer *name_of;
  const void *cookie;
  float *shares;
} share_job;

/* A sample's light goes into the sums of its pixel. */
static void add_sample(const share_job *j, size_t sample, float *sums) {
  const conic_image *surfaces = j->walk->surfaces;
  uint32_t n;
  const conic_gaussian_step *steps = conic_gaussian_walk_at(j->walk, sample, &n);
  float T = 1.0f;
  for (uint32_t i = 0; i < n; i++) {
    sums[j->name_of(j->cookie, steps[i].index)] += j->share * T * steps[i].alpha;
    T *= 1.0f - steps[i].alpha;
  }
  const float *rgba = surfaces ? surfaces->planes[CONIC_PLANE_RGBA] : NULL;
  const float A = rgba ? rgba[4 * sample + 3] : 0.0f;
  if (rgba && A > 0.0f) {
    const uint32_t *ids = surfaces->planes[CONIC_PLANE_ID];
    sums[j->name_of(j->cookie, j->first_id + ids[sample])] += j->share * T * A;
  }
}

/* The samples of a row of pixels, as far as they are in the band. */
static void add_row(void *data, size_t i_row) {
  const share_job *j = data;
  const conic_gaussian_walk *walk = j->walk;
  const size_t n = (size_t)j->samples, width = (size_t)walk->width, row = (size_t)walk->first_row / n + i_row;
  const size_t first = (size_t)walk->first_row, end = first + (size_t)walk->n_rows;
  for (size_t y = row * n > first ? row * n : first; y < (row + 1) * n && y < end; y++)
    for (size_t x = 0; x < width; x++)
      add_sample(j, y * width + x, j->shares + (row * (width / n) + x / n) * j->n_names);
}

static conic_status add_band(void *cookie, const conic_gaussian_walk *walk) {
  const share_job *j = cookie;
  const int first = walk->first_row / j->samples, last = (walk->first_row + walk->n_rows - 1) / j->samples;
  return conic_parallel_told(walk->context, "mattes", (double)walk->first_row / walk->height,
                             (double)(walk->first_row + walk->n_rows) / walk->height, (size_t)(last - first + 1),
                             add_row, cookie);
}

conic_status conic_gaussians_find_shares(conic_context *context, const conic_gaussians *gaussians,
                                         const conic_camera *camera, const conic_gaussian_options *options,
                                         const conic_image *surfaces, int samples, size_t n_names,
                                         conic_gaussian_namer *name_of, const void *cookie, float *shares) {
  conic_gaussian_walk walk;
  if (samples < 1 || camera->width % samples || camera->height % samples)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "the camera has no %d x %d samples a pixel", samples, samples);
  const share_job j = {&walk,  samples, 1.0f / (float)(samples * samples), n_names, (uint32_t)gaussians->count, name_of,
                       cookie, shares};
  memset(shares, 0, (size_t)(camera->width / samples) * (size_t)(camera->height / samples) * n_names * sizeof *shares);
  conic_status status = conic_gaussian_walk_begin(context, gaussians, camera, options, surfaces, &walk);
  if (status == CONIC_OK)
    status = conic_gaussian_walk_run(&walk, add_band, (void *)&j);
  conic_gaussian_walk_release(&walk);
  return status;
}
