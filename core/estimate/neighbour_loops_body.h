/* The loops of core/estimate/neighbour_loops_scalar.c in lanes: none branches on what it compares, which cannot be
 * foreseen. */
#include "core/estimate/neighbour_loops.h"
#include "core/lanes/lanes_double.h"

#if CONIC_WIDE_LANES > 2 /* two by two, it takes twice as long as plain C */

CONIC_INLINE wide_ints count_up(void) {
  wide_ints ascending = {0};
  for (int lane = 0; lane < CONIC_WIDE_LANES; lane++)
    ascending[lane] = lane;
  return ascending;
}

/* The leaves whose boxes are near enough. */
CONIC_INLINE size_t find_leaves(const conic_near_leaves *leaves, const double query[3], double limit2,
                                uint32_t *found) {
  size_t n = 0;
  for (size_t i = 0; i < leaves->n; i += CONIC_WIDE_LANES) {
    wide sum = {0};
    for (int axis = 0; axis < 3; axis++) {
      wide below = wide_load_floats(leaves->low[axis] + i) - query[axis];
      wide above = query[axis] - wide_load_floats(leaves->high[axis] + i);
      wide outside = wide_max(wide_max(below, above), wide_of(0.0));
      sum += outside * outside;
    }
    unsigned bits = wide_bits(sum <= limit2);
    wide_append_ints(found + n, bits, count_up() + (int32_t)i);
    n += (size_t)__builtin_popcount(bits);
  }
  return n;
}

static size_t find(const conic_near_leaves *leaves, const double query[3], double limit2, uint32_t except,
                   uint32_t *slots, double *distances2) {
  uint32_t near[CONIC_NEAR_LEAVES_ROOM];
  size_t n = 0, n_near = find_leaves(leaves, query, limit2, near);
  for (size_t k = 0; k < n_near; k++)
    for (size_t i = 0; i < CONIC_LEAF_SLOTS; i += CONIC_WIDE_LANES) {
      const float *place = leaves->place[0] + near[k] * (size_t)CONIC_LEAF_ROOM + i;
      const size_t next = CONIC_MOST_NEAR_LEAVES * CONIC_LEAF_ROOM;
      wide x = wide_load_floats(place) - query[0], y = wide_load_floats(place + next) - query[1];
      wide z = wide_load_floats(place + 2 * next) - query[2], distance2 = x * x + y * y + z * z;
      wide_ints own = count_up() + (int32_t)(leaves->first[near[k]] + (uint32_t)i);
      wide_mask is_other = __builtin_convertvector(own != (int32_t)except, wide_mask);
      unsigned bits = wide_bits((distance2 <= limit2) & is_other);
      wide_append(distances2 + n, bits, distance2);
      wide_append_ints(slots + n, bits, own);
      n += (size_t)__builtin_popcount(bits);
    }
  return n;
}

#endif

/* Compares each with each: for so few, that is quicker than sorting with its unpredictable comparisons. */
static void rank(const float *keys, size_t n, uint32_t *places) {
  enum { PARTS = 4 };
  for (size_t begin = 0; begin < n; begin += (size_t)PARTS * CONIC_LANES) {
    lanes own[PARTS];
    index_lanes exceeded[PARTS];
    for (int part = 0; part < PARTS; part++) {
      own[part] = lanes_load(keys + begin + part * CONIC_LANES);
      exceeded[part] = lanes_of_index(0);
    }
    for (size_t j = 0; j < n; j++) {
      lanes key = lanes_of(keys[j]);
      for (int part = 0; part < PARTS; part++)
        exceeded[part] = lanes_increment(lanes_less(key, own[part]), exceeded[part]);
    }
    for (int part = 0; part < PARTS; part++)
      lanes_store_indices(places + begin + part * CONIC_LANES, exceeded[part]);
  }
}

CONIC_FILL_LOOPS(conic_neighbour_loops) {
#if CONIC_WIDE_LANES > 2
  loops->find = find;
#endif
  loops->rank = rank;
}
