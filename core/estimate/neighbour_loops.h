/* The loops that take most of the time of a search for neighbours: a few leaves at once, and what they hold. */
#pragma once

#include "core/base/base.h"
#include "core/lanes/instruction_sets.h"

/* The most slots of a leaf, and the room of one. */
#define CONIC_LEAF_SLOTS 12
#define CONIC_LEAF_ROOM 16

/* Leaves in arrays. Behind them are as many boxes as a register has lanes; a place without a slot is NaN, which is near
 * nothing. */
enum { CONIC_MOST_NEAR_LEAVES = 128, CONIC_NEAR_LEAVES_ROOM = CONIC_MOST_NEAR_LEAVES + 8 };
typedef struct conic_near_leaves {
  size_t n;
  uint32_t first[CONIC_NEAR_LEAVES_ROOM]; /* slot of each */
  float low[3][CONIC_NEAR_LEAVES_ROOM], high[3][CONIC_NEAR_LEAVES_ROOM];
  float place[3][CONIC_MOST_NEAR_LEAVES * CONIC_LEAF_ROOM];
} conic_near_leaves;

/* The room for what is found, and for keys: the lists are written by whole registers. */
enum { CONIC_FOUND_ROOM = CONIC_MOST_NEAR_LEAVES * CONIC_LEAF_ROOM + 16, CONIC_KEYS_AT_ONCE = 64 };

typedef struct conic_neighbour_loops {
  /* Lists the slots whose squared distance from the query is at most limit2, without `except`, leaf by leaf, with these
   * distances, which are those of conic_neighbours_distance2. Returns how many. */
  size_t (*find)(const conic_near_leaves *leaves, const double query[3], double limit2, uint32_t except,
                 uint32_t *slots, double *distances2);
  /* How many of n keys each exceeds. Both arrays have room for CONIC_KEYS_AT_ONCE more. */
  void (*rank)(const float *keys, size_t n, uint32_t *places);
} conic_neighbour_loops;

CONIC_DECLARE_LOOPS(conic_neighbour_loops);
