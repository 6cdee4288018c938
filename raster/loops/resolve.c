#include "raster/loops/resolve.h"

#include "raster/tiles/coverage.h"
#include "raster/triangles/triangle_frame.h"

static void store(const conic_image *image, conic_plane plane, size_t at, const float *values, size_t n) {
  float *to = image->planes[plane];
  if (to)
    for (size_t i = 0; i < n; i++)
      to[at * n + i] = values[i];
}

/* Pixel l of a block; returns whether it is covered. */
static unsigned resolve_pixel(const conic_band *band, const conic_finish *finish, const conic_tile_rays *rays,
                              int block, int l, conic_image *image) {
  conic_finished_pixel pixel;
  int x = band->x + block * CONIC_BLOCK_EDGE + l / CONIC_BLOCK_EDGE, y = band->y + l % CONIC_BLOCK_EDGE;
  int column = x - band->first_column, row = y - band->first_row;
  size_t at = (size_t)row * (size_t)image->width + (size_t)column;
  float weight = 0.0f, z = 0.0f;
  if (column >= image->width || row >= image->height)
    return 0;
  unsigned is_covered = !conic_block_is_empty(band, block) && band->sums[block].weight[l] > 0.0f;
  if (is_covered) {
    const conic_block_sums *sums = &band->sums[block];
    const float color[3] = {sums->color[0][l], sums->color[1][l], sums->color[2][l]};
    const float normal[3] = {sums->normal[0][l], sums->normal[1][l], sums->normal[2][l]};
    weight = sums->weight[l];
    conic_finish_covered(finish, weight, color, normal, band->projected->surfaces[sums->heaviest[l]].normal,
                         rays->x[x - rays->x_begin], rays->y[y - rays->y_begin], &pixel);
    z = band->triangles && band->triangles->heaviest[block] >> l & 1
            ? 1.0f / band->triangles->blocks[block].iz[l]
            : conic_plane_z(&band->projected->footprints[sums->heaviest[l]], x, y);
  } else
    conic_finish_uncovered(finish, &pixel);
  store(image, CONIC_PLANE_RGBA, at, pixel.rgba, 4);
  store(image, CONIC_PLANE_NORMAL, at, pixel.normal, 3);
  store(image, CONIC_PLANE_ALBEDO, at, pixel.albedo, 3);
  store(image, CONIC_PLANE_WEIGHT, at, &weight, 1);
  store(image, CONIC_PLANE_Z, at, &z, 1);
  return is_covered;
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
  int x = band->x - band->first_column, y = band->y - band->first_row;
  int n_columns = band->n_blocks * CONIC_BLOCK_EDGE;
  for (int row = 0; row < CONIC_BLOCK_EDGE && y + row < image->height; row++)
    for (int column = 0; column < n_columns && x + column < image->width; column++)
      resolve_block_indices(band, column / CONIC_BLOCK_EDGE, column % CONIC_BLOCK_EDGE * CONIC_BLOCK_EDGE + row,
                            (size_t)(y + row) * (size_t)image->width + (size_t)(x + column), image);
}

void conic_band_resolve(conic_band *band, const conic_finish *finish, const conic_tile_rays *rays, conic_image *image) {
  for (int block = 0; block < band->n_blocks; block++)
    for (int l = 0; l < CONIC_BLOCK_PIXELS; l++)
      band->n_covered += resolve_pixel(band, finish, rays, block, l, image);
  conic_band_resolve_indices(band, image);
}
