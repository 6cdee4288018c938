/* What is left of the light in a small picture of few Gaussians, for choosing what a picture shows of levels. */
#include "core/splats/gaussian_profile.h"
#include "gaussians/draw/gaussian_walk.h"
#include "source/together/gaussians_source.h"

/* The small picture has a pixel for so many along both axes, and what is merged in it has so many times the light, or
 * it has so few Gaussians. */
enum { ACROSS = 2, COARSER = 4 };

static conic_status note_band(void *cookie, const conic_gaussian_walk *walk) {
  const conic_levels_veil *veil = cookie;
  const size_t first = (size_t)walk->first_row * (size_t)walk->width, n = (size_t)walk->n_rows * (size_t)walk->width;
  for (size_t pixel = first; pixel < first + n; pixel++) {
    uint32_t n_steps;
    const conic_gaussian_step *steps = conic_gaussian_walk_at(walk, pixel, &n_steps);
    float *depths = veil->depths + pixel * CONIC_VEIL_HALVES, T = 1.0f, half = 0.5f;
    size_t k = 0;
    for (uint32_t i = 0; i < n_steps; i++) {
      T *= 1.0f - steps[i].alpha;
      for (; k < CONIC_VEIL_HALVES && T <= half; half *= 0.5f)
        depths[k++] = steps[i].z;
    }
    while (k < CONIC_VEIL_HALVES)
      depths[k++] = INFINITY;
  }
  return CONIC_OK;
}

/* The picture's camera, small. */
static conic_camera veil_camera(const conic_camera *of, const conic_profile_row *row) {
  conic_camera camera = *of;
  camera.width = (of->width + ACROSS - 1) / ACROSS;
  camera.height = (of->height + ACROSS - 1) / ACROSS;
  camera.fx /= ACROSS;
  camera.fy /= ACROSS;
  camera.cx = row->takes_middle ? 0.5 * camera.width : of->cx / ACROSS;
  camera.cy = row->takes_middle ? 0.5 * camera.height : of->cy / ACROSS;
  return camera;
}

conic_levels_wish conic_levels_coarser(const conic_levels_wish *wish, const conic_levels_scene *scenes, size_t n,
                                       const conic_gaussian_options *options) {
  const uint64_t most = wish->budget ? wish->budget : conic_levels_most(scenes, n);
  conic_levels_wish coarse = *wish;
  uint64_t least = 0;
  for (size_t i = 0; i < n; i++)
    least += scenes[i].levels->entries[0].n;
  coarse.error *= COARSER;
  if (coarse.error == 0.0)
    coarse.budget = most / COARSER > least ? most / COARSER : least < most ? least : most;
  coarse.dilation = wish->dilation > 0.0 ? conic_profile_row_of(options->profile)->dilation * ACROSS * ACROSS : 0.0;
  return coarse;
}

conic_status conic_levels_find_veil(conic_context *context, const conic_gaussians *set, const conic_camera *camera,
                                    const conic_gaussian_options *options, conic_levels_veil *veil) {
  conic_gaussian_options own = *options;
  conic_gaussian_walk walk;
  own.device = NULL;
  veil->camera = veil_camera(camera, conic_profile_row_of(options->profile));
  veil->depths = conic_memory_allocate(context, (size_t)veil->camera.width * (size_t)veil->camera.height,
                                       CONIC_VEIL_HALVES * sizeof *veil->depths);
  if (!veil->depths)
    return CONIC_ERROR_MEMORY;
  conic_status status = conic_gaussian_walk_begin(context, set, &veil->camera, &own, NULL, &walk);
  if (status == CONIC_OK)
    status = conic_gaussian_walk_run(&walk, note_band, veil);
  conic_gaussian_walk_release(&walk);
  return status;
}
