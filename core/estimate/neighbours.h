/* Nearest neighbours: a kd-tree over a set's positions, with exact answers.
 *
 * The tree keeps the points in its own order, by *slots*: slots near in space are near in memory, so that work slot by
 * slot stays in the cache. Coincident points are one slot, which stands for the first of them; points that are not
 * finite have none. The order and every answer depend only on the positions and indices. */
#pragma once

#include "core/estimate/neighbour_loops.h"

#define CONIC_NO_SLOT UINT32_MAX

typedef struct conic_neighbours {
  size_t n_points, n_slots;
  size_t n_not_finite, n_duplicates; /* n_points = n_slots + both */
  float *position[3];                /* by slot; behind them is a leaf's room */
  uint32_t *point_of_slot;
  uint32_t *slot_of_point; /* CONIC_NO_SLOT for a point that is not finite */
  size_t n_leaves;         /* a power of two; node i has the children 2i + 1 and 2i + 2, the leaves come last */
  float (*boxes)[6];       /* of each node: least x, y, z, greatest x, y, z */
  conic_neighbour_loops loops;
} conic_neighbours;

/* Builds the tree over positions[axis][0 … count). On success the caller releases *tree; on failure it is empty.
 * Errors: ARGUMENT (over 2³² - 2 points), MEMORY, CANCELLED. */
conic_status conic_neighbours_build(conic_context *context, const float *const positions[3], size_t count,
                                    conic_neighbours *tree);
void conic_neighbours_release(conic_context *context, conic_neighbours *tree);

/* The most neighbours that a query may ask for. */
enum { CONIC_MOST_NEAREST = 64 };

/* The k slots nearest to `query` among those whose squared distance is at most `limit2` (HUGE_VAL: no limit), without
 * the slot `except` (CONIC_NO_SLOT: none), nearest first; equal distances by x, then y, then z. `slots` and
 * `distances2` have room for k. Returns how many there are. Thread-safe. */
size_t conic_neighbours_nearest(const conic_neighbours *tree, const double query[3], uint32_t except, size_t k,
                                double limit2, uint32_t *slots, double *distances2);

/* The leaves around two leaves, side by side, found once for all of their slots; and how far the last slots' neighbours
 * reach. Zero is none. */
enum { CONIC_LAST_KNOWN = 16 };
typedef struct conic_neighbours_around {
  size_t begin, end; /* the two leaves' slots */
  double reach2;     /* leaves no farther from their box than that, squared, are here */
  conic_near_leaves near;
  size_t n_known;
  double known[CONIC_LAST_KNOWN][3],
      reach[CONIC_LAST_KNOWN]; /* of the last slots: place, distance of the k-th neighbour */
} conic_neighbours_around;

/* The k nearest of a slot, itself excepted, as conic_neighbours_nearest finds them. That is quicker where slots follow
 * each other, with the same `around`, which is for one k. */
size_t conic_neighbours_of_slot(const conic_neighbours *tree, size_t slot, size_t k, conic_neighbours_around *around,
                                uint32_t *slots, double *distances2);

/* The squared distance from a query to a slot, with the bits that conic_neighbours_nearest gives. */
static inline double conic_neighbours_distance2(const conic_neighbours *tree, size_t slot, const double query[3]) {
  double x = (double)tree->position[0][slot] - query[0];
  double y = (double)tree->position[1][slot] - query[1];
  double z = (double)tree->position[2][slot] - query[2];
  return x * x + y * y + z * z;
}

/* The first slot of leaf `i_leaf`; the leaf ends where the next one begins. */
static inline size_t conic_neighbours_leaf_begin(const conic_neighbours *tree, size_t i_leaf) {
  return (size_t)((uint64_t)i_leaf * (uint64_t)tree->n_slots / (uint64_t)tree->n_leaves);
}
