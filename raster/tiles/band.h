/* One row of a tile's blocks of 4 × 4 pixels, the unit of the passes. What they hand to each other stays in the nearest
 * caches: visibility goes splat by splat and keeps its fragments, block by block; accumulation then takes a block's
 * fragments one after the other, with the sums in registers. */
#pragma once

#include <string.h>

#include "conic/image.h"
#include "raster/project/projected.h"

/* The final weight of a visible splat is never below this, so that no sum is zero and no product denormal. */
#define CONIC_LEAST_WEIGHT 0x1p-60f

/* Pixels of a block, column by column: pixel l is column l / 4, row l % 4. Blocks lie at multiples of 4 of the image,
 * as boxes are rounded to; tiles are multiples of 4, so that no tile size moves a block. */
#define CONIC_BLOCK_EDGE 4
#define CONIC_BLOCK_PIXELS 16

/* The greatest edge of a tile, and how many blocks that is. */
#define CONIC_GREATEST_TILE 64
#define CONIC_BAND_BLOCKS 16

/* A place beside them, that loops may write to where a splat has no further block. */
#define CONIC_NO_BLOCK CONIC_BAND_BLOCKS

/* A footprint in a tile, and which of its blocks it meets. */
typedef struct conic_tile_entry {
  uint32_t footprint;
  uint32_t word;
} conic_tile_entry;

/* A word: which blocks of a tile a box meets: from the first to the last column (bits 0 … 7, 8 … 15), and of the rows r
 * those of bits 16 + r. Never 0. */
static inline uint32_t conic_word_of(uint32_t first, uint32_t last, uint32_t first_row, uint32_t last_row) {
  return first | last << 8 | ((UINT32_C(2) << last_row) - (UINT32_C(1) << first_row)) << 16;
}

static inline uint32_t conic_word_first(uint32_t word) {
  return word & 0xff;
}

static inline uint32_t conic_word_last(uint32_t word) {
  return word >> 8 & 0xff;
}

static inline int conic_word_has(uint32_t word, uint32_t column) {
  return column >= conic_word_first(word) && column <= conic_word_last(word);
}

/* Where the nearest splat wins alone, words have pixels in place of blocks: the first and the last column (bits 0 … 7,
 * 8 … 15) and row (16 … 23, 24 … 31) of a tile's. */
static inline uint32_t conic_pixel_word_of(uint32_t first, uint32_t last, uint32_t first_row, uint32_t last_row) {
  return first | last << 8 | first_row << 16 | last_row << 24;
}

static inline uint32_t conic_word_first_row(uint32_t word) {
  return word >> 16 & 0xff;
}

static inline uint32_t conic_word_last_row(uint32_t word) {
  return word >> 24;
}

/* Records are fetched for so many splats before they are read. */
#define CONIC_FETCHED_AHEAD 32

/* The fragments of so many splats are kept for a block; those of further ones are evaluated again. */
#define CONIC_KEPT_SPLATS 512

typedef struct conic_kept_fragments {
  float q[CONIC_BLOCK_PIXELS];       /* with a profile, of what is seen: the fragment's scale in its place */
  float seen_iz[CONIC_BLOCK_PIXELS]; /* max of the splat's and its plane's; -1 where not covered */
} conic_kept_fragments;

/* What visibility found in a block, and blending reads: whole cache lines. The last places are for what is not kept. */
typedef struct conic_kept {
  _Alignas(64) float threshold[CONIC_BLOCK_PIXELS]; /* max of what covers it hides by, at least 0 */
  uint32_t footprint[CONIC_KEPT_SPLATS + 16];
  conic_kept_fragments fragments[CONIC_KEPT_SPLATS + 1];
  float scale[CONIC_KEPT_SPLATS + 1]
             [CONIC_BLOCK_PIXELS]; /* without a profile, of special ones: all but ellipses without clip lines */
} conic_kept;

/* The sums over a block's visible splats, 0 where there is none. Splats are named by their footprint. */
typedef struct conic_block_sums {
  float weight[CONIC_BLOCK_PIXELS];
  float color[3][CONIC_BLOCK_PIXELS], normal[3][CONIC_BLOCK_PIXELS];
  uint32_t heaviest[CONIC_BLOCK_PIXELS]; /* whose weight is the largest, the first of equals */
  uint32_t nearest[CONIC_BLOCK_PIXELS];  /* whose iz is the largest; only where the frame keeps indices */
  uint32_t count[CONIC_BLOCK_PIXELS];    /* how many; likewise */
} conic_block_sums;

/* Where the nearest splat wins: its fragments of a tile, in strips of two or four rows of pixels, each column by
 * column, so that a few columns from any one on lie together: most splats are a handful of pixels wide. iz is 0 where
 * there is none, and scale is meant of special ones only. A strip's last columns and the last strip are beside the
 * tile, and stay as they are. */
