/* Gaussians that are merged into fewer, and by how much a picture changes where these are drawn in their place. */
#pragma once

#include "core/base/base.h"
#include "gaussians/scene/gaussian_set.h"

/* A Gaussian as a row of floats: mean, deviations, quaternion, opacity; its harmonics follow. */
enum { CONIC_BLEND_SCALE = 3, CONIC_BLEND_ROTATION = 6, CONIC_BLEND_OPACITY = 10, CONIC_BLEND_HARMONICS = 11 };
enum { CONIC_BLEND_MOST_FLOATS = CONIC_BLEND_HARMONICS + CONIC_MOST_HARMONICS };

/* Beyond so many deviations nothing of a Gaussian is seen, as 1/255 is the least that counts. */
#define CONIC_BLEND_DEVIATIONS 3.34f

/* What a node may be made of at most. */
enum { CONIC_BLEND_MOST_PARTS = 12 };

/* What is known of the Gaussians that one stands for. */
typedef struct conic_blend_parts {
  float light;       /* the square of what the one changes, times the area where, in square units */
  float depth, edge; /* sums of their optical depths, and of these times the root of their projections' traces */
  float reach;       /* they lie so far from the mean at most */
  float tint[3];     /* their mean harmonics of degree 0, by optical depth */
} conic_blend_parts;
enum { CONIC_BLEND_PARTS = 7 };

typedef struct conic_blend {
  const float *row;
  double mean[3], covariance[6]; /* xx, xy, xz, yy, yz, zz */
  double area;                   /* about the mean of its projections' |Σ|^½ over directions */
  double color[3];               /* of degree 0 */
  conic_blend_parts parts;
  int is_drawn; /* 0: a number of it is none, and no picture shows it */
} conic_blend;

/* A float with so few bits as merged rows have. */
float conic_blend_rounded(double value);

/* Of a Gaussian as it came. */
void conic_blend_take(const float *row, int sh_degree, conic_blend *blend);

/* Makes one row of n, by their opacities times their areas. */
void conic_blend_merge(const conic_blend *parts, size_t n, int sh_degree, float *row);

/* Parts n into groups, so that there are about n_wanted, those whose merging changes least first. group[i] is the
 * number of i's, which are counted from 0 in the order of their first parts; *n_groups is how many there are. Errors:
 * MEMORY. */
conic_status conic_blend_group(conic_context *context, const conic_blend *blends, size_t n, size_t n_wanted,
                               uint32_t *group, size_t *n_groups);

/* Fills in what is known of n parts, which have theirs, for what stands for them. */
void conic_blend_find_parts(const conic_blend *parts, size_t n, int sh_degree, conic_blend *whole);

/* Makes a row what its parts are together where a variance is added to each one's projection: many that are small are
 * more than one that is large then. */
void conic_blend_dilate(const conic_blend_parts *parts, double variance, float *row);
