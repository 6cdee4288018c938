/* Pass 3 in lanes: conic_tile_resolve (raster/resolve.c) a block at a time, with the same operations in the same order.
 * Included by tile_kernels_body.h. */
#include "raster/resolve.h"

/* The finished pixels of one block, channel by channel. Uncovered ones hold what an uncovered pixel is. */
typedef struct finished {
  lanes_mask covered;
  lanes rgb[3], alpha, normal[3], albedo[3], weight;
} finished;

CONIC_INLINE lanes dot_lanes(const lanes a[3], const lanes b[3]) {
  return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2];
}

/* conic_shade (raster/shade.c). */
CONIC_INLINE void shade_lanes(const conic_finish *finish, const lanes albedo[3], const lanes normal[3],
                              const lanes mean_normal[3], const lanes viewer[3], lanes shaded[3]) {
  const conic_render_options *options = finish->options;
  lanes zero = lanes_of(0.0f), light[3], glossy = zero;
  for (int i = 0; i < 3; i++)
    light[i] = options->has_light ? lanes_of(finish->light[i]) : viewer[i];
  lanes towards_light = dot_lanes(normal, light);
  lanes lit = CONIC_AMBIENT + CONIC_DIFFUSE * lanes_max(dot_lanes(mean_normal, light), zero);
  if (options->shading == CONIC_SHADE_PHONG) {
    lanes reflected[3];
    for (int i = 0; i < 3; i++)
      reflected[i] = 2.0f * towards_light * normal[i] - light[i];
    lanes gloss = lanes_max(dot_lanes(reflected, viewer), zero);
    for (int i = 0; i < 5; i++)
      gloss *= gloss;
    glossy = lanes_keep(lanes_less(zero, towards_light), CONIC_SPECULAR * gloss * dot_lanes(mean_normal, mean_normal));
  }
  for (int i = 0; i < 3; i++)
    shaded[i] = albedo[i] * lit + glossy;
}

CONIC_INLINE void viewer_lanes(const conic_finish *finish, const conic_tile_rays *rays, int column, int row,
                               lanes viewer[3]) {
  lanes dx, dy;
  for (int lane = 0; lane < CONIC_LANES; lane++) {
    dx[lane] = rays->x[column + lane / CONIC_BLOCK_ROWS];
    dy[lane] = rays->y[row + lane % CONIC_BLOCK_ROWS];
  }
  lanes scale = -1.0f / lanes_sqrt((dx * dx + dy * dy) + 1.0f);
  for (int i = 0; i < 3; i++) {
    const float *m = finish->world_from_cam[i];
    viewer[i] = ((m[0] * dx + m[1] * dy) + m[2]) * scale;
  }
}

/* Where the normals cancel, that of the heaviest splat. */
CONIC_INLINE void mend_normals(const conic_tile *tile, size_t at, lanes_mask cancelled, lanes normal[3]) {
  if (!lanes_any(cancelled))
    return;
  lanes marks = lanes_keep(cancelled, lanes_of(1.0f));
  for (int lane = 0; lane < CONIC_LANES; lane++)
    for (int axis = 0; axis < 3 && marks[lane] != 0.0f; axis++)
      normal[axis][lane] = tile->projected->surfaces[tile->planes.heaviest[at + (size_t)lane]].normal[axis];
}

CONIC_INLINE void finish_block(const conic_tile *tile, const conic_finish *finish, const conic_tile_rays *rays,
                               int column, int row, size_t at, finished *block) {
  const conic_tile_planes *planes = &tile->planes;
  const conic_render_options *options = finish->options;
  lanes mean_normal[3], viewer[3], shaded[3], zero = lanes_of(0.0f);
  lanes weight = lanes_load(&planes->weight[at]);
  lanes_mask covered = lanes_less(zero, weight);
  for (int axis = 0; axis < 3; axis++) {
    block->albedo[axis] = lanes_keep(covered, lanes_load(&planes->color[axis][at]) / weight);
    mean_normal[axis] = lanes_keep(covered, lanes_load(&planes->normal[axis][at]) / weight);
  }
  lanes norm = lanes_sqrt(dot_lanes(mean_normal, mean_normal));
  lanes_mask has_direction = lanes_less(zero, norm);
  for (int axis = 0; axis < 3; axis++)
    block->normal[axis] = lanes_keep(has_direction, mean_normal[axis] / norm);
  mend_normals(tile, at, covered & lanes_less(lanes_keep(has_direction, lanes_of(1.0f)), lanes_of(1.0f)),
               block->normal);
  if (options->shading == CONIC_SHADE_NONE)
    memcpy(shaded, block->albedo, sizeof shaded);
  else {
    viewer_lanes(finish, rays, column, row, viewer);
    shade_lanes(finish, block->albedo, block->normal, mean_normal, viewer, shaded);
  }
  for (int axis = 0; axis < 3; axis++)
    block->rgb[axis] = lanes_select(covered, shaded[axis] * finish->exposure, lanes_of(finish->background[axis]));
  block->alpha = lanes_select(covered, lanes_of(1.0f), lanes_of(finish->background[3]));
  block->weight = weight;
  block->covered = covered;
}

/* From channels of lanes to the channels of pixels, those of the block that are in the tile. */
CONIC_INLINE void store_block(const conic_tile *tile, const conic_image *image, conic_plane plane, int x, int y,
                              const lanes *channels, size_t n_channels) {
  float *to = image->planes[plane], from[4][CONIC_LANES];
  if (!to)
    return;
  for (size_t channel = 0; channel < n_channels; channel++)
    lanes_store(from[channel], channels[channel]);
  int n_rows = tile->y_end - y < CONIC_BLOCK_ROWS ? tile->y_end - y : CONIC_BLOCK_ROWS;
  int n_columns = tile->x_end - x < CONIC_BLOCK_COLUMNS ? tile->x_end - x : CONIC_BLOCK_COLUMNS;
  for (int row = 0; row < n_rows; row++) {
    float *pixel = to + ((size_t)(y + row) * (size_t)image->width + (size_t)x) * n_channels;
    for (int column = 0; column < n_columns; column++)
      for (size_t channel = 0; channel < n_channels; channel++)
        *pixel++ = from[channel][column * CONIC_BLOCK_ROWS + row];
  }
}

static void resolve(conic_tile *tile, const conic_finish *finish, conic_image *image) {
  conic_tile_rays rays;
  conic_tile_rays_init(tile, &rays);
  for (int y = tile->y_begin; y < tile->y_end; y += CONIC_BLOCK_ROWS)
    for (int x = tile->x_begin; x < tile->x_end; x += CONIC_BLOCK_COLUMNS) {
      finished block;
      size_t at = conic_tile_place(tile, x, y);
      finish_block(tile, finish, &rays, x - tile->x_begin, y - tile->y_begin, at, &block);
      tile->n_covered += lanes_count(block.covered);
      const lanes rgba[4] = {block.rgb[0], block.rgb[1], block.rgb[2], block.alpha};
      store_block(tile, image, CONIC_PLANE_RGBA, x, y, rgba, 4);
      store_block(tile, image, CONIC_PLANE_NORMAL, x, y, block.normal, 3);
      store_block(tile, image, CONIC_PLANE_ALBEDO, x, y, block.albedo, 3);
      store_block(tile, image, CONIC_PLANE_WEIGHT, x, y, &block.weight, 1);
    }
  conic_tile_resolve_indices(tile, image);
}