#define CONIC_STRIP_COLUMNS (CONIC_GREATEST_TILE + 8)
#define CONIC_GREATEST_STRIP 4
#define CONIC_NEAREST_PIXELS ((CONIC_GREATEST_TILE + CONIC_GREATEST_STRIP) * CONIC_STRIP_COLUMNS)

typedef struct conic_nearest {
  _Alignas(64) float iz[CONIC_NEAREST_PIXELS];
  float q[CONIC_NEAREST_PIXELS];
  uint32_t footprint[CONIC_NEAREST_PIXELS];
  float scale[CONIC_NEAREST_PIXELS];
} conic_nearest;

/* The directions of a tile's columns and rows of pixels: d = (x, y, 1). */
typedef struct conic_tile_rays {
  int x_begin, y_begin; /* the tile's first pixel */
  float x[CONIC_GREATEST_TILE], y[CONIC_GREATEST_TILE];
  float block_x[CONIC_BAND_BLOCKS + 1][CONIC_BLOCK_PIXELS]; /* the same for each column of blocks, 0 beside them … */
  float block_y[CONIC_BAND_BLOCKS][CONIC_BLOCK_PIXELS]; /* … and each row of them, in the order of a block's pixels */
} conic_tile_rays;

struct conic_triangle_frame;
struct conic_triangle_row;

typedef struct conic_band {
  const conic_view *view;
  const conic_projected *projected;
  const uint32_t *indices, *words; /* footprints whose boxes meet the band, in file order */
  size_t n, n_listed;              /* those of the next band follow, up to n_listed */
  int x, y, n_blocks;              /* its first pixel in the picture */
  int first_column, first_row;     /* of the picture, where the image begins */
  const conic_tile_rays *rays;     /* its tile's */
  int keeps_indices;               /* the image wants counts or ids */
  int has_special;                 /* visibility has met rays or clip lines */
  uint64_t n_fragments, n_covered; /* found by visibility and by resolving, all bands before included */
  /* For each block: */
  size_t n_kept[CONIC_BAND_BLOCKS];   /* so many splats are in `kept`; */
  size_t not_kept[CONIC_BAND_BLOCKS]; /* the first of the band's that covers a pixel and is not, or n */
  conic_kept *kept;                   /* CONIC_BAND_BLOCKS + 1 */
  /* The tile from this band on, where the nearest splat wins alone: its entries, whose words name pixels, and the
   * fragments. */
  const conic_tile_entry *entries;
  size_t n_entries;
  int n_rows, strip_rows;
  conic_nearest *nearest;
  int nearest_row; /* the band's first row in it */
  conic_block_sums *sums;
  /* Where triangles meet the band, else null: the frame's, and what they are to the band's pixels. */
  const struct conic_triangle_frame *triangle_frame;
  struct conic_triangle_row *triangles;
} conic_band;

/* The directions of the rows of the band's blocks. */
static inline const float *conic_band_ray_y(const conic_band *band) {
  return band->rays->block_y[(band->y - band->rays->y_begin) / CONIC_BLOCK_EDGE];
}

/* Where a strip of so many rows keeps the pixel in the given column and row of the tile. */
static inline size_t conic_strip_place(int strip_rows, int column, int row) {
  int place = row / strip_rows * strip_rows * CONIC_STRIP_COLUMNS + column * strip_rows + row % strip_rows;
  return (size_t)place;
}

/* Where `nearest` has pixel l of a block of the band. */
static inline size_t conic_nearest_place(const conic_band *band, int block, int l) {
  return conic_strip_place(band->strip_rows, block * CONIC_BLOCK_EDGE + l / CONIC_BLOCK_EDGE,
                           band->nearest_row + l % CONIC_BLOCK_EDGE);
}

/* Empties the tile. What is kept in the strip beside it is written to, so that its pages are there: stores that mask
 * everything out are slow where they are not. */
static inline void conic_nearest_begin(const conic_band *band) {
  conic_nearest *kept = band->nearest;
  size_t n = (size_t)band->n_rows * CONIC_BLOCK_EDGE * CONIC_STRIP_COLUMNS;
  size_t beside = (size_t)band->strip_rows * CONIC_STRIP_COLUMNS;
  memset(kept->iz, 0, (n + beside) * sizeof *kept->iz);
  memset(kept->q + n, 0, beside * sizeof *kept->q);
  memset(kept->footprint + n, 0, beside * sizeof *kept->footprint);
}

/* Nothing covers the block. */
static inline int conic_block_is_empty(const conic_band *band, int block) {
  return band->n_kept[block] == 0 && band->not_kept[block] == band->n;
}
