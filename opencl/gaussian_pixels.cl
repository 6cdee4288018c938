/* Gaussians a pixel a work-item, a tile a group: for GPUs. Plain C's text, in which the tile is a pixel. */
#define CONIC_GAUSSIAN_TILE_PIXELS 1
#include "opencl/gaussians.cl"

__kernel void pixels_composite(GAUSSIAN_ARGUMENTS) {
  conic_device_gaussians picture = *given;
  uint item = (uint)get_global_id(0), i_tile = picture.first_tile + item / 256, at = item % 256;
  int x = (int)(i_tile % (uint)picture.n_tiles_x * CONIC_GAUSSIAN_TILE + at % CONIC_GAUSSIAN_TILE);
  int y = (int)(i_tile / (uint)picture.n_tiles_x * CONIC_GAUSSIAN_TILE + at / CONIC_GAUSSIAN_TILE);
  if (item / 256 >= picture.n_tiles || x >= picture.width || y >= picture.height)
    return;
  conic_gaussian_target target = GAUSSIAN_TARGET;
  conic_gaussian_list list = GAUSSIAN_LIST(i_tile);
  conic_gaussian_tile tile;
  list.room = room + CONIC_PIXELS_ROOM * (tile_begin[i_tile] - picture.first_entry) + CONIC_PIXELS_ROOM / 256 * at * list.n;
  conic_gaussian_tile_begin(&tile, x, y);
  if (picture.rules.shape == CONIC_SHAPE_ELLIPSE)
    composite_ellipses(&list, &tile);
  else if (picture.rules.shape == CONIC_SHAPE_RAY)
    composite_rays(&list, &tile);
  else
    composite_discs(&list, &tile);
  conic_gaussian_tile_end(&target, &tile);
}
