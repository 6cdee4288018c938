/* A frame's triangles: projected, clipped, and shared out to tiles. */
#ifndef CONIC_TRIANGLE_FRAME_H
#define CONIC_TRIANGLE_FRAME_H

#include <stdatomic.h>

#include "conic/triangles.h"
#include "core/base/kept_memory.h"
#include "raster/tiles/band.h"
#include "raster/triangles/triangle_samples.h"

struct conic_triangle_loops;

enum {
  CONIC_TRIANGLE_VERTICES,
  CONIC_TRIANGLE_CHUNKS,
  CONIC_TRIANGLE_TABLES,
  CONIC_TRIANGLE_RECORDS,
  CONIC_TRIANGLE_PIECES,
  CONIC_TRIANGLE_ENTRIES,
  CONIC_TRIANGLE_SORTERS,
  CONIC_TRIANGLE_TILES,
  CONIC_TRIANGLE_N_MEMORIES
};

/* Consecutive triangles of the set, and what became of them. */
typedef struct conic_triangle_chunk {
  size_t first_record, first_piece, first_entry;
  size_t n_culled, n_skipped, n_drawn; /* triangles */
} conic_triangle_chunk;

/* What the triangles are to the pixels of a row of blocks, as bits by the order of a block's pixels. */
typedef struct conic_triangle_row {
  const conic_triangle_block *blocks;   /* one for each of the row's; */
  uint32_t covered[CONIC_BAND_BLOCKS];  /* there is a triangle, */
  uint32_t visible[CONIC_BAND_BLOCKS];  /* it is seen, */
  uint32_t heaviest[CONIC_BAND_BLOCKS]; /* it weighs most, */
  uint32_t nearest[CONIC_BAND_BLOCKS];  /* it is the nearest of what is seen */
} conic_triangle_row;

/* What a thread draws a tile's triangles in. */
typedef struct conic_triangle_tile {
  conic_triangle_block blocks[CONIC_BAND_BLOCKS][CONIC_BAND_BLOCKS]; /* row by row */
  uint32_t covered[CONIC_BAND_BLOCKS][CONIC_BAND_BLOCKS];
  conic_triangle_row row;
  uint64_t n_fragments;
  int is_empty;
} conic_triangle_tile;

struct conic_triangle_frame {
  /* What is drawn. */
  conic_context *context;
  const conic_triangles *triangles;
  const conic_view *view;
  double translation[3]; /* of positions that are relative to the triangles' origin */
  uint32_t first_id;     /* of the first triangle, in the plane `id` */
  float epsilon;         /* how far behind a triangle splats are seen, along the ray, in world units */
  int tile, tile_bits, n_tiles_x;
  size_t n_tiles;
  /* What came of it. */
  conic_screen_vertex *vertices;
  size_t n_chunks, chunk_size;
  conic_triangle_chunk *chunks;
  uint32_t *tile_begin; /* [chunk][n_tiles + 1]: where a tile's entries begin among the chunk's */
  conic_triangle_record *records;
  conic_triangle_piece *pieces;
  uint32_t *entries; /* records, counted from the chunk's first */
  size_t n_record_room, n_piece_room, n_entry_room;
  atomic_size_t n_records, n_pieces, n_entries; /* used, or needed where there is no room */
  atomic_int is_uncountable;                    /* a chunk has more entries than 32 bits count */
  char *sorters;
  size_t sorter_bytes;
  conic_triangle_tile *tiles; /* a thread */
  conic_kept_memory memory[CONIC_TRIANGLE_N_MEMORIES];
};

typedef struct conic_triangle_frame conic_triangle_frame;

static inline const conic_texture *conic_material_texture(const conic_material *material) {
  return material->texture;
}

/* Sets what is drawn; `memory` must be of zero bytes or from the frame before. */
void conic_triangle_frame_begin(conic_triangle_frame *frame, conic_context *context, const conic_triangles *triangles,
                                const conic_view *view, const conic_camera *camera);

/* Sets the edge of the view's tiles. */
void conic_triangle_frame_tiles(conic_triangle_frame *frame, int tile);

/* Projects, clips and sorts the frame's triangles. Errors: MEMORY. */
conic_status conic_triangle_frame_prepare(conic_triangle_frame *frame, const struct conic_triangle_loops *loops);

void conic_triangle_frame_release(conic_context *context, conic_triangle_frame *frame);

/* Adds what became of the triangles, fragments aside. */
void conic_triangle_frame_count(const conic_triangle_frame *frame, conic_render_statistics *statistics);

/* `vertices` in plain C. */
void conic_triangle_vertices(const conic_triangle_frame *frame, size_t begin, size_t end,
                             conic_screen_vertex *vertices);

/* A polygon's corner while it is clipped: its place in camera space, and in its triangle. */
typedef struct conic_clip_corner {
  double p[3];
  double at[2];
} conic_clip_corner;

enum { CONIC_CLIPPED_CORNERS = 8 };

/* Clips triangle i of the frame against near and the guard band: 0, or 3 to 8 corners. */
int conic_triangle_clip(const conic_triangle_frame *frame, size_t i, conic_clip_corner corners[CONIC_CLIPPED_CORNERS]);

/* The place of a vertex in camera space; and of a point there on the screen. */
void conic_triangle_to_camera(const conic_triangle_frame *frame, uint32_t vertex, double p[3]);
conic_screen_vertex conic_triangle_place(const conic_triangle_frame *frame, const double p[3]);

/* Whether the box of a triangle meets the tile: else there is nothing to draw in it, nor to look for. */
int conic_triangle_frame_meets(const conic_triangle_frame *frame, size_t i_tile);

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
