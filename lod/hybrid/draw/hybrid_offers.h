/* What each level of each cluster offers to a picture: its error there, and what drawing it takes. */
#ifndef CONIC_HYBRID_OFFERS_H
#define CONIC_HYBRID_OFFERS_H

#include "core/image/viewpoint.h"
#include "lod/hybrid/model/hybrid_model.h"

/* A camera as the clusters are looked at by. */
typedef struct conic_hybrid_camera {
  conic_viewpoint from; /* places from the model's origin; the sides as far out as the prefilter reaches */
  double focal_px, near_z, n_pixels;
  int cull_back;
  double margin_px2;  /* what the prefilter adds to a splat's squared radius */
  double color_error; /* by how many steps colours may be drawn otherwise than they are; infinite at first */
} conic_hybrid_camera;

void conic_hybrid_camera_init(const conic_hybrid *hybrid, const conic_camera *camera,
                              const conic_render_options *render, conic_hybrid_camera *view);

/* Whether nothing within the sphere is in the picture, or with cull_back all that the cone holds faces away. */
int conic_hybrid_is_hidden(const conic_hybrid_camera *view, const conic_hybrid_bound *bound, double reach);

/* The most pixels that a displacement of one can be within `reach` of the sphere: infinite where that is near. */
double conic_hybrid_pixels_a_unit(const conic_hybrid_camera *view, const conic_hybrid_bound *bound, double reach);

/* How many pixels places of a cluster or node with that bound may be off where the level draws it: infinite where its
 * sphere reaches near. */
double conic_hybrid_error_px(const conic_hybrid_camera *view, const conic_hybrid_bound *bound,
                             const conic_hybrid_level *level);

/* The same of a node's level. Its triangles, of which all places are that near to those of the node's clusters, are
 * looked at in the spheres of those that are in sight, which are nearer to what is drawn than the node's. */
double conic_hybrid_node_error_px(const conic_hybrid *hybrid, const conic_hybrid_camera *view,
                                  const conic_hybrid_node *node, const conic_hybrid_level *level);

/* By how many steps colours may be drawn otherwise than they are, by a level of a cluster or node with that bound, or
 * by a node's point: each the mean of a pixel where what differs is smaller. */
double conic_hybrid_change(const conic_hybrid_camera *view, const conic_hybrid_bound *bound,
                           const conic_hybrid_level *level);
double conic_hybrid_point_change(const conic_hybrid_camera *view, const conic_hybrid_node *node);

/* What one of the narrow triangles takes that fit clusters to each other, in nanoseconds of one core. */
#define CONIC_HYBRID_STITCH_NS 70.0

/* What a picture of both kinds takes more than its parts, if so many pixels are in tiles that have triangles. */
double conic_hybrid_mixing_ns(const conic_hybrid_camera *view, double n_tile_pixels);

/* How many pixels the tiles have, about, that a cluster's faces meet: of a square of its size, wherever it lies. */
double conic_hybrid_tile_pixels(const conic_hybrid_camera *view, const conic_hybrid_cluster *cluster);

/* What a round splat may take that faces the camera, in nanoseconds of one core; `radius_px2` is its squared radius,
 * without the prefilter. */
double conic_hybrid_disc_cost(const conic_hybrid_camera *view, double radius_px2);

/* A level of a cluster or node, from its first, and what drawing it may take: nanoseconds of one core where nothing
 * else is said. */
typedef struct conic_hybrid_offer {
  uint32_t level;
  double amount;
} conic_hybrid_offer;

/* Of a node the level that costs least among those whose error is at most so many pixels, its point, n_levels, being
 * one; of infinite cost where there is none, or all of infinite error. */
conic_hybrid_offer conic_hybrid_node_offer(const conic_hybrid *hybrid, const conic_hybrid_camera *view,
                                           const conic_hybrid_node *node, double error_px);

/* Of each kind the level that costs least among those whose error is at most so many pixels; of infinite cost where
 * there is none, which is never so for triangles. */
void conic_hybrid_offers(const conic_hybrid *hybrid, const conic_hybrid_camera *view,
                         const conic_hybrid_cluster *cluster, double error_px, conic_hybrid_offer offers[2]);

/* The finest level of that kind, or of any below 0, from the cluster's first; the first of all where there is none. */
uint32_t conic_hybrid_finest(const conic_hybrid *hybrid, const conic_hybrid_cluster *cluster, int only_kind);

#endif
