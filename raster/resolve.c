#include "raster/resolve.h"

#include <math.h>

#include "raster/coverage.h"

/* A finished pixel, before it is written to the planes that the image has. */
typedef struct pixel {
  float rgba[4], normal[3], albedo[3], weight;
} pixel;

void conic_tile_rays_init(const conic_tile *tile, conic_tile_rays *rays) {
  const conic_view *view = tile->view;
  for (int i = 0; i < 256 + 4; i++) {
    rays->x[i] = (float)(((double)(tile->x_begin + i) + 0.5 - view->cx) / view->fx);
    rays->y[i] = (float)(((double)(tile->y_begin + i) + 0.5 - view->cy) / view->fy);
  }
}

/* The unit direction from what is seen at the pixel to the viewer, in world coordinates. */
static void viewer_at(const conic_finish *finish, float dx, float dy, float viewer[3]) {
  float scale = -1.0f / sqrtf((dx * dx + dy * dy) + 1.0f);
  for (int i = 0; i < 3; i++) {
    const float *m = finish->world_from_cam[i];
    viewer[i] = ((m[0] * dx + m[1] * dy) + m[2]) * scale;
  }
}

/* The weighted mean of the splats' normals, and its direction; where they cancel, that of the heaviest splat. */
static void normal_of_sum(const conic_tile *tile, size_t at, float mean[3], float normal[3]) {
  for (int axis = 0; axis < 3; axis++)
    mean[axis] = tile->planes.normal[axis][at] / tile->planes.weight[at];
  float norm = sqrtf((mean[0] * mean[0] + mean[1] * mean[1]) + mean[2] * mean[2]);
  const conic_surface *heaviest = &tile->projected->surfaces[tile->planes.heaviest[at]];
  for (int axis = 0; axis < 3; axis++)
    normal[axis] = norm > 0.0f ? mean[axis] / norm : heaviest->normal[axis];
}

static void finish_covered(const conic_tile *tile, const conic_finish *finish, size_t at, float dx, float dy,
                           pixel *p) {
  float viewer[3], mean_normal[3], shaded[3];
  p->weight = tile->planes.weight[at];
  for (int axis = 0; axis < 3; axis++)
    p->albedo[axis] = tile->planes.color[axis][at] / p->weight;
  normal_of_sum(tile, at, mean_normal, p->normal);
  viewer_at(finish, dx, dy, viewer);
  conic_shade(finish, p->albedo, p->normal, mean_normal, viewer, shaded);
  for (int axis = 0; axis < 3; axis++)
    p->rgba[axis] = shaded[axis] * finish->exposure;
  p->rgba[3] = 1.0f;
}

static void finish_uncovered(const conic_finish *finish, pixel *p) {
  *p = (pixel){.weight = 0.0f};
  for (int channel = 0; channel < 4; channel++)
    p->rgba[channel] = finish->background[channel];
}

static void store(const conic_image *image, conic_plane plane, size_t at, const float *values, size_t n) {
  float *to = image->planes[plane];
  if (to)
    for (size_t i = 0; i < n; i++)
      to[at * n + i] = values[i];
}

void conic_tile_resolve(conic_tile *tile, const conic_finish *finish, conic_image *image) {
  conic_tile_rays rays;
  conic_tile_rays_init(tile, &rays);
  for (int y = tile->y_begin; y < tile->y_end; y++)
    for (int x = tile->x_begin; x < tile->x_end; x++) {
      pixel p;
      size_t from = conic_tile_place(tile, x, y), at = (size_t)y * (size_t)image->width + (size_t)x;
      tile->n_covered += tile->planes.weight[from] > 0.0f;
      if (tile->planes.weight[from] > 0.0f)
        finish_covered(tile, finish, from, rays.x[x - tile->x_begin], rays.y[y - tile->y_begin], &p);
      else
        finish_uncovered(finish, &p);
      store(image, CONIC_PLANE_RGBA, at, p.rgba, 4);
      store(image, CONIC_PLANE_NORMAL, at, p.normal, 3);
      store(image, CONIC_PLANE_ALBEDO, at, p.albedo, 3);
      store(image, CONIC_PLANE_WEIGHT, at, &p.weight, 1);
    }
  conic_tile_resolve_indices(tile, image);
}

/* Camera-space z of the splat's plane at the pixel: its gradient is not shrunk here, but stays in the splat's range. */
static float plane_z(const conic_footprint *footprint, int x, int y) {
  float dx = conic_row_dx(footprint, x), dy = conic_row_dy(footprint, y);
  float iz = (footprint->iz0 + footprint->plane_dy * dy) + footprint->plane_dx * dx;
  return 1.0f / conic_clamp_iz(footprint, iz);
}

void conic_tile_resolve_indices(conic_tile *tile, conic_image *image) {
  const conic_tile_planes *planes = &tile->planes;
  const conic_projected *projected = tile->projected;
  float *z = image->planes[CONIC_PLANE_Z];
  uint32_t *count = image->planes[CONIC_PLANE_COUNT], *id = image->planes[CONIC_PLANE_ID];
  if (!z && !count && !id)
    return;
  for (int y = tile->y_begin; y < tile->y_end; y++)
    for (int x = tile->x_begin; x < tile->x_end; x++) {
      size_t from = conic_tile_place(tile, x, y), at = (size_t)y * (size_t)image->width + (size_t)x;
      int is_covered = planes->weight[from] > 0.0f;
      if (z)
        z[at] = is_covered ? plane_z(&projected->footprints[planes->heaviest[from]], x, y) : 0.0f;
      if (count)
        count[at] = planes->count[from];
      if (id)
        id[at] = is_covered ? projected->surfaces[planes->nearest[from]].index : CONIC_NO_ID;
    }
}
