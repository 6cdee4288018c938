#include "gaussians/draw/gaussian_walk.h"

#include "core/base/base.h"

static const float *surface_z(const conic_gaussian_walk *walk, size_t first) {
  return walk->surfaces ? (const float *)walk->surfaces->planes[CONIC_PLANE_Z] + first : NULL;
}

static conic_status count_steps(conic_gaussian_walk *walk) {
  const conic_gaussian_window whole = {{0, 0}, {walk->width, walk->height}};
  conic_gaussian_planes planes = {.width = walk->width, .height = walk->height, .count = walk->counts};
  planes.surface_z = surface_z(walk, 0);
  conic_status status = conic_gaussian_picture_draw(walk->picture, &whole, &planes);
  for (size_t i = 0; i < (size_t)walk->width * (size_t)walk->height && status == CONIC_OK; i++)
    walk->n_all += walk->counts[i];
  return status;
}

conic_status conic_gaussian_walk_begin(conic_context *context, const conic_gaussians *gaussians,
                                       const conic_camera *camera, const conic_gaussian_options *options,
                                       const conic_image *surfaces, conic_gaussian_walk *walk) {
  const size_t width = (size_t)camera->width;
  *walk =
      (conic_gaussian_walk){.context = context, .surfaces = surfaces, .width = camera->width, .height = camera->height};
  walk->steps.width = camera->width;
  if (surfaces &&
      (surfaces->width != camera->width || surfaces->height != camera->height || !surfaces->planes[CONIC_PLANE_RGBA] ||
       !surfaces->planes[CONIC_PLANE_Z] || !surfaces->planes[CONIC_PLANE_ID]))
    return conic_fail(context, CONIC_ERROR_ARGUMENT,
                      "the surfaces are not of the camera's size, or lack rgba, Z or id");
  conic_status status = conic_memory_allocate_these(context, CONIC_ROOM(walk->counts, width * (size_t)camera->height),
                                                    CONIC_ROOM(walk->steps.next, width * CONIC_GAUSSIAN_TILE));
  if (status == CONIC_OK)
    status = conic_gaussian_picture_begin(context, gaussians, camera, options, 0, &walk->picture);
  return status == CONIC_OK ? count_steps(walk) : status;
}

/* Composites the band, noting its steps. */
static conic_status draw_band(conic_gaussian_walk *walk) {
  const size_t n = (size_t)walk->n_rows * (size_t)walk->width, first = (size_t)walk->first_row * (size_t)walk->width;
  const conic_gaussian_window window = {{0, walk->first_row}, {walk->width, walk->first_row + walk->n_rows}};
  conic_gaussian_planes planes = {.width = walk->width, .height = walk->n_rows};
  size_t n_steps = 0;
  for (size_t i = 0; i < n; i++) {
    walk->steps.next[i] = n_steps;
    n_steps += walk->counts[first + i];
  }
  if (n_steps > walk->room && conic_memory_reserve(walk->context, &walk->steps.steps, 0, n_steps, &walk->room,
                                                   sizeof *walk->steps.steps) != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  planes.surface_z = surface_z(walk, first);
  return conic_gaussian_picture_draw(walk->picture, &window, &planes);
}

conic_status conic_gaussian_walk_run(conic_gaussian_walk *walk, conic_gaussian_band_taker *take, void *cookie) {
  conic_status status = CONIC_OK;
  conic_gaussian_picture_note(walk->picture, &walk->steps);
  for (walk->first_row = 0; walk->first_row < walk->height && status == CONIC_OK;
       walk->first_row += CONIC_GAUSSIAN_TILE) {
    const int left = walk->height - walk->first_row;
    walk->n_rows = left < CONIC_GAUSSIAN_TILE ? left : CONIC_GAUSSIAN_TILE;
    status = draw_band(walk);
    if (status == CONIC_OK)
      status = take(cookie, walk);
  }
  return status;
}

void conic_gaussian_walk_release(conic_gaussian_walk *walk) {
  conic_gaussian_picture_release(walk->picture);
  conic_memory_release_these(walk->context, walk->counts, walk->steps.next, walk->steps.steps);
}
