/* Gaussians a tile a work-item, 16 pixels a vector: for CPUs. The lanes' own text. */
#include "opencl/gaussians.cl"
#include "opencl/lanes_words.cl"

#include "gaussians/loops/gaussian_loops_body.h"

#include "opencl/gaussian_rays.cl"

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void tiles_composite(GAUSSIAN_ARGUMENTS) {
  conic_device_gaussians picture = *given;
  uint i_tile = picture.first_tile + (uint)get_global_id(0);
  conic_gaussian_target target = GAUSSIAN_TARGET;
  conic_gaussian_list list = GAUSSIAN_LIST(i_tile);
  conic_gaussian_tile tile;
  list.room = room + CONIC_TILES_ROOM * (tile_begin[i_tile] - picture.first_entry);
  conic_gaussian_tile_begin(&tile, (int)(i_tile % (uint)picture.n_tiles_x) * CONIC_GAUSSIAN_TILE,
                            (int)(i_tile / (uint)picture.n_tiles_x) * CONIC_GAUSSIAN_TILE);
  if (picture.rules.shape == CONIC_SHAPE_ELLIPSE)
    composite_ellipses_in_lanes(&list, &tile);
  else if (picture.rules.shape == CONIC_SHAPE_RAY)
    composite_rays_by_blocks(&list, &tile);
  else
    composite_discs_in_lanes(&list, &tile);
  conic_gaussian_tile_end(&target, &tile);
}
