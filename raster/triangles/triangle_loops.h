/* The table of triangles (raster/loops/raster_loops.h). */
#pragma once

#include "raster/tiles/finish.h"
#include "raster/triangles/triangle_frame.h"

/* The loops of triangles. */
typedef struct conic_triangle_loops {
  /* The vertices begin … end - 1 on the screen. */
  void (*vertices)(const conic_triangle_frame *frame, size_t begin, size_t end, conic_screen_vertex *vertices);
  /* The nearest at each pixel of the tile whose first is (x, y): blocks, covered, n_fragments. */
  void (*draw)(const conic_triangle_frame *frame, size_t i_tile, int x, int y, conic_triangle_tile *tile);
  /* After pass 1: which of a band's triangles are seen, and what they hide, in its thresholds. */
  void (*hide)(conic_band *band, const conic_tile_rays *rays);
  /* After pass 2: adds those that are seen to the sums; heaviest, nearest. */
  void (*add)(conic_band *band, const conic_finish *finish, const conic_tile_rays *rays);
} conic_triangle_loops;
