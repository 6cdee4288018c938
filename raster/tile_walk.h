/* Walks over the fragments of a tile: every pixel that every splat of the tile's list covers, splats in file order,
 * pixels of a row a few at a time. */
#ifndef RASTER_TILE_WALK_H
#define RASTER_TILE_WALK_H

#include "raster/coverage.h"
#include "raster/lanes.h"

/* Neighbouring pixels of a row that one splat covers, or not. */
typedef struct conic_fragments {
  conic_mask covered;
  conic_floats q;
  conic_floats iz, plane_iz; /* as in conic_fragment */
  conic_floats scale;
} conic_fragments;

/* Does something with the fragments of footprint i_footprint whose first pixel is at `at` in the tile's planes. Inlined
 * into the walk; at least one pixel is covered. */
typedef void conic_visit(conic_tile *tile, uint32_t i_footprint, const conic_footprint *footprint, size_t at,
                         const conic_fragments *fragments);

/* The part of a footprint's box that lies in the tile. */
typedef struct conic_window {
  int x_begin, x_end, y_begin, y_end;
} conic_window;

#define CONIC_INLINE static inline __attribute__((always_inline))

CONIC_INLINE conic_window conic_tile_window(const conic_tile *tile, const conic_footprint *footprint) {
  conic_window window;
  window.x_begin = footprint->x_begin > tile->x_begin ? footprint->x_begin : tile->x_begin;
  window.x_end = footprint->x_end < tile->x_end ? footprint->x_end : tile->x_end;
  window.y_begin = footprint->y_begin > tile->y_begin ? footprint->y_begin : tile->y_begin;
  window.y_end = footprint->y_end < tile->y_end ? footprint->y_end : tile->y_end;
  return window;
}

/* Where a row's pixels start in the tile's planes: pixel x is at the result plus x - tile->x_begin. */
CONIC_INLINE size_t conic_tile_row(const conic_tile *tile, int y) {
  return (size_t)(y - tile->y_begin) * (size_t)tile->stride;
}

CONIC_INLINE conic_mask conic_pixels_from(int x) {
  return (conic_mask){x, x + 1, x + 2, x + 3};
}

/* The same operations, lane by lane, as conic_row_q, conic_row_iz and the plane's depth. */
CONIC_INLINE void conic_walk_ellipse(conic_tile *tile, uint32_t i_footprint, const conic_footprint *footprint,
                                     conic_window window, conic_visit *visit) {
  float support = tile->view->support;
  conic_span span = conic_span_begin(footprint, window.x_begin, window.x_end);
  conic_fragments fragments = {.scale = conic_splat_lanes(1.0f)};
  conic_floats far_lanes = conic_splat_lanes(footprint->iz_far), near_lanes = conic_splat_lanes(footprint->iz_near);
  for (int y = window.y_begin; y < window.y_end; y++) {
    int begin, end;
    conic_row row = conic_row_begin(footprint, conic_row_dy(footprint, y));
    conic_row_span(&span, &row, support, &begin, &end);
    size_t at = conic_tile_row(tile, y) + (size_t)(begin - tile->x_begin);
    for (int x = begin; x < end; x += CONIC_LANES, at += CONIC_LANES) {
      conic_mask pixels = conic_pixels_from(x);
      conic_floats dx = __builtin_convertvector(pixels - footprint->x, conic_floats) + footprint->dx0;
      conic_floats major = footprint->s1 * dx + row.q_offset;
      fragments.q = major * major + row.q_rest;
      fragments.covered = (fragments.q < support) & (pixels < window.x_end);
      if (!conic_any(fragments.covered))
        continue;
      conic_floats iz = row.iz_offset + footprint->iz_dx * dx;
      iz = conic_select(iz > far_lanes, iz, far_lanes);
      fragments.iz = conic_select(iz < near_lanes, iz, near_lanes);
      fragments.plane_iz = row.plane_offset + footprint->plane_dx * dx;
      visit(tile, i_footprint, footprint, at, &fragments);
    }
  }
}

CONIC_INLINE void conic_walk_ray(conic_tile *tile, uint32_t i_footprint, const conic_footprint *footprint,
                                 conic_window window, conic_visit *visit) {
  const conic_ray *ray = &tile->projected->rays[footprint->i_ray];
  for (int y = window.y_begin; y < window.y_end; y++) {
    float dy = conic_row_dy(footprint, y);
    size_t at = conic_tile_row(tile, y) + (size_t)(window.x_begin - tile->x_begin);
    for (int x = window.x_begin; x < window.x_end; x += CONIC_LANES, at += CONIC_LANES) {
      conic_fragments fragments;
      memset(&fragments, 0, sizeof fragments);
      for (int lane = 0; lane < CONIC_LANES && x + lane < window.x_end; lane++) {
        conic_fragment one;
        if (!conic_ray_fragment(tile->view, footprint, ray, conic_row_dx(footprint, x + lane), dy, &one))
          continue;
        fragments.covered[lane] = -1;
        fragments.q[lane] = one.q;
        fragments.iz[lane] = one.iz;
        fragments.plane_iz[lane] = one.plane_iz;
        fragments.scale[lane] = one.scale;
      }
      if (conic_any(fragments.covered))
        visit(tile, i_footprint, footprint, at, &fragments);
    }
  }
}

CONIC_INLINE void conic_walk_tile(conic_tile *tile, conic_visit *visit) {
  enum { AHEAD = 12 };
  const conic_footprint *footprints = tile->projected->footprints;
  for (size_t i = 0; i < tile->n_references; i++) {
    uint32_t i_footprint = tile->references[i];
    const conic_footprint *footprint = &footprints[i_footprint];
    if (i + AHEAD < tile->n_references) {
      __builtin_prefetch(&footprints[tile->references[i + AHEAD]]);
      __builtin_prefetch(&tile->projected->surfaces[tile->references[i + AHEAD]]);
    }
    conic_window window = conic_tile_window(tile, footprint);
    if (footprint->s3 != 0.0f)
      conic_walk_ellipse(tile, i_footprint, footprint, window, visit);
    else
      conic_walk_ray(tile, i_footprint, footprint, window, visit);
  }
}

#endif
