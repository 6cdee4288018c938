/* A node of a hybrid model as a point: one disc that faces the camera and hides the node's sphere. */
#include "lod/hybrid/draw/hybrid_offers.h"

#include <math.h>

#include "core/base/vectors.h"
#include "core/splats/ellipse.h"

/* The way from the eye to the centre, and the radius of the disc there that hides the sphere: where the rays that touch
 * the sphere pass. Returns infinity where the eye is in the sphere. */
static double radius_of_disc(const conic_hybrid_camera *view, const conic_hybrid_node *node, double way[3],
                             double *distance) {
  double radius = (double)node->point.radius;
  for (int axis = 0; axis < 3; axis++)
    way[axis] = (double)node->bound.center[axis] - view->from.eye[axis];
  *distance = conic_length(way);
  return *distance > radius ? radius * *distance / sqrt(*distance * *distance - radius * radius) : HUGE_VAL;
}

double conic_hybrid_point_error_px(const conic_hybrid_camera *view, const conic_hybrid_node *node) {
  double way[3], distance, disc = radius_of_disc(view, node, way, &distance);
  if (!(node->point.radius > 0.0f) || !(disc < HUGE_VAL))
    return HUGE_VAL;
  /* the disc reaches out of the sphere by what it is larger */
  double out = disc - (double)node->point.radius;
  return ((double)node->point.error + out) * conic_hybrid_pixels_a_unit(view, &node->bound, out);
}

double conic_hybrid_point_cost(const conic_hybrid_camera *view, const conic_hybrid_node *node) {
  double way[3], distance, disc = radius_of_disc(view, node, way, &distance);
  double side = view->focal_px * disc / distance;
  return conic_hybrid_disc_cost(view, side * side);
}

void conic_hybrid_point_splat(const conic_hybrid_camera *view, const conic_hybrid_node *node, double cutoff,
                              float values[12]) {
  double way[3], distance, u[3], v[3], sigma = radius_of_disc(view, node, way, &distance) / cutoff;
  for (int axis = 0; axis < 3; axis++)
    way[axis] /= -distance;
  conic_tangent_basis(way, u, v);
  for (int axis = 0; axis < 3; axis++) {
    values[axis] = node->bound.center[axis];
    values[3 + axis] = (float)(sigma * u[axis]);
    values[6 + axis] = (float)(sigma * v[axis]);
    values[9 + axis] = node->point.color[axis];
  }
}
