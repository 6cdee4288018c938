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

static conic_status find_veil(conic_levels *levels, const conic_levels_wish *wish,
                              const conic_gaussian_options *options, conic_levels_veil *veil) {
  const conic_profile_row *row = conic_profile_row_of(options->profile);
  const uint64_t root = levels->entries[0].n, most = wish->budget ? wish->budget : conic_levels_most(levels);
  conic_levels_wish coarse = *wish;
  conic_gaussian_options own = *options;
  conic_gaussian_walk walk;
  conic_gaussians set;
  conic_levels_cut cut;
  own.device = NULL;
  coarse.error *= COARSER;
  if (coarse.error == 0.0)
    coarse.budget = most / COARSER > root ? most / COARSER : root;
  coarse.dilation = wish->dilation > 0.0 ? row->dilation * ACROSS * ACROSS : 0.0;
  memset(&set, 0, sizeof set);
  veil->camera = veil_camera(&wish->camera, row);
  veil->depths = conic_memory_allocate(levels->context, (size_t)veil->camera.width * (size_t)veil->camera.height,
                                       CONIC_VEIL_HALVES * sizeof *veil->depths);
  conic_status status = veil->depths ? conic_levels_choose(levels, &coarse, &set, &cut) : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK) {
    status = conic_gaussian_walk_begin(levels->context, &set, &veil->camera, &own, NULL, &walk);
    if (status == CONIC_OK)
      status = conic_gaussian_walk_run(&walk, note_band, veil);
    conic_gaussian_walk_release(&walk);
  }
  conic_gaussians_release(levels->context, &set);
  return status;
}

conic_status conic_levels_choose_seen(conic_levels *levels, const conic_levels_wish *wish,
                                      const conic_gaussian_options *options, conic_gaussians *set,
                                      conic_levels_cut *cut) {
  conic_levels_veil veil = {.depths = NULL};
  conic_levels_wish own = *wish;
  const int is_all = wish->error == 0.0 && !wish->budget && levels->header.n <= conic_levels_most(levels);
  conic_status status = CONIC_OK;
  if (wish->part == CONIC_LEVELS_CUT && !is_all && wish->camera.kind == CONIC_CAMERA_PERSPECTIVE &&
      wish->camera.lens == CONIC_LENS_NONE)
    status = find_veil(levels, wish, options, &veil);
  own.veil = veil.depths ? &veil : NULL;
  if (status == CONIC_OK)
    status = conic_levels_choose(levels, &own, set, cut);
  conic_memory_release(levels->context, veil.depths);
  return status;
}
