/* gsplat's cameras of CONIC_SHAPE_SOLID, with bounds of what floats make of them. */
#pragma once

#include "oracle/gaussians/oracle_bounded.h"
#include "oracle/gaussians/oracle_gaussian.h"

/* A pixel's ray. */
typedef struct oracle_sight {
  double direction[3], off; /* of each component */
  double origin[3], origin_off;
  int is_there, may_be_there;
} oracle_sight;

/* Whether rays are not affine on the screen. */
int conic_oracle_is_bent(const conic_camera *camera);

/* The angle from the axis below which a fisheye sees; of other cameras infinite. */
double conic_oracle_most_angle(const conic_camera *camera);

/* The camera in the middle of a rolling shutter's exposure, and the eye that colours are seen from. */
void conic_oracle_middle(const conic_camera *camera, conic_camera *middle);
void conic_oracle_shutter_eye(const conic_camera *camera, double eye[3]);

/* The ray towards a place at the time when it is seen. */
void conic_oracle_aim_in_time(const oracle_gaussian_view *view, const double at[3], double direction[3],
                              double origin[3]);

/* Where a place in camera space shows. Returns whether the lens sees it; *may_be: or rounding may make it so. */
int conic_oracle_lens_show(const oracle_gaussian_view *view, const bounded at[3], double unit, bounded place[2],
                           int *may_be);

/* The ray through a place of the picture, in pixels. A `unit` of 0 is the double run. */
void conic_oracle_lens_see(const oracle_gaussian_view *view, double x_px, double y_px, double unit,
                           oracle_sight *sight);
