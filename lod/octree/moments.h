/* Sums over a set of splats: the generic homogeneous covariance of Confetti (§4.2), and the averages beside it. A node
 * gets them by merging its children's. */
#ifndef CONIC_MOMENTS_H
#define CONIC_MOMENTS_H

#include "conic/splats.h"

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

#endif
