#include <math.h>

#include "raster/coverage.h"

/* A finished pixel, before it is written to the planes that the image has. */
typedef struct pixel {
  float rgba[4], z, normal[3], albedo[3], weight;
  uint32_t count, id;
} pixel;

static float length(const float v[3]) {
  return sqrtf((v[0] * v[0] + v[1] * v[1]) + v[2] * v[2]);
}

/* Camera-space z of the splat's plane at the pixel: its gradient is not shrunk here, but stays in the splat's range. */
static float plane_z(const conic_footprint *footprint, int x, int y) {
  float dx = conic_row_dx(footprint, x), dy = conic_row_dy(footprint, y);
  float iz = (footprint->iz0 + footprint->plane_dy * dy) + footprint->plane_dx * dx;
  return 1.0f / conic_clamp_iz(footprint, iz);
}

/* The unit direction from what is seen at the pixel to the viewer, in world coordinates. */
static void viewer_at(const conic_view *view, const conic_finish *finish, int x, int y, float viewer[3]) {
  double ray[3] = {((double)x + 0.5 - view->cx) / view->fx, ((double)y + 0.5 - view->cy) / view->fy, 1.0};
  double scale = -1.0 / sqrt((ray[0] * ray[0] + ray[1] * ray[1]) + 1.0);
  for (int i = 0; i < 3; i++) {
    const double *m = finish->world_from_cam[i];
    viewer[i] = (float)(((m[0] * ray[0] + m[1] * ray[1]) + m[2] * ray[2]) * scale);
  }
}

/* The weighted mean of the splats' normals, and its direction; where they cancel, that of the heaviest splat. */
static void normal_of_sum(const conic_tile *tile, size_t at, const conic_surface *heaviest, float mean[3],
                          float normal[3]) {
  for (int axis = 0; axis < 3; axis++)
    mean[axis] = tile->planes.normal[axis][at] / tile->planes.weight[at];
  float norm = length(mean);
  for (int axis = 0; axis < 3; axis++)
    normal[axis] = norm > 0.0f ? mean[axis] / norm : heaviest->normal[axis];
}

static void finish_covered(const conic_tile *tile, const conic_finish *finish, size_t at, int x, int y, pixel *p) {
  const conic_tile_planes *planes = &tile->planes;
  const conic_surface *heaviest = &tile->projected->surfaces[planes->heaviest[at]];
  float viewer[3] = {0.0f, 0.0f, 0.0f}, mean_normal[3], shaded[3];
  p->weight = planes->weight[at];
  p->count = planes->count[at];
  p->id = tile->projected->surfaces[planes->nearest[at]].index;
  p->z = plane_z(&tile->projected->footprints[planes->heaviest[at]], x, y);
  for (int axis = 0; axis < 3; axis++)
    p->albedo[axis] = planes->color[axis][at] / p->weight;
  normal_of_sum(tile, at, heaviest, mean_normal, p->normal);
  if (finish->needs_viewer)
    viewer_at(tile->view, finish, x, y, viewer);
  conic_shade(finish, p->albedo, p->normal, mean_normal, viewer, shaded);
  for (int axis = 0; axis < 3; axis++)
    p->rgba[axis] = shaded[axis] * finish->exposure;
  p->rgba[3] = 1.0f;
}

static void finish_uncovered(const conic_finish *finish, pixel *p) {
  const conic_render_options *options = finish->options;
  *p = (pixel){.id = CONIC_NO_ID};
  if (options->has_background) {
    for (int axis = 0; axis < 3; axis++)
      p->rgba[axis] = options->background[axis] * finish->exposure;
    p->rgba[3] = 1.0f;
  }
}

static void store(const conic_image *image, conic_plane plane, size_t at, const float *values, size_t n) {
  float *to = image->planes[plane];
  if (to)
    for (size_t i = 0; i < n; i++)
      to[at * n + i] = values[i];
}

static void store_index(const conic_image *image, conic_plane plane, size_t at, uint32_t value) {
  uint32_t *to = image->planes[plane];
  if (to)
    to[at] = value;
}

static void store_pixel(const conic_image *image, size_t at, const pixel *p) {
  store(image, CONIC_PLANE_RGBA, at, p->rgba, 4);
  store(image, CONIC_PLANE_Z, at, &p->z, 1);
  store(image, CONIC_PLANE_NORMAL, at, p->normal, 3);
  store(image, CONIC_PLANE_ALBEDO, at, p->albedo, 3);
  store(image, CONIC_PLANE_WEIGHT, at, &p->weight, 1);
  store_index(image, CONIC_PLANE_COUNT, at, p->count);
  store_index(image, CONIC_PLANE_ID, at, p->id);
}

void conic_tile_resolve(conic_tile *tile, const conic_finish *finish, conic_image *image) {
  for (int y = tile->y_begin; y < tile->y_end; y++)
    for (int x = tile->x_begin; x < tile->x_end; x++) {
      pixel p;
      size_t at = conic_tile_place(tile, x, y);
      tile->n_fragments += tile->planes.fragments[at];
      if (tile->planes.nearest[at] != CONIC_NO_SPLAT) {
        finish_covered(tile, finish, at, x, y, &p);
        tile->n_covered++;
      } else
        finish_uncovered(finish, &p);
      store_pixel(image, (size_t)y * (size_t)image->width + (size_t)x, &p);
    }
}
