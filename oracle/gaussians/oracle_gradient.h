/* The steps of the derivative of a picture of Gaussians, in reverse: from a pixel's numbers to what Gaussians are on
 * the screen, and from there to their parameters and the camera's. */
#pragma once

#include "conic/gaussian_gradient.h"
#include "oracle/gaussians/oracle_gaussian.h"
#include "oracle/gaussians/oracle_surface.h"

/* What a Gaussian is at the pixels, by which derivatives are summed up. */
enum {
  BY_OPACITY = 0, /* after compensation */
  BY_COLOR = 1,   /* 3 */
  BY_Z = 4,       /* of the mean, this and the next of an ellipse: */
  BY_PLACE = 5,   /* 2 */
  BY_FORM = 7,    /* 3 */
  N_BY_ELLIPSE = 10,
  BY_BALL = 4,    /* of a ray: 9, the rows of the map to where the Gaussian is a unit ball, */
  BY_MIDDLE = 13, /* and 3, the mean there */
  N_BY_SCREEN = 16
};

/* A Gaussian as the pixels see it. */
typedef struct oracle_shown {
  uint32_t index;
  float key;
  uint16_t first[2], last[2]; /* pixels that it may cover */
  int is_flat;
  double opacity, color[3], z, most_q; /* most_q: beyond it α is below its least, or q above the cutoff */
  double place[2], form[3];            /* of an ellipse */
  double ball[3][3], middle[3];        /* of a ray; the third row of a flat one is of unit length */
} oracle_shown;

/* Sets up what a pixel needs; 0 where the picture does not show Gaussian i. */
int conic_oracle_show(const oracle_gaussian_view *view, const conic_gaussians *set, size_t i, oracle_shown *shown);

/* What covers a pixel. */
typedef struct oracle_met {
  uint32_t entry, index;
  float key;
  int is_most;            /* α is at its greatest */
  double alpha, response; /* response: e^(−q/2) */
  double z, before;       /* z there; T before it */
  double by_weight, by_z; /* dL/dw, dL/dz */
} oracle_met;

/* Whether it covers the place, and how: ORACLE_COVERS, or ORACLE_NEARLY where α is below its least by a hundredth of
 * that at most; else 0. */
enum { ORACLE_COVERS = 1, ORACLE_NEARLY = 2 };
int conic_oracle_meet_shown(const oracle_gaussian_view *view, const oracle_shown *shown, double x, double y,
                            oracle_met *met);

/* The weights of a pixel: of R, G, B, A and Z. */
enum { N_WEIGHTS = 5 };

typedef struct oracle_gradient_pixel {
  double x, y, weights[N_WEIGHTS];
  const float *background;
  const oracle_surface *surface; /* null: there is none */
  int goes_on;                   /* all are composited, whatever T is */
  int passes_most;               /* the derivative goes through α's greatest, as if it were not held there */
} oracle_gradient_pixel;

/* Composites the list in its order, until it ends: fills in `before`, by_weight and by_z, and sets *n to how many are
 * composited. Returns the pixel's part of L. *behind becomes the derivative of L by the T that is left. */
double conic_oracle_gradient_forth(const oracle_gaussian_view *view, const oracle_gradient_pixel *pixel,
                                   const oracle_shown *const *shown, oracle_met *met, size_t *n, double *behind);

/* Adds what a Gaussian is due for what it is at the pixel; by_alpha: dL/dα. */
void conic_oracle_gradient_back(const oracle_gaussian_view *view, const oracle_gradient_pixel *pixel,
                                const oracle_shown *shown, const oracle_met *met, double by_alpha, double *sums);

/* The camera's part: of all Gaussians. */
typedef struct oracle_camera_gradient {
  double cam_from_world[3][4], focal[2], center[2];
} oracle_camera_gradient;

/* A Gaussian's parameters. */
typedef struct oracle_parameters {
  double mean[3], scale[3], rotation[4], opacity, sh[3 * (CONIC_MAX_SH_DEGREE + 1) * (CONIC_MAX_SH_DEGREE + 1)];
  double turn[4];  /* by the quaternion of unit length, as if its numbers were free */
  uint32_t doubts; /* clamps that roundings of the model may pass */
} oracle_parameters;

/* The inverse of the camera's rotation, and −R⁻¹t. */
typedef struct oracle_eye {
  double inverse[3][3], place[3];
} oracle_eye;

/* Carries derivatives by what Gaussian i is at the pixels to those by its parameters, and adds the camera's part.
 * Without `model` no doubts are set; without `form` the Gaussian's own is taken. */
void conic_oracle_gradient_chain(const oracle_gaussian_view *view, const oracle_eye *eye, const conic_gaussians *set,
                                 size_t i, const conic_float_model *model, const double *form, const double *sums,
                                 oracle_parameters *to, oracle_camera_gradient *camera);
