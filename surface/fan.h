/* A point's fan: the triangles that it makes with pairs of its neighbours, seen in its tangent plane. */
#pragma once

#include "core/estimate/neighbours.h"

enum { CONIC_FAN_TRIANGLES = 12 };

typedef struct conic_fan {
  int n;
  uint32_t pairs[CONIC_FAN_TRIANGLES][2]; /* slots, counter-clockwise seen from the normal's side */
} conic_fan;

/* The triangles about a slot whose circle has no other neighbour in it (Delaunay's) and a radius of at most `most`; the
 * first CONIC_FAN_TRIANGLES of them. `normals`, the unit normals by slot, may be null; neighbours that face the other
 * way belong to another sheet. */
void conic_fan_find(const conic_neighbours *tree, float *const normals[3], uint32_t slot, const double normal[3],
                    double most, conic_fan *fan);
