#include "core/estimate/neighbour_loops.h"

static double outside(double low, double high, double at) {
  double below = low - at, above = at - high, most = below > above ? below : above;
  return most > 0.0 ? most : 0.0;
}

/* The least squared distance from the query to a box. Rounding is monotonic, and the sum is formed like that of a
 * point's distance: it is not above the distance of any point in the box, to the last bit. */
static double box_distance2(const conic_near_leaves *leaves, size_t i_leaf, const double query[3]) {
  double sum = 0.0;
  for (int axis = 0; axis < 3; axis++) {
    double d = outside((double)leaves->low[axis][i_leaf], (double)leaves->high[axis][i_leaf], query[axis]);
    sum += d * d;
  }
  return sum;
}

static size_t find(const conic_near_leaves *leaves, const double query[3], double limit2, uint32_t except,
                   uint32_t *slots, double *distances2) {
  size_t n = 0;
  for (size_t i_leaf = 0; i_leaf < leaves->n; i_leaf++) {
    size_t n_here = box_distance2(leaves, i_leaf, query) <= limit2 ? CONIC_LEAF_SLOTS : 0;
    for (size_t i = 0; i < n_here; i++) {
      double d[3];
      for (int axis = 0; axis < 3; axis++)
        d[axis] = (double)leaves->place[axis][i_leaf * CONIC_LEAF_ROOM + i] - query[axis];
      slots[n] = leaves->first[i_leaf] + (uint32_t)i;
      distances2[n] = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
      n += (distances2[n] <= limit2) & (slots[n] != except);
    }
  }
  return n;
}

static void rank(const float *keys, size_t n, uint32_t *places) {
  for (size_t i = 0; i < n; i++) {
    places[i] = 0;
    for (size_t j = 0; j < n; j++)
      places[i] += keys[j] < keys[i];
  }
}

CONIC_DEFINE_LOOPS(conic_neighbour_loops)

void conic_neighbour_loops_scalar(conic_neighbour_loops *loops) {
  *loops = (conic_neighbour_loops){find, rank};
}
