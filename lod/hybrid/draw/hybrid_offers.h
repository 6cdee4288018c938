/* What each level of each cluster offers to a picture: its error there, and what drawing it takes. */
#ifndef CONIC_HYBRID_OFFERS_H
#define CONIC_HYBRID_OFFERS_H

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

/* Nanoseconds of one core that a narrow triangle takes, as those that fit clusters to each other are. */
#define CONIC_HYBRID_STITCH_NS 70.0

/* How much more a picture of both kinds takes than its parts, if so many pixels are in tiles that have triangles. */
double conic_hybrid_mixing_ns(const conic_hybrid_camera *view, double n_tile_pixels);

/* About how many pixels are in the tiles that a cluster's faces meet: those of a square of its size, wherever it lies.
 */
double conic_hybrid_tile_pixels(const conic_hybrid_camera *view, const conic_hybrid_cluster *cluster);

/* Nanoseconds of one core that a round splat facing the camera may take. `radius_px2` is its squared radius, without
 * the prefilter. */
double conic_hybrid_disc_cost(const conic_hybrid_camera *view, double radius_px2);

/* A level of a cluster or node, from its first, and what drawing it may take: nanoseconds of one core unless said
 * otherwise. */
typedef struct conic_hybrid_offer {
  uint32_t level;
  double amount;
} conic_hybrid_offer;

/* The level of a node that costs least among those with an error of at most so many pixels. Its point counts as level
 * n_levels. The cost is infinite where there is none, or where all errors are infinite. */
conic_hybrid_offer conic_hybrid_node_offer(const conic_hybrid *hybrid, const conic_hybrid_camera *view,
                                           const conic_hybrid_node *node, double error_px);

/* For each kind, the level that costs least among those with an error of at most so many pixels. The cost is infinite
 * where there is none; triangles always have one. */
void conic_hybrid_offers(const conic_hybrid *hybrid, const conic_hybrid_camera *view,
                         const conic_hybrid_cluster *cluster, double error_px, conic_hybrid_offer offers[2]);

/* The finest level of that kind, from the cluster's first; below 0: of either. The first of all where there is none. */
uint32_t conic_hybrid_finest(const conic_hybrid *hybrid, const conic_hybrid_cluster *cluster, int only_kind);

/* --- nodes as points --- */

/* How many pixels off the node's point may draw its places; infinite where its sphere reaches the near plane, or there
 * is no point. */
double conic_hybrid_point_error_px(const conic_hybrid_camera *view, const conic_hybrid_node *node);

/* What drawing it may take, in nanoseconds of one core. */
double conic_hybrid_point_cost(const conic_hybrid_camera *view, const conic_hybrid_node *node);

/* Its splat: position, t_u, t_v and colour. `cutoff` is where it ends. */
void conic_hybrid_point_splat(const conic_hybrid_camera *view, const conic_hybrid_node *node, double cutoff,
                              float values[12]);

/* --- nodes that stand at once --- */

/* The least that a cluster takes, whatever it is drawn as: to look at it, to copy it, and to draw one primitive. */
#define CONIC_HYBRID_LEAST_NS 250.0

/* Whether a node lies wholly within the picture, is good enough, and takes no more than its clusters would, whatever
 * they were drawn as. Then *offer is what it is drawn as, and *saved_ns grows by the least that it saves. */
int conic_hybrid_stands_at_once(const conic_hybrid *hybrid, const conic_hybrid_camera *view,
                                const conic_hybrid_node *node, double error_px, conic_hybrid_offer *offer,
                                double *saved_ns);

#endif
