/* What each level of each cluster offers to a picture: its error there, and what drawing it takes. */
#pragma once

#include "core/image/viewpoint.h"
#include "lod/hybrid/model/hybrid_model.h"

/* A camera, as clusters are looked at through it. */
typedef struct conic_hybrid_camera {
  conic_viewpoint from; /* places from the model's origin; the sides as far out as the prefilter reaches */
  double focal_px, near_z, n_pixels;
  int cull_back;
  double margin_px2;  /* what the prefilter adds to a splat's squared radius */
  double color_error; /* by how many steps colours may be drawn otherwise than they are; infinite at first */
} conic_hybrid_camera;

void conic_hybrid_camera_init(const conic_hybrid *hybrid, const conic_camera *camera,
                              const conic_render_options *render, conic_hybrid_camera *view);

/* Whether nothing within the sphere is in the picture, or, with cull_back, all normals of the cone face away. */
int conic_hybrid_is_hidden(const conic_hybrid_camera *view, const conic_hybrid_bound *bound, double reach);

/* The most pixels that a displacement by one unit can be, within `reach` of the sphere; infinite where that comes near
 * the camera. */
double conic_hybrid_pixels_a_unit(const conic_hybrid_camera *view, const conic_hybrid_bound *bound, double reach);

/* How many pixels off the level may draw places of a cluster or node with that bound; infinite where its sphere reaches
 * the near plane. */
double conic_hybrid_error_px(const conic_hybrid_camera *view, const conic_hybrid_bound *bound,
                             const conic_hybrid_level *level);

/* The same of a node's level. All places of its triangles are as near as the error to its clusters. So they are looked
 * at in the spheres of its clusters that are in sight, which fit what is drawn more closely than the node's sphere. */
double conic_hybrid_node_error_px(const conic_hybrid *hybrid, const conic_hybrid_camera *view,
                                  const conic_hybrid_node *node, const conic_hybrid_level *level);

/* By how many steps a level of a cluster or node with that bound, or a node's point, may draw colours otherwise than
 * they are. Where what differs is smaller than a pixel, it is the mean over the pixel. */
double conic_hybrid_change(const conic_hybrid_camera *view, const conic_hybrid_bound *bound,
                           const conic_hybrid_level *level);
double conic_hybrid_point_change(const conic_hybrid_camera *view, const conic_hybrid_node *node);

/* Nanoseconds of one core that drawing a level of a cluster may take. */
double conic_hybrid_cost(const conic_hybrid_camera *view, const conic_hybrid_cluster *cluster,
                         const conic_hybrid_level *level);

/* The finest level of that kind, from the cluster's first; below 0: of either. The first of all where there is none. */
uint32_t conic_hybrid_finest(const conic_hybrid *hybrid, const conic_hybrid_cluster *cluster, int only_kind);

/* --- nodes as points --- */

/* How many pixels off the node's point may draw its places; infinite where its sphere reaches the near plane, or there
 * is no point. */
double conic_hybrid_point_error_px(const conic_hybrid_camera *view, const conic_hybrid_node *node);

/* Its splat: position, t_u, t_v and colour. `cutoff` is where it ends. */
void conic_hybrid_point_splat(const conic_hybrid_camera *view, const conic_hybrid_node *node, double cutoff,
                              float values[12]);
