/* The samples of a tile that a triangle covers, one by one. Shared by plain C and by a device's programs
 * (opencl/triangles.cl). */
#pragma once

#include "raster/triangles/triangle.h"

/* What a pixel of a tile knows of triangles: the nearest one's depth, 0 where there is none, and its record. */
typedef struct conic_triangle_block {
  float iz[CONIC_BLOCK_PIXELS];
  uint32_t record[CONIC_BLOCK_PIXELS];
} conic_triangle_block;

/* A tile to draw in. */
typedef struct conic_triangle_canvas {
  conic_triangle_block *blocks; /* row by row, `stride` in each */
  int stride, x, y, tile;       /* its first pixel and its edge */
  int width, height;            /* of the image */
} conic_triangle_canvas;

/* The pixels of a box in the tile. */
typedef struct conic_triangle_span {
  int x_begin, x_end, y_begin, y_end;
} conic_triangle_span;

static inline conic_triangle_span conic_triangle_span_in(const conic_box *box, const conic_triangle_canvas *to) {
  conic_triangle_span span;
  span.x_begin = box->x_begin > to->x ? box->x_begin : to->x;
  span.y_begin = box->y_begin > to->y ? box->y_begin : to->y;
  span.x_end = box->x_end < to->x + to->tile ? box->x_end : to->x + to->tile;
  span.y_end = box->y_end < to->y + to->tile ? box->y_end : to->y + to->tile;
  return span;
}

/* Returns how many samples the record covers. */
static inline unsigned conic_triangle_draw_samples(const conic_triangle_record *record, uint32_t i_record,
                                                   const conic_triangle_canvas *to) {
  const conic_triangle_span span = conic_triangle_span_in(&record->box, to);
  unsigned n_covered = 0;
  conic_triangle_edges edges;
  conic_triangle_edges_of(record, &edges);
  for (int y = span.y_begin; y < span.y_end; y++)
    for (int x = span.x_begin; x < span.x_end; x++) {
      float iz;
      if (!conic_triangle_sample(record, &edges, x, y, &iz))
        continue;
      conic_triangle_block *block =
          &to->blocks[(y - to->y) / CONIC_BLOCK_EDGE * to->stride + (x - to->x) / CONIC_BLOCK_EDGE];
      int l = x % CONIC_BLOCK_EDGE * CONIC_BLOCK_EDGE + y % CONIC_BLOCK_EDGE;
      n_covered++;
      if (!(block->iz[l] < iz))
        continue;
      block->iz[l] = iz;
      block->record[l] = i_record;
    }
  return n_covered;
}
