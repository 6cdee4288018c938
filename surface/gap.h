/* The widest gap about a point: a vertex of its Voronoi cell among its neighbours, seen in its tangent plane. */
#ifndef CONIC_GAP_H
#define CONIC_GAP_H

#include "core/estimate/neighbours.h"

typedef struct conic_gap {
  double center[3]; /* in the tangent plane */
  double radius;    /* 0: none */
} conic_gap;

/* The widest gap about a slot's place with a radius over `least` and up to `most`, if it lies among the neighbours: its
 * centre sees no half-plane without one. */
void conic_gap_find(const conic_neighbours *tree, uint32_t slot, const double center[3], const double normal[3],
                    double least, double most, conic_gap *gap);

#endif
