/* gsplat's cameras of CONIC_SHAPE_SOLID, with bounds of what floats make of them. */
#pragma once

#include "oracle/gaussians/oracle_bounded.h"
#include "oracle/gaussians/oracle_gaussian.h"

/* A pixel's ray. */
typedef struct oracle_sight {
  double direction[3], off; /* of each component */
  int is_there, may_be_there;
} oracle_sight;

/* Whether rays are not affine on the screen. */
int conic_oracle_is_bent(const conic_camera *camera);

/* The angle from the axis below which a fisheye sees; of other cameras infinite. */
double conic_oracle_most_angle(const conic_camera *camera);

/* Where a place in camera space shows. Returns whether the lens sees it; *may_be: or rounding may make it so. */
int conic_oracle_lens_show(const oracle_gaussian_view *view, const bounded at[3], double unit, bounded place[2],
                           int *may_be);

/* The ray through a place of the picture, in pixels. A `unit` of 0 is the double run. */
void conic_oracle_lens_see(const oracle_gaussian_view *view, double x_px, double y_px, double unit,
                           oracle_sight *sight);
