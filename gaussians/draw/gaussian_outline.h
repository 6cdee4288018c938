/* Where on the screen an ellipsoid lies, with room for all that floats round when pixels look at it. */
#pragma once

#include "gaussians/draw/gaussian_footprint.h"

/* How much larger a box is made than the formulas say, in pixels: more than their roundings. */
#define CONIC_GAUSSIAN_SLACK_PX 0.0625
/* How much more q is taken than the formula says: likewise. */
#define CONIC_REACH_SLACK 1e-3
/* Whose squares add up to 1 but for this, a quaternion was made a unit one in floats. */
#define CONIC_UNIT_SLACK 0x1p-20

static inline double conic_limited(double value, double least, double most) {
  return value > least ? (value < most ? value : most) : least;
}

/* A Gaussian in camera space. */
typedef struct conic_gaussian_placed {
  double mean[3], unit[3][3], scale[3], opacity;
  double world[3][3];    /* its axes' directions in the world, as columns */
  double variance[3][3]; /* of shapes with rays */
  int is_flat;
} conic_gaussian_placed;

/* The box of the ellipsoid at q = reach, grown by what the view's filter adds. All of the screen where it comes up to
 * the plane of the eye. Returns 0 where it lies behind that. */
int conic_gaussian_project(const conic_gaussian_view *view, conic_gaussian_placed *p, double reach, double least[2],
                           double most[2]);

/* A footprint of CONIC_SHAPE_RAY has its box. Gives it the ellipse, too, beyond which q is above reach, as floats have
 * q. A Gaussian that comes up to the plane of the eye gets a smaller box instead. Where neither is certain, nothing
 * changes. The ray was divided by `unit_of`. Returns 0 where no box is left. */
int conic_gaussian_find_outline(const conic_gaussian_view *view, const conic_gaussian_placed *p, double reach,
                                const conic_gaussian_ray *ray, double unit_of, conic_gaussian_footprint *f);

/* Limits the box to pixels whose centres are within, and to the picture. Returns 0 where it is empty. */
int conic_gaussian_limit_box(const conic_gaussian_view *view, const double least[2], const double most[2],
                             conic_gaussian_footprint *f);
