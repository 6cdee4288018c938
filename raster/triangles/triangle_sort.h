/* A chunk of triangles on its way to the tiles. */
#ifndef CONIC_TRIANGLE_SORT_H
#define CONIC_TRIANGLE_SORT_H

#include "raster/triangles/triangle_frame.h"

/* The most pieces that a triangle is clipped into. */
enum { CONIC_TRIANGLE_PIECES_MOST = CONIC_CLIPPED_CORNERS - 2 };

/* What a thread sets a chunk up in. */
typedef struct conic_triangle_sorter {
  conic_triangle_record *records;
  conic_triangle_piece *pieces;
  uint32_t *next; /* [n_tiles]: where its next entry goes */
  size_t n_records, n_pieces;
} conic_triangle_sorter;

/* Sets up the triangles begin … end - 1; the chunk gets their counts. */
void conic_triangle_set_up(const conic_triangle_frame *frame, size_t begin, size_t end, conic_triangle_sorter *sorter,
                           conic_triangle_chunk *chunk);

#endif
