/* A Gaussian of a scene, set up for one view in double precision. */
#pragma once

#include "conic/gaussian_oracle.h"
#include "core/splats/gaussian_profile.h"

typedef struct oracle_ray {
  double origin[3], direction[3];
  int is_there;
} oracle_ray;

typedef struct oracle_gaussian_view {
  const conic_camera *camera;
  const conic_profile_row *rules;
  double eye[3];       /* from which colours are seen */
  double center_px[2]; /* the principal point, as the profile has it */
  double prefilter;    /* px²; of CONIC_SHAPE_RAY */
  double most_angle;   /* of CONIC_SHAPE_SOLID by a fisheye: nothing is seen from it on */
  oracle_ray *rays;    /* of the pixels' centres, where it takes long to find them; else null */
} oracle_gaussian_view;

typedef struct oracle_gaussian {
  uint32_t index;
  float key; /* orders */
  int is_drawn, is_flat;
  double mean[3];    /* in camera space */
  double axes[3][3]; /* in camera space, one standard deviation long each; the third of a flat one is zero */
  double unit[3][3]; /* the directions of the axes */
  double scale[3];
  double opacity, color[3], normal[3];
  double place_px[2], form[3]; /* of an ellipse: q = form₀·x² + 2·form₁·x·y + form₂·y² */
  double rows[3][3];           /* of a disc: from its plane to the screen */
  double box_px[2][2];         /* no pixel outside is covered: minimum, maximum */
} oracle_gaussian;

/* Looks through a camera as the profile does; the view refers to it. */
void conic_oracle_gaussian_look(const conic_camera *camera, conic_gaussian_profile profile, oracle_gaussian_view *view);

/* Sets up Gaussian i; is_drawn is 0 where the profile leaves it out everywhere. */
void conic_oracle_gaussian_place(const oracle_gaussian_view *view, const conic_gaussians *set, size_t i,
                                 oracle_gaussian *g);

/* Its quaternion as the profile takes it; returns the length that it was divided by. */
double conic_oracle_quaternion(const conic_profile_row *rules, const conic_gaussians *set, size_t i, double q[4]);
/* The greatest standard deviation along an axis, in pixels; infinite where there is none. */
double conic_oracle_longest_axis(const oracle_gaussian_view *view);
/* The rotation of a quaternion of unit length. */
void conic_oracle_rotation(const double q[4], double r[3][3]);
/* A number of the harmonics of all; and one Gaussian's (degree + 1)² × 3. */
double conic_oracle_harmonic_at(const conic_gaussians *set, size_t at);
void conic_oracle_harmonics_of(const conic_gaussians *set, size_t i, double *sh);

/* Its opacity at a place of the screen and the depth there; 0 where the profile leaves it out. */
double conic_oracle_gaussian_alpha(const oracle_gaussian_view *view, const oracle_gaussian *g, double x, double y,
                                   double *z);

/* Its response along the pixel's ray: the greatest, as q, where (z), and the width there in z. 0 where it has none. */
int conic_oracle_gaussian_along(const oracle_gaussian_view *view, const oracle_gaussian *g, double x, double y,
                                double *q, double *z, double *width);

/* The ray through a place of the screen, in pixels, in camera space: origin + z·direction, which is of length 1 where
 * the camera is neither perspective nor orthographic. 0 where there is none. */
int conic_oracle_pixel_ray(const conic_camera *camera, double x, double y, double origin[3], double direction[3]);

/* Those of a row's pixels. */
void conic_oracle_ray_row(const oracle_gaussian_view *view, size_t row, oracle_ray *rays);

/* The same under the filter: the filtered q, and by which share of itself the opacity remains. */
int conic_oracle_gaussian_filtered(const oracle_gaussian_view *view, const oracle_gaussian *g, double x, double y,
                                   double *q, double *z, double *share);
/* Under the filter, the pixels that are looked at; 0: none. */
int conic_oracle_gaussian_box(const oracle_gaussian_view *view, oracle_gaussian *g);

/* The real harmonics up to a degree, of a direction of unit length: (degree + 1)² numbers. */
void conic_oracle_harmonic_values(int degree, const double direction[3], double *y);
/* How they change with x, y and z of the direction, as the polynomials that they are: by 3 numbers each. */
void conic_oracle_harmonic_slopes(int degree, const double direction[3], double (*slopes)[3]);
/* The colour seen along a direction (of unit length): max(0, ½ + Σ sh·Y). `sh` has (degree + 1)² × 3 numbers. */
void conic_oracle_harmonics(const double *sh, int degree, const double direction[3], double color[3]);
