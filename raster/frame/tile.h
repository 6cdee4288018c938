/* One tile: its list of splats, shared out to its rows of blocks, and these drawn one after the other. */
#pragma once

#include "raster/loops/raster_loops.h"

/* What a thread's tiles work in. */
typedef struct conic_tile_scratch {
  conic_tile_entry *entries; /* the tile's, in file order */
  conic_tile_entry *samples; /* room for as many */
  uint32_t *indices, *words; /* of a row of blocks */
  conic_kept *kept;
  conic_nearest *nearest;
  conic_block_sums *sums;
} conic_tile_scratch;

/* What the stages took, in ticks. */
typedef struct conic_stage_ticks {
  uint64_t setup, sort, lists, visibility, accumulate, resolve;
} conic_stage_ticks;

typedef struct conic_tile {
  const conic_view *view;
  const conic_projected *projected;
  size_t n_references;
  int x_begin, x_end, y_begin, y_end; /* its pixels of the picture */
  int first_column, first_row;        /* of the picture, where the image begins */
  int keeps_indices;                  /* the image wants counts or ids */
  int skips_hidden;                   /* fragments need not be counted */
  float *hiding;                      /* not null: no picture is drawn, but this raised (raster/view/part.h) */
  conic_tile_scratch scratch;
  const conic_triangle_frame *triangles; /* null: there are none in it */
  conic_triangle_tile *triangle_tile;    /* what they are drawn in */
  size_t i_tile;
  conic_stage_ticks ticks; /* grow by what its passes take */
} conic_tile;

/* What a tile's passes found. */
typedef struct conic_tile_report {
  uint64_t n_fragments, n_covered, n_triangle_fragments;
} conic_tile_report;

/* The scratch memory that tiles of up to n_references need, one after the other. */
size_t conic_tile_bytes(size_t n_references);

/* Points the tile's scratch into `memory`, of conic_tile_bytes(tile->n_references) at least. */
void conic_tile_place_scratch(conic_tile *tile, void *memory);

/* Draws the tile, whose entries are in its scratch, into the image. */
void conic_tile_draw(conic_tile *tile, const conic_raster_loops *loops, const conic_finish *finish, conic_image *image,
                     conic_tile_report *report);

/* Takes the entries that change no pixel of the tile out of its scratch and its n_references, where so many surfaces
 * may lie behind each other that it is worth while. `band` is the tile's, before its first row. */
void conic_tile_leave_hidden_out(conic_tile *tile, const conic_raster_loops *loops, const conic_band *band);
