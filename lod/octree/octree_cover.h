/* How far a node's disc reaches past a surface of discs. It is looked at in a few places. Those that lie well inside a
 * disc are found first. For the others, it is found how near the discs come. */
#pragma once

#include "core/base/base.h"

/* The points at which a disc is sampled. Every point of the unit disc is within the gap of one of them. */
enum { CONIC_DISC_SAMPLES = 32 };
#define CONIC_DISC_GAP 0.2565
typedef struct conic_disc_samples {
  float x[CONIC_DISC_SAMPLES], y[CONIC_DISC_SAMPLES];
} conic_disc_samples;
void conic_disc_samples_init(conic_disc_samples *samples);

/* What sticks out counts so many times: it shows at the edges of a picture, where a fraction of a pixel is seen. */
#define CONIC_COVER_WEIGHT 3.25f

/* Ellipses in space: centres, the two half axes of their outlines, the halves of the boxes around them, and the error:
 * no point of them is farther from the surface that they stand for. There is a box around each block of them as well.
 * The arrays go on to whole blocks of blocks; conic_discs_close fills the rest. */
enum { CONIC_DISC_BLOCK = 16 };
typedef struct conic_discs {
  float *center[3], *u[3], *v[3], *half[3], *error;
  float *block_center[3], *block_half[3];
  size_t count;
} conic_discs;

/* Finds the boxes of the discs from `first` on. All else of them must be there. */
void conic_discs_set_half(conic_discs *discs, size_t first);

/* Once all discs are there: finds the blocks' boxes. */
void conic_discs_close(conic_discs *discs);

/* Some of the blocks, with their boxes. There is room for all, in whole blocks of blocks. */
typedef struct conic_block_list {
  float *center[3], *half[3];
  uint32_t *block;
  size_t count;
} conic_block_list;

/* The blocks that a few nodes close together nearly always need to look at, and room to work with one node. Beside the
 * blocks of the nodes' own discs, no more than MOST_NEAR_BLOCKS are looked at; otherwise all would be near all where
 * discs lie on one another. What is left out makes errors larger than they are, which breaks no promise. */
enum { CONIC_FLAT_NUMBERS = 12, CONIC_MOST_NEAR_BLOCKS = 512 };
typedef struct conic_near_discs {
  float center[3], half[3]; /* a box: whatever reaches into it is in these blocks */
  size_t begin, end;        /* the nodes' own discs */
  int is_full;              /* some that reach into the box are left out, and nothing outside is looked at */
  conic_block_list blocks;
  float (*flat)[CONIC_FLAT_NUMBERS][CONIC_DISC_BLOCK]; /* the blocks as the node that is looked at sees them */
  uint16_t *are_flat;                                  /* a bit for each of them that is there */
} conic_near_discs;

/* Whether the list has room for one more block that reaches into the box. */
static inline int conic_near_has_room(const conic_near_discs *near) {
  size_t n_own = (near->end + CONIC_DISC_BLOCK - 1) / CONIC_DISC_BLOCK - near->begin / CONIC_DISC_BLOCK;
  return near->blocks.count < n_own + CONIC_MOST_NEAR_BLOCKS;
}

/* Lists the blocks that reach into the box, in order. Where these are too many, the list begins with the block of
 * blocks that has near->begin. */
typedef void conic_find_near_function(const conic_discs *discs, conic_near_discs *near);

/* The disc of a node. */
typedef struct conic_node_disc {
  float center[3], u[3], v[3]; /* as those of discs */
  float n[3];                  /* unit */
  float enough;                /* no smaller error matters */
} conic_node_disc;

/* The error of a node's disc, `enough` at least. No point of the disc is farther from the discs, and no sample farther
 * than a CONIC_COVER_WEIGHT-th of it. The discs begin … end, one at least, are its own leaves', and are looked at
 * first. */
typedef float conic_cover_function(const conic_disc_samples *samples, const conic_discs *discs, size_t begin,
                                   size_t end, conic_near_discs *near, const conic_node_disc *node);
