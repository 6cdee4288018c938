/* How far a point is from a face. */
#ifndef CONIC_DISTANCE_H
#define CONIC_DISTANCE_H

#include "core/base/triangle_distance.h"
#include "lod/mesh/mesh.h"

/* The squared distance of a place from a face of a mesh. */
static inline double conic_distance2_to_face(const conic_mesh *mesh, uint32_t face, const double at[3]) {
  double corners[3][3];
  for (int corner = 0; corner < 3; corner++)
    conic_mesh_corner(mesh, face, corner, corners[corner]);
  return conic_distance2_to_triangle(at, corners[0], corners[1], corners[2]);
}

#endif
