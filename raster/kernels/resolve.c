#include "raster/kernels/resolve.h"

#include <math.h>

#include "raster/tiles/coverage.h"
#include "raster/triangles/triangle_frame.h"

/* A finished pixel, before it is written to the planes that the image has. */
typedef struct pixel {
  float rgba[4], normal[3], albedo[3], weight;
} pixel;

/* The unit direction from what is seen at the pixel to the viewer, in world coordinates. */
static void viewer_at(const conic_finish *finish, float dx, float dy, float viewer[3]) {
  float scale = -1.0f / sqrtf((dx * dx + dy * dy) + 1.0f);
  for (int i = 0; i < 3; i++) {
    const float *m = finish->world_from_cam[i];
    viewer[i] = ((m[0] * dx + m[1] * dy) + m[2]) * scale;
  }
}

/* The weighted mean of the splats' normals, and its direction; where they cancel, that of the heaviest splat. */
static void normal_of_sum(const conic_band *band, int block, int l, float mean[3], float normal[3]) {
  const conic_block_sums *sums = &band->sums[block];
  float part = 1.0f / sums->weight[l];
  for (int axis = 0; axis < 3; axis++)
    mean[axis] = sums->normal[axis][l] * part;
  float norm = sqrtf((mean[0] * mean[0] + mean[1] * mean[1]) + mean[2] * mean[2]);
  float scale = 1.0f / norm;
  const conic_projected_surface *heaviest = &band->projected->surfaces[sums->heaviest[l]];
  for (int axis = 0; axis < 3; axis++)
    normal[axis] = norm > 0.0f ? mean[axis] * scale : heaviest->normal[axis];
}

static void finish_covered(const conic_band *band, const conic_finish *finish, int block, int l, float dx, float dy,
                           pixel *p) {
  float viewer[3], mean_normal[3], shaded[3];
  p->weight = band->sums[block].weight[l];
  for (int axis = 0; axis < 3; axis++)
    p->albedo[axis] = band->sums[block].color[axis][l] * (1.0f / p->weight);
  normal_of_sum(band, block, l, mean_normal, p->normal);
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

float conic_plane_z(const conic_footprint *footprint, int x, int y) {
  float dx = conic_row_dx(footprint, x), dy = conic_row_dy(footprint, y);
  float iz = (footprint->iz0 + footprint->plane_dy * dy) + footprint->plane_dx * dx;
  return 1.0f / conic_clamp_iz(footprint, iz);
}

static void resolve_pixel(const conic_band *band, const conic_finish *finish, const conic_tile_rays *rays, int x, int y,
                          int is_covered, conic_image *image) {
  pixel p;
  int block = (x - band->x) / CONIC_BLOCK_EDGE, l = (x - band->x) % CONIC_BLOCK_EDGE * CONIC_BLOCK_EDGE + (y - band->y);
  size_t at = (size_t)y * (size_t)image->width + (size_t)x;
  float z = 0.0f;
  if (is_covered) {
    finish_covered(band, finish, block, l, rays->x[x - rays->x_begin], rays->y[y - rays->y_begin], &p);
    z = band->triangles && band->triangles->heaviest[block] >> l & 1
            ? 1.0f / band->triangles->blocks[block].iz[l]
            : conic_plane_z(&band->projected->footprints[band->sums[block].heaviest[l]], x, y);
  } else
    finish_uncovered(finish, &p);
  store(image, CONIC_PLANE_RGBA, at, p.rgba, 4);
  store(image, CONIC_PLANE_NORMAL, at, p.normal, 3);
  store(image, CONIC_PLANE_ALBEDO, at, p.albedo, 3);
  store(image, CONIC_PLANE_WEIGHT, at, &p.weight, 1);
  store(image, CONIC_PLANE_Z, at, &z, 1);
}

/* Of the nearest that is seen. */
static uint32_t id_of(const conic_band *band, int block, int l) {
  const conic_triangle_row *triangles = band->triangles;
  if (!triangles || !(triangles->nearest[block] >> l & 1))
    return band->projected->surfaces[band->sums[block].nearest[l]].index;
  const conic_triangle_frame *frame = band->triangle_frame;
  return frame->first_id + frame->records[triangles->blocks[block].record[l]].index;
}

static void resolve_block_indices(const conic_band *band, int block, int l, size_t at, conic_image *image) {
  const conic_block_sums *sums = &band->sums[block];
  uint32_t *count = image->planes[CONIC_PLANE_COUNT], *id = image->planes[CONIC_PLANE_ID];
  int is_covered = !conic_block_is_empty(band, block) && sums->weight[l] > 0.0f;
  if (count)
    count[at] = is_covered ? sums->count[l] : 0;
  if (id)
    id[at] = is_covered ? id_of(band, block, l) : CONIC_NO_ID;
}

void conic_band_resolve_indices(const conic_band *band, conic_image *image) {
  if (!image->planes[CONIC_PLANE_COUNT] && !image->planes[CONIC_PLANE_ID])
    return;
  int y_end = band->y + CONIC_BLOCK_EDGE < image->height ? band->y + CONIC_BLOCK_EDGE : image->height;
  int x_end = band->x + band->n_blocks * CONIC_BLOCK_EDGE;
  for (int y = band->y; y < y_end; y++)
    for (int x = band->x; x < x_end && x < image->width; x++) {
      int column = x - band->x;
      resolve_block_indices(band, column / CONIC_BLOCK_EDGE,
                            column % CONIC_BLOCK_EDGE * CONIC_BLOCK_EDGE + (y - band->y),
                            (size_t)y * (size_t)image->width + (size_t)x, image);
    }
}

void conic_band_resolve(conic_band *band, const conic_finish *finish, const conic_tile_rays *rays, conic_image *image) {
  for (int block = 0; block < band->n_blocks; block++)
    for (int l = 0; l < CONIC_BLOCK_PIXELS; l++) {
      int x = band->x + block * CONIC_BLOCK_EDGE + l / CONIC_BLOCK_EDGE, y = band->y + l % CONIC_BLOCK_EDGE;
      if (x >= image->width || y >= image->height)
        continue;
      int is_covered = !conic_block_is_empty(band, block) && band->sums[block].weight[l] > 0.0f;
      resolve_pixel(band, finish, rays, x, y, is_covered, image);
      band->n_covered += (unsigned)is_covered;
    }
  conic_band_resolve_indices(band, image);
}
