/* Pass 3 in lanes: conic_band_resolve (raster/loops/resolve.c) a part of a block at a time, with the same operations
 * in the same order. Included by raster_loops_body.h. */
#include "core/lanes/lanes_store.h"
#include "raster/loops/resolve.h"
#include "raster/loops/shade_lanes.h"

/* The finished pixels of one part of a block, channel by channel. Uncovered ones hold what an uncovered pixel is. */
typedef struct finished {
  lanes_mask covered;
  lanes rgba[4], normal[3], albedo[3], weight, z;
} finished;

/* Of one part of the block in the given column and row of the tile's. */
CONIC_INLINE void viewer_lanes(const conic_finish *finish, const conic_tile_rays *rays, int block, int i_row, size_t at,
                               lanes viewer[3]) {
  look_back(finish->world_from_cam, lanes_load(rays->block_x[block] + at), lanes_load(rays->block_y[i_row] + at),
            viewer);
}

/* Where the normals cancel, that of the heaviest splat. */
CONIC_INLINE void mend_normals(const conic_band *band, const conic_block_sums *sums, size_t at, lanes_mask cancelled,
                               lanes normal[3]) {
  if (!lanes_any(cancelled))
    return;
  lanes marks = lanes_keep(cancelled, lanes_of(1.0f));
  for (int lane = 0; lane < CONIC_LANES; lane++)
    for (int axis = 0; axis < 3 && marks[lane] != 0.0f; axis++)
      normal[axis][lane] = band->projected->surfaces[sums->heaviest[at + (size_t)lane]].normal[axis];
}

/* conic_plane_z of the heaviest splats. */
CONIC_INLINE lanes plane_z(const conic_band *band, const conic_block_sums *sums, size_t at, int x, int y,
                           lanes_mask covered) {
  float dx[CONIC_LANES], dy[CONIC_LANES], iz0[CONIC_LANES], plane_dx[CONIC_LANES], plane_dy[CONIC_LANES];
  float iz_far[CONIC_LANES], iz_near[CONIC_LANES];
  for (int lane = 0; lane < CONIC_LANES; lane++) {
    const conic_footprint *footprint = &band->projected->footprints[sums->heaviest[at + (size_t)lane]];
    dx[lane] = conic_row_dx(footprint, x + lane / CONIC_BLOCK_ROWS);
    dy[lane] = conic_row_dy(footprint, y + lane % CONIC_BLOCK_ROWS);
    iz0[lane] = footprint->iz0;
    plane_dx[lane] = footprint->plane_dx;
    plane_dy[lane] = footprint->plane_dy;
    iz_far[lane] = footprint->iz_far;
    iz_near[lane] = footprint->iz_near;
  }
  lanes iz = (lanes_load(iz0) + lanes_load(plane_dy) * lanes_load(dy)) + lanes_load(plane_dx) * lanes_load(dx);
  iz = lanes_min(lanes_max(iz, lanes_load(iz_far)), lanes_load(iz_near));
  return lanes_keep(covered, 1.0f / iz);
}

/* The triangles' own, where they are the heaviest. */
CONIC_INLINE lanes triangle_z(const conic_band *band, int block, size_t at, lanes z) {
  unsigned is_heaviest = band->triangles->heaviest[block] >> at & ((1u << CONIC_LANES) - 1);
  return lanes_select(lanes_mask_of(is_heaviest), 1.0f / lanes_load(band->triangles->blocks[block].iz + at), z);
}

CONIC_INLINE void finish_part(const conic_band *band, const conic_block_sums *sums, const conic_finish *finish,
                              const conic_tile_rays *rays, int block, size_t at, finished *done) {
  const conic_render_options *options = finish->options;
  lanes mean_normal[3], viewer[3], shaded[3], zero = lanes_of(0.0f);
  lanes weight = lanes_load(sums->weight + at), share = 1.0f / weight;
  lanes_mask covered = lanes_less(zero, weight);
  for (int axis = 0; axis < 3; axis++) {
    done->albedo[axis] = lanes_keep(covered, lanes_load(sums->color[axis] + at) * share);
    mean_normal[axis] = lanes_keep(covered, lanes_load(sums->normal[axis] + at) * share);
  }
  lanes norm = lanes_sqrt(dot_lanes(mean_normal, mean_normal)), scale = 1.0f / norm;
  lanes_mask has_direction = lanes_less(zero, norm);
  for (int axis = 0; axis < 3; axis++)
    done->normal[axis] = lanes_keep(has_direction, mean_normal[axis] * scale);
  mend_normals(band, sums, at, covered & lanes_less(lanes_keep(has_direction, lanes_of(1.0f)), lanes_of(1.0f)),
               done->normal);
  if (options->shading == CONIC_SHADE_NONE)
    memcpy(shaded, done->albedo, sizeof shaded);
  else {
    viewer_lanes(finish, rays, block, (band->y - rays->y_begin) / CONIC_BLOCK_EDGE, at, viewer);
    shade_lanes(finish, done->albedo, done->normal, mean_normal, viewer, shaded);
  }
  for (int axis = 0; axis < 3; axis++)
    done->rgba[axis] = lanes_select(covered, shaded[axis] * finish->exposure, lanes_of(finish->background[axis]));
  done->rgba[3] = lanes_select(covered, lanes_of(1.0f), lanes_of(finish->background[3]));
  done->weight = weight;
  done->covered = covered;
}

