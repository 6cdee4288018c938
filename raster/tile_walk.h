/* Walks over the fragments of a tile: every pixel that every splat of the tile's list covers, splats in file order. */
#ifndef RASTER_TILE_WALK_H
#define RASTER_TILE_WALK_H

#include "raster/coverage.h"

/* Does something with one fragment: footprint i_footprint covers the pixel at `at` in the tile's planes. Inlined into
 * the walk. */
typedef void conic_visit(conic_tile *tile, uint32_t i_footprint, const conic_footprint *footprint, size_t at,
                         const conic_fragment *fragment);

/* The part of a footprint's box that lies in the tile. */
typedef struct conic_window {
  int x_begin, x_end, y_begin, y_end;
} conic_window;

static inline conic_window conic_tile_window(const conic_tile *tile, const conic_footprint *footprint) {
  conic_window window;
  window.x_begin = footprint->x_begin > tile->x_begin ? footprint->x_begin : tile->x_begin;
  window.x_end = footprint->x_end < tile->x_end ? footprint->x_end : tile->x_end;
  window.y_begin = footprint->y_begin > tile->y_begin ? footprint->y_begin : tile->y_begin;
  window.y_end = footprint->y_end < tile->y_end ? footprint->y_end : tile->y_end;
  return window;
}

/* Where a row's pixels start in the tile's planes, such that pixel x is at the result plus x - tile->x_begin. */
static inline size_t conic_tile_row(const conic_tile *tile, int y) {
  return (size_t)(y - tile->y_begin) * (size_t)tile->edge;
}

static inline __attribute__((always_inline)) void conic_walk_ellipse(conic_tile *tile, uint32_t i_footprint,
                                                                     const conic_footprint *footprint,
                                                                     conic_window window, conic_visit *visit) {
  float support = tile->view->support;
  conic_fragment fragment = {.scale = 1.0f};
  for (int y = window.y_begin; y < window.y_end; y++) {
    int begin, end;
    conic_row row = conic_row_begin(footprint, conic_row_dy(footprint, y));
    conic_row_span(footprint, &row, support, window.x_begin, window.x_end, &begin, &end);
    size_t at = conic_tile_row(tile, y) + (size_t)(begin - tile->x_begin);
    for (int x = begin; x < end; x++, at++) {
      float dx = conic_row_dx(footprint, x);
      fragment.q = conic_row_q(footprint, &row, dx);
      if (!(fragment.q < support))
        continue;
      fragment.iz = conic_row_iz(footprint, &row, dx);
      fragment.plane_iz = row.plane_offset + footprint->plane_dx * dx;
      visit(tile, i_footprint, footprint, at, &fragment);
    }
  }
}

static inline __attribute__((always_inline)) void conic_walk_ray(conic_tile *tile, uint32_t i_footprint,
                                                                 const conic_footprint *footprint, conic_window window,
                                                                 conic_visit *visit) {
  const conic_ray *ray = &tile->projected->rays[footprint->i_ray];
  conic_fragment fragment;
  for (int y = window.y_begin; y < window.y_end; y++) {
    float dy = conic_row_dy(footprint, y);
    size_t at = conic_tile_row(tile, y) + (size_t)(window.x_begin - tile->x_begin);
    for (int x = window.x_begin; x < window.x_end; x++, at++)
      if (conic_ray_fragment(tile->view, footprint, ray, conic_row_dx(footprint, x), dy, &fragment))
        visit(tile, i_footprint, footprint, at, &fragment);
  }
}

static inline __attribute__((always_inline)) void conic_walk_tile(conic_tile *tile, conic_visit *visit) {
  for (size_t i = 0; i < tile->n_references; i++) {
    uint32_t i_footprint = tile->references[i];
    const conic_footprint *footprint = &tile->projected->footprints[i_footprint];
    conic_window window = conic_tile_window(tile, footprint);
    if (footprint->s3 != 0.0f)
      conic_walk_ellipse(tile, i_footprint, footprint, window, visit);
    else
      conic_walk_ray(tile, i_footprint, footprint, window, visit);
  }
}

#endif
