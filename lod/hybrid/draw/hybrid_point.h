/* A node of a hybrid model as a point: one disc that faces the camera and hides the node's sphere. */
#ifndef CONIC_HYBRID_POINT_H
#define CONIC_HYBRID_POINT_H

#include "lod/hybrid/draw/hybrid_offers.h"

/* How many pixels off the node's point may draw its places; infinite where its sphere reaches the near plane, or there
 * is no point. */
double conic_hybrid_point_error_px(const conic_hybrid_camera *view, const conic_hybrid_node *node);

/* What drawing it may take, in nanoseconds of one core. */
double conic_hybrid_point_cost(const conic_hybrid_camera *view, const conic_hybrid_node *node);

/* Its splat: position, t_u, t_v and colour. `cutoff` is where it ends. */
void conic_hybrid_point_splat(const conic_hybrid_camera *view, const conic_hybrid_node *node, double cutoff,
                              float values[12]);

#endif
