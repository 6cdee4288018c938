/* The samples that a triangle covers (raster/triangles/triangle_samples.h) a part of a block at a time, with the same
 * operations in the same order. C and OpenCL C share this text. */
#pragma once

#include "core/lanes/lanes.h"
#include "raster/triangles/triangle_samples.h"

/* A part's columns and rows of pixels. */
CONIC_INLINE int_lanes part_columns(int part) {
  return lanes_columns() + part * (CONIC_LANES / CONIC_BLOCK_EDGE);
}

/* A record, and what of it is the same in all blocks. */
typedef struct drawing {
  int_lanes within[3][CONIC_PARTS]; /* how far each edge's value is from that at the block's first pixel, in steps */
  lanes iz_far, iz_near;
  const conic_triangle_record *record;
  conic_triangle_edges edges;
  int32_t most[3]; /* the most that it gains */
  uint32_t i_record;
} drawing;

CONIC_INLINE void begin_drawing(const conic_triangle_record *record, uint32_t i_record, drawing *d) {
  d->record = record;
  d->i_record = i_record;
  conic_triangle_edges_of(record, &d->edges);
  for (int k = 0; k < 3; k++) {
    int32_t a = (int32_t)d->edges.a[k], b = (int32_t)d->edges.b[k];
    d->most[k] = (CONIC_BLOCK_EDGE - 1) * ((a > 0 ? a : 0) + (b > 0 ? b : 0));
    for (int part = 0; part < CONIC_PARTS; part++)
      d->within[k][part] = part_columns(part) * a + lanes_rows() * b;
  }
  d->iz_far = lanes_of(conic_triangle_far(record));
  d->iz_near = lanes_of(conic_triangle_near(record));
}

/* The samples of a block from the values of the edges at its first; those beyond the image are none. */
CONIC_INLINE unsigned draw_block(const drawing *d, const int64_t e[3], int columns_left, int rows_left,
                                 conic_triangle_block *block) {
  int32_t steps[3];
  for (int k = 0; k < 3; k++) {
    steps[k] = conic_triangle_steps(e[k] + d->edges.bias[k]);
    if (steps[k] + d->most[k] < 0)
      return 0;
  }
  conic_affine depth = conic_triangle_depth(d->record, &d->edges, e[1], e[2]);
  unsigned n_covered = 0;
  for (int part = 0; part < CONIC_PARTS; part++) {
    size_t at = (size_t)part * CONIC_LANES;
    int_lanes columns = part_columns(part), rows = lanes_rows();
    int_lanes inside = (steps[0] + d->within[0][part]) | (steps[1] + d->within[1][part]) |
                       (steps[2] + d->within[2][part]); /* its sign is set where any of theirs is */
    lanes_mask covered = lanes_less_int(lanes_of_int(-1), inside);
    if (columns_left < CONIC_BLOCK_EDGE || rows_left < CONIC_BLOCK_EDGE)
      covered &= lanes_less_int(columns, lanes_of_int(columns_left)) & lanes_less_int(rows, lanes_of_int(rows_left));
    lanes iz = (depth.at + depth.by_y * lanes_of_ints(rows)) + depth.by_x * lanes_of_ints(columns);
    iz = lanes_min(lanes_max(iz, d->iz_far), d->iz_near);
    lanes kept = lanes_load(block->iz + at);
    lanes_mask nearer = covered & lanes_less(kept, iz);
    lanes_store(block->iz + at, lanes_select(nearer, iz, kept));
    lanes_replace_indices(block->record + at, nearer, lanes_of_index(d->i_record));
    n_covered += lanes_count(covered);
  }
  return n_covered;
}

/* Then samples one by one are quicker. */
CONIC_INLINE int has_few_samples(const conic_box *box) {
  enum { FEW = 3 };
  return (box->x_end - box->x_begin) * (box->y_end - box->y_begin) <= FEW;
}

/* A record of many samples, block by block. Returns how many it covers. */
CONIC_OUTLINE unsigned draw_blocks(const conic_triangle_record *record, uint32_t i_record,
                                   const conic_triangle_canvas *to) {
  enum { BLOCK_STEP = CONIC_BLOCK_EDGE * CONIC_SUBPIXELS };
  const conic_triangle_span span = conic_triangle_span_in(&record->box, to);
  int first = (span.x_begin - to->x) / CONIC_BLOCK_EDGE, first_row = (span.y_begin - to->y) / CONIC_BLOCK_EDGE;
  unsigned n_covered = 0;
  int64_t of_row[3];
  drawing d;
  begin_drawing(record, i_record, &d);
  for (int k = 0; k < 3; k++)
    of_row[k] =
        conic_triangle_edge_at(&d.edges, k, to->x + first * CONIC_BLOCK_EDGE, to->y + first_row * CONIC_BLOCK_EDGE);
  for (int i_row = first_row; to->y + i_row * CONIC_BLOCK_EDGE < span.y_end; i_row++) {
    int64_t e[3] = {of_row[0], of_row[1], of_row[2]};
    int rows_left = to->height - (to->y + i_row * CONIC_BLOCK_EDGE);
    for (int block = first; to->x + block * CONIC_BLOCK_EDGE < span.x_end; block++) {
      int columns_left = to->width - (to->x + block * CONIC_BLOCK_EDGE);
      n_covered += draw_block(&d, e, columns_left, rows_left, &to->blocks[i_row * to->stride + block]);
      for (int k = 0; k < 3; k++)
        e[k] += d.edges.a[k] * BLOCK_STEP;
    }
    for (int k = 0; k < 3; k++)
      of_row[k] += d.edges.b[k] * BLOCK_STEP;
  }
  return n_covered;
}
