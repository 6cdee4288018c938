/* Which splats may touch which tile: a stable counting sort, so that every tile's list is in file order. */
#ifndef RASTER_BINS_H
#define RASTER_BINS_H

#include "raster/projected.h"

/* A footprint in a tile. */
typedef struct conic_tile_entry {
  uint32_t footprint;
  uint32_t word; /* bit c: its box meets column c of the tile's blocks of 4 × 4 pixels, bit 16 + r: row r */
} conic_tile_entry;

typedef struct conic_bins {
  int tile;      /* edge in pixels */
  int tile_bits; /* its binary logarithm */
  int n_tiles_x, n_tiles_y;
  size_t n_tiles;
  uint32_t *counts;   /* [chunk][tile]: first how many, then where the chunk's next entry goes */
  size_t *tile_begin; /* [n_tiles + 1]: a tile's entries are references[tile_begin[t] … tile_begin[t + 1]) */
  conic_tile_entry *references;
} conic_bins;

/* Counts the tiles of the chunk's footprints. */
void conic_bins_count(conic_bins *bins, const conic_projected *projected, size_t i_chunk);

/* Turns counts into places; returns how many references there are in all. */
size_t conic_bins_place(conic_bins *bins, const conic_projected *projected);

/* Writes the references of the chunk's footprints. */
void conic_bins_fill(conic_bins *bins, const conic_projected *projected, size_t i_chunk);

#endif
