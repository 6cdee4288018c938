/* How far a point is from a triangle. */
#ifndef CONIC_DISTANCE_H
#define CONIC_DISTANCE_H

#include "lod/mesh/mesh.h"

/* The squared distance of p from the triangle a, b, c, its border included. */
double conic_distance2_to_triangle(const double p[3], const double a[3], const double b[3], const double c[3]);

/* Of a face of a mesh. */
static inline double conic_distance2_to_face(const conic_mesh *mesh, uint32_t face, const double at[3]) {
  double corners[3][3];
  for (int corner = 0; corner < 3; corner++)
    conic_mesh_corner(mesh, face, corner, corners[corner]);
  return conic_distance2_to_triangle(at, corners[0], corners[1], corners[2]);
}

#endif
