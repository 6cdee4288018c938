/* What stands for many: the position, ellipse, colour and bounds of every inner node. */
#pragma once

#include "core/splats/ellipse.h"
#include "lod/octree/octree_nodes.h"

/* Fills in the codes of all nodes. Their structure and leaves must be there. Errors: MEMORY, CANCELLED. */
conic_status conic_octree_fit(conic_octree *octree);

/* How far a range of leaves reaches in a frame. A node's bounds are made of it. */
typedef struct conic_leaf_reach {
  double reach;  /* the major half axis of an ellipse of the frame's directions and ratio that holds their outlines;
                    the least is smaller by 2 % at most */
  double radius; /* of the sphere that holds their outlines */
  double height; /* how far from the plane their outlines go */
  double cosine; /* the least of their normals to the frame's */
} conic_leaf_reach;

/* Widens *reach by the leaves begin … end. */
typedef void conic_add_reach_function(const conic_splats *leaves, size_t begin, size_t end, double cutoff,
                                      const conic_node_frame *frame, conic_leaf_reach *reach);

/* The ratio whose ellipse around the outlines of a few leaves is the smallest. Ratios near the shape's are tried; the
 * shape has its major direction in u, v. */
enum { CONIC_FEW_LEAVES = 16 }; /* the more there are, the better the covariance's fits */
typedef double conic_choose_ratio_function(const conic_splats *leaves, size_t begin, size_t end, double cutoff,
                                           const double place[3], const double u[3], const double v[3],
                                           const conic_ellipse *shape, double least_ratio);

/* Raises errors to how far a node's disc reaches past the surface. Those that conic_octree_fit has left tell only of
 * the leaves' heights and the node's size. Errors: MEMORY, CANCELLED. */
conic_status conic_octree_find_errors(conic_octree *octree);

/* --- moments --- */

/* The homogeneous matrix Σ p'p'ᵀ holds the count, Σ p and Σ ppᵀ. It is kept translated to the set's own mean, as Eq. 3
 * allows at any time; about a distant origin, the covariance would cancel in Σ ppᵀ. A splat adds its own extent,
 * t_u t_uᵀ + t_v t_vᵀ, so that one splat and splats in a row have a shape too. */
typedef struct conic_moments {
  double count;
  double mean[3];
  double scatter[6]; /* Σ (p - mean)(p - mean)ᵀ + t_u t_uᵀ + t_v t_vᵀ: xx xy xz yy yz zz */
  double area;       /* Σ |t_u × t_v| */
  double normal[3];  /* Σ t_u × t_v */
  double weight;     /* Σ opacity·|t_u × t_v|: what a splat's kernel integrates to, up to a constant */
  double color[3];   /* Σ opacity·|t_u × t_v|·colour */
} conic_moments;

/* The sums of splat i alone, relative to the set's origin. */
void conic_moments_of_splat(const conic_splats *splats, size_t i, conic_moments *moments);

/* Adds the sums of another set; `sum` may be all zero. */
void conic_moments_merge(conic_moments *sum, const conic_moments *more);

/* The mean normal, weighed by area, of any length; where normals cancel, the direction in which the points spread
 * least. */
void conic_moments_facing(const conic_moments *moments, double normal[3]);

/* Ellipses may be narrower than a splat that is estimated (core/estimate/estimate.h), for they bound and do not guess.
 */
#define CONIC_LEAST_NODE_RATIO 0.1

/* The ellipse of the covariance in the plane of u and v (Confetti Eq. 3, §4.3). */
conic_ellipse conic_moments_shape(const conic_moments *moments, const double u[3], const double v[3]);
