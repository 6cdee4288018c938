#include "raster/tiles/finish.h"

void conic_tile_rays_init(const conic_view *view, int x_begin, int y_begin, conic_tile_rays *rays) {
  rays->x_begin = x_begin;
  rays->y_begin = y_begin;
  for (int i = 0; i < CONIC_GREATEST_TILE; i++) {
    rays->x[i] = (float)(((double)(x_begin + i) + 0.5 - view->cx) / view->fx);
    rays->y[i] = (float)(((double)(y_begin + i) + 0.5 - view->cy) / view->fy);
  }
  memset(rays->block_x[CONIC_NO_BLOCK], 0, sizeof rays->block_x[CONIC_NO_BLOCK]);
  for (int block = 0; block < CONIC_BAND_BLOCKS; block++)
    for (int l = 0; l < CONIC_BLOCK_PIXELS; l++) {
      rays->block_x[block][l] = rays->x[block * CONIC_BLOCK_EDGE + l / CONIC_BLOCK_EDGE];
      rays->block_y[block][l] = rays->y[block * CONIC_BLOCK_EDGE + l % CONIC_BLOCK_EDGE];
    }
}