CONIC_INLINE void finish_uncovered(const conic_finish *finish, finished *done) {
  for (int channel = 0; channel < 4; channel++)
    done->rgba[channel] = lanes_of(finish->background[channel]);
  for (int axis = 0; axis < 3; axis++)
    done->normal[axis] = done->albedo[axis] = lanes_of(0.0f);
  done->weight = done->z = lanes_of(0.0f);
}

/* Writes a part to the rows of the planes that the image has. */
CONIC_INLINE void store_part(const finished *done, size_t column, const conic_image *image, conic_band_rows *rows) {
  const size_t stride = CONIC_GREATEST_TILE;
  if (image->planes[CONIC_PLANE_RGBA])
    lanes_store_quads(rows->rgba[0] + 4 * column, 4 * stride, done->rgba);
  if (image->planes[CONIC_PLANE_NORMAL])
    lanes_store_triples(rows->normal[0] + 3 * column, 3 * stride, done->normal);
  if (image->planes[CONIC_PLANE_ALBEDO])
    lanes_store_triples(rows->albedo[0] + 3 * column, 3 * stride, done->albedo);
  if (image->planes[CONIC_PLANE_WEIGHT])
    lanes_store_plane(rows->weight[0] + column, stride, done->weight);
  if (image->planes[CONIC_PLANE_Z])
    lanes_store_plane(rows->z[0] + column, stride, done->z);
}

CONIC_INLINE void resolve_part(conic_band *band, int block, int part, const conic_finish *finish,
                               const conic_tile_rays *rays, const conic_image *image, conic_band_rows *rows) {
  finished done;
  const conic_block_sums *sums = &band->sums[block];
  int column = block * CONIC_BLOCK_EDGE + part * (CONIC_LANES / CONIC_BLOCK_ROWS), x = band->x + column;
  size_t at = (size_t)part * CONIC_LANES;
  if (conic_block_is_empty(band, block))
    finish_uncovered(finish, &done);
  else {
    finish_part(band, sums, finish, rays, block, at, &done);
    done.z = lanes_of(0.0f);
    if (image->planes[CONIC_PLANE_Z])
      done.z = plane_z(band, sums, at, x, band->y, done.covered);
    if (band->triangles && image->planes[CONIC_PLANE_Z])
      done.z = triangle_z(band, block, at, done.z);
    band->n_covered += lanes_count(done.covered);
  }
  store_part(&done, (size_t)column, image, rows);
}

CONIC_INLINE void store_rows(const conic_band *band, const float *rows, size_t stride, conic_plane plane,
                             size_t n_channels, conic_image *image) {
  float *to = image->planes[plane];
  int x = band->x - band->first_column, y = band->y - band->first_row;
  int x_end = x + band->n_blocks * CONIC_BLOCK_EDGE;
  size_t n_columns = (size_t)((x_end < image->width ? x_end : image->width) - x);
  for (int row = 0; to && row < CONIC_BLOCK_EDGE && y + row < image->height; row++) {
    size_t at = (size_t)(y + row) * (size_t)image->width + (size_t)x;
    lanes_stream_row(to + at * n_channels, rows + (size_t)row * stride, n_columns * n_channels);
  }
}

static void store_all_rows(const conic_band *band, const conic_band_rows *rows, conic_image *image) {
  const size_t stride = CONIC_GREATEST_TILE;
  store_rows(band, rows->rgba[0], 4 * stride, CONIC_PLANE_RGBA, 4, image);
  store_rows(band, rows->normal[0], 3 * stride, CONIC_PLANE_NORMAL, 3, image);
  store_rows(band, rows->albedo[0], 3 * stride, CONIC_PLANE_ALBEDO, 3, image);
  store_rows(band, rows->weight[0], stride, CONIC_PLANE_WEIGHT, 1, image);
  store_rows(band, rows->z[0], stride, CONIC_PLANE_Z, 1, image);
}

static void resolve(conic_band *band, const conic_finish *finish, const conic_tile_rays *rays, conic_image *image) {
  _Alignas(64) conic_band_rows rows;
  for (int block = 0; block < band->n_blocks; block++)
    for (int part = 0; part < CONIC_PARTS; part++)
      resolve_part(band, block, part, finish, rays, image, &rows);
  store_all_rows(band, &rows, image);
  conic_band_resolve_indices(band, image);
}
