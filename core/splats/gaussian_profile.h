/* A profile as data: the constants and the named rules from which all that draws Gaussian scenes, checks pictures of
 * them, or differentiates them takes what the profile does. docs/reference/gaussians.md has the same table. */
#pragma once

/* How a Gaussian meets a pixel. */
typedef enum conic_gaussian_shape {
  CONIC_SHAPE_ELLIPSE = 0,  /* an ellipse on the screen, by the Jacobian of the projection at the mean */
  CONIC_SHAPE_RAY = 1,      /* along the pixel's ray */
  CONIC_SHAPE_DISC = 2,     /* where the ray meets the plane of a 2D Gaussian, or a dot on the screen */
  CONIC_SHAPE_FILTERED = 3, /* along the ray under the pixel's filter: of profiles of CONIC_SHAPE_RAY, as is the next */
  CONIC_SHAPE_SIGHT = 4,    /* along the ray of a camera whose rays are not affine on the screen */
  CONIC_SHAPE_SOLID = 5,    /* along the pixel's ray, in the order of the means and at their depths */
  CONIC_N_SHAPES
} conic_gaussian_shape;

#ifndef CONIC_ON_DEVICE
#include "conic/gaussian_render.h"

typedef enum conic_gaussian_coverage {
  CONIC_COVERAGE_ALPHA = 0, /* wherever alpha is large enough */
  CONIC_COVERAGE_TILES = 1, /* in the tiles of 16 × 16 pixels that meet a square about the mean */
  CONIC_COVERAGE_BOX = 2    /* in the tiles of 16 × 16 pixels that meet a box */
} conic_gaussian_coverage;

typedef struct conic_profile_row { /* NOLINT(clang-analyzer-optin.performance.Padding): in the order of the tables */
  const char *name;
  conic_gaussian_shape shape;
  conic_gaussian_coverage coverage;
  double near_z;
  int is_beyond_near; /* the mean must be beyond near, not at it */
  double alpha_most, alpha_least;
  double stop;               /* compositing ends before T would come below; 0: never */
  int is_beyond_stop;        /* or to it */
  double dilation;           /* px² that are added to the variance */
  double compensation_least; /* the opacity is multiplied by √max(this, det/det′); negative: it is not */
  double compensation_slack; /* or by √(max(this, det/(det′ + slack)) + slack), and by 0 where det ≤ slack */
  double slope_margin;       /* x/z and y/z of the Jacobian are clamped so far beyond the picture, as a share of half
                                its width; negative: not */
  double clip;               /* a mean beyond so many half pictures from the middle is left out; 0: none is */
  double axis_least;         /* px²: a lesser variance along the shorter axis is taken for it */
  double axis_most;          /* px: the greatest standard deviation along an axis; 0: there is none */
  double axis_share;         /* likewise, as a share of the picture's shorter side */
  double axis_seen;          /* px: what is shorter along its longer axis is left out */
  double spread_least;       /* px²: half the difference of the variances along the axes is not less */
  int spread_cancels;        /* that half is found as √(middle² − det), which in floats is off where it is small */
  double greatest_half_q;    /* nothing lies beyond; 0: no such border */
  double fall_end;           /* e, where the falloff is (e^(−q/2) − e)/(1 − e), which is 0 there; 0: e^(−q/2) */
  double fade_z;             /* nearer, opacity and colour fade, linearly in 1/z, to nothing at near_z; 0: not */
  double color_most;         /* the greatest colour; 0: there is none */
  int has_plain_color;       /* of degree 0 alone */
  int takes_rotation_as_is;  /* 0: quaternions are normalised; 1: but for those of length 1 up to roundings; 2: none is;
                                3: likewise, and rays meet the inverse of their matrix, not its transpose */
  int takes_middle;          /* the middle of the picture in place of the principal point */
  int orders_by_distance;
  int has_float_eye;
  int has_late_median; /* the median is the last with T > ½ before it */
  double disc_cutoff, disc_extent;
  double disc_near;    /* the least depth of a place on the disc; 0: no such border, and the mean's depth counts */
  double unscented[3]; /* α, β and κ of the unscented transform, whose ellipse has the box that is looked at; zeros:
                          there is none */
  double unscented_share; /* a Gaussian none of whose sigma points is so near to the picture, as a share of its sides,
                             is left out */
} conic_profile_row;

/* The sides of a tile of coverage, in pixels. */
static inline int conic_profile_tile(const conic_profile_row *row, const conic_camera *camera) {
  const int least = camera->width < camera->height ? camera->width : camera->height;
  return row->shape == CONIC_SHAPE_SOLID && least < 1080 ? 8 : 16;
}

/* Whether axes on the screen have limits. */
static inline int conic_profile_limits_axes(const conic_profile_row *row) {
  return row->axis_least > 0.0 || row->axis_most > 0.0 || row->axis_share > 0.0 || row->spread_least > 0.0;
}

/* How much opacity and colour are left at a depth beyond near_z. */
static inline double conic_profile_fade(const conic_profile_row *row, double z) {
  return row->fade_z > 0.0 && z < row->fade_z ? (1.0 / row->near_z - 1.0 / z) / (1.0 / row->near_z - 1.0 / row->fade_z)
                                              : 1.0;
}

/* Null for a number that is no profile. */
const conic_profile_row *conic_profile_row_of(conic_gaussian_profile profile);
#endif
