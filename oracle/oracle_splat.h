/* One splat of the oracle: placed in camera space, given a formula, evaluated at pixels. */
#pragma once

#include "conic/oracle.h"
#include "oracle/oracle_math.h"

/* The rounding unit of single precision: a rounding is off by at most this, relatively. */
#define ORACLE_UNIT 0x1p-24
/* What a value that some seven independent roundings went into may be off by, in units. One rounding's standard
 * deviation is 0.4 units on average over all numbers, so these are 4.7 standard deviations. */
#define ORACLE_ROUNDINGS 5.0

/* What the floats of a renderer may do. */
typedef struct oracle_floats {
  double unit;         /* of a sum or product at a pixel: what ORACLE_ROUNDINGS of ORACLE_UNIT are to conic's own */
  double axis, centre; /* of the length of an axis, and of the terms that a centre's component is the sum of */
  double place;        /* of the picture's size, of a place on the screen */
  double kernel;       /* of the kernel's value, besides */
  int is_setup_in_float;
} oracle_floats;

oracle_floats conic_oracle_floats(conic_float_kind kind);

/* What all splats share. */
typedef struct oracle_view {
  conic_camera camera;
  double near_z;
  conic_kernel kernel;
  double cutoff;    /* F_g */
  double support;   /* a pixel is covered where q is below this */
  double prefilter; /* h */
  double reach_px;  /* F_g·√h: by how much the prefilter widens an outline */
  double steepness; /* the factor of the bound by which `auto` takes ray */
  double thin_px;   /* below this smaller standard deviation a splat is not drawn by ray */
  int method;
  int cull_back;
  const struct oracle_profile *profile; /* null: the kernel is taken as it is */
  oracle_floats floats;
} oracle_view;

/* The error of a weight from which on `auto` draws by ray, and the bound's factor: docs/reference/picture.md, Auto. */
#define ORACLE_AUTO_ERROR 4e-3
#define ORACLE_AUTO_STEEPNESS 0.68
#define ORACLE_AUTO_BY_SLOPE 1.12
/* And the relative change of inverse depth over the filter's standard deviation from which on it draws by laplace. */
#define ORACLE_AUTO_CHANGE 1e-2

/* A view of the options; `near_z` is taken as given. */
oracle_view conic_oracle_view(const conic_camera *camera, const conic_render_options *options, double near_z,
                              conic_float_kind floats);

/* A splat in camera space. */
typedef struct oracle_placed {
  double p[3], tu[3], tv[3];
  double p_error[3]; /* of p in floats, where it is computed in them */
} oracle_placed;

typedef enum oracle_formula {
  ORACLE_NOT_DRAWN,
  ORACLE_CONIC,
  ORACLE_AFFINE,
  ORACLE_RAY,
  ORACLE_LAPLACE,
  ORACLE_SEGMENT,
  ORACLE_DISC,
  ORACLE_POINT
} oracle_formula;

/* The questions that choose a formula; each is answered by the sign of a number: no where it is negative. */
enum {
  ORACLE_IS_BEHIND,      /* wholly behind near */
  ORACLE_IS_BACK,        /* faces away */
  ORACLE_REACHES_NEAR,   /* the disc reaches the near plane */
  ORACLE_IS_BAND_NARROW, /* … and stands edge-on */
  ORACLE_IS_THIN,        /* the smaller standard deviation is below half a pixel, or what `auto` has for that */
  ORACLE_IS_COARSE,      /* conic's weights may be off by more than `auto` allows */
  ORACLE_IS_STEEP,       /* the plane's inverse depth changes within a pixel's filter by more than `ray` follows */
  ORACLE_IS_CLOSE,       /* the disc is deep compared with its distance */
  ORACLE_HAS_NO_PLANE,   /* axes without a plane, or no area where nothing widens it */
  ORACLE_N_QUESTIONS
};

void conic_oracle_ask(const oracle_view *view, const oracle_placed *s, double answers[ORACLE_N_QUESTIONS]);
/* The answers themselves: 1 for yes. */
void conic_oracle_answer(const double answers[ORACLE_N_QUESTIONS], int is_so[ORACLE_N_QUESTIONS]);
oracle_formula conic_oracle_choose(const oracle_view *view, const int is_so[ORACLE_N_QUESTIONS]);

/* An ellipse of the screen, or a ray formula: what evaluating at a pixel needs. */
typedef struct oracle_shape {
  oracle_formula formula;
  double range[2];    /* of inverse depth: far end, near end */
  double box[2][2];   /* the widened box: minimum and maximum in x, y; of what the formula may cover */
  double gradient[2]; /* of the plane's inverse depth per pixel; zero where it is infinite */
  /* How much the distance along the rays changes over what is covered, at most (docs/reference/picture.md, Visible),
   * and by how much single precision may be off there. */
  double change, change_error;
  /* all; a ray's or laplace's center is what its pixels are counted from, a point's the projected p, others' that of
   * the ellipse */
  double center[2];
  /* all but ray, laplace */
  double center_iz;
  oracle_symmetric variance, inverse; /* V and V⁻¹; laplace: of the Jacobian at p */
  double slope[2];                    /* of iz: V⁻¹R′g */
  double amplitude;
  /* ray, laplace: U, V, iz at the place (x, y) are row 0·x + row 1·y + row 2 */
  double from_screen[3][3];
} oracle_shape;

/* From this change on a splat is wide. */
#define ORACLE_NARROW_CHANGE 0.0195

/* Sets up `formula` for the splat; 0 where it cannot be (not finite). */
int conic_oracle_shape(const oracle_view *view, const oracle_placed *s, oracle_formula formula, oracle_shape *shape);

/* By how much of itself the ray formula's range of inverse depth is widened: docs/reference/picture.md, Ray. */
#define ORACLE_RANGE_SLACK 0x1p-20

/* Whether the disc's nearer end is beyond near. */
int conic_oracle_is_before_near(const oracle_view *view, const oracle_placed *s);

/* What a shape is at a pixel. A pixel is covered where none of the margins is negative, and those of q and in front of
 * the eye are positive. */
enum {
  ORACLE_MARGIN_Q,
  ORACLE_MARGIN_FRONT,
  ORACLE_MARGIN_FAR,
  ORACLE_MARGIN_NEAR,
  ORACLE_MARGIN_LEFT,
  ORACLE_MARGIN_RIGHT,
  ORACLE_MARGIN_TOP,
  ORACLE_MARGIN_BOTTOM,
  ORACLE_N_MARGINS,
  ORACLE_WEIGHT = ORACLE_N_MARGINS, /* amplitude times kernel, without opacity and floor */
  ORACLE_IZ,
  ORACLE_IZ_PLANE,
  ORACLE_RAY_LENGTH, /* |d| */
  ORACLE_N_VALUES
};

void conic_oracle_evaluate(const oracle_view *view, const oracle_shape *shape, double x, double y,
                           double values[ORACLE_N_VALUES]);

/* Bounds of what single precision adds to `values` while it evaluates the shape there. */
void conic_oracle_rounding(const oracle_view *view, const oracle_shape *shape, double x, double y,
                           const double values[ORACLE_N_VALUES], double errors[ORACLE_N_VALUES]);

static inline int conic_oracle_covers(const double values[ORACLE_N_VALUES]) {
  for (int i = 0; i < ORACLE_N_MARGINS; i++)
    if (!(values[i] >= 0.0))
      return 0;
  return values[ORACLE_MARGIN_Q] > 0.0 && values[ORACLE_MARGIN_FRONT] > 0.0;
}

/* The kernel at the squared distance q, wherever it is not cut off; and without its cutoff. */
double conic_oracle_kernel(const conic_kernel *kernel, double q);

/* What else there is to know of a kernel. */
typedef struct oracle_kernel_facts {
  double end;      /* the radius from which on it is 0: the cutoff, unless it has an end of its own */
  int is_gaussian; /* a prefilter leaves it one */
  int is_flat;     /* 1 up to its end, the end included where it is blurred */
} oracle_kernel_facts;

oracle_kernel_facts conic_oracle_kernel_facts(const conic_kernel *kernel);

/* The box of the disc's outline u² + v² = F², clipped at near, along one direction e of the screen: the extremes of e·x
 * and the places (x, y) and inverse depths where they are. 0 where nothing is in front of near. */
typedef struct oracle_extreme {
  double place[2], along, inverse_depth;
} oracle_extreme;
int conic_oracle_extremes(const oracle_view *view, const oracle_placed *s, const double e[2],
                          oracle_extreme extremes[2]);

/* The exact weight: a splat's kernel, projected without approximation, convolved with the pixel's Gaussian. */

/* From places of the screen to the splat's plane: U, V, 1/z = row 0·x + row 1·y + row 2. */
typedef struct oracle_exact {
  int has_plane; /* 0: seen exactly from its edge, it weighs nothing */
  double from_screen[3][3];
  double center_px[2]; /* where p projects to, if it does */
  int is_center_in_front;
} oracle_exact;

void conic_oracle_exact(const oracle_view *view, const oracle_placed *s, oracle_exact *exact);

/* The weight at a place, and the change that the last refinement of the integral made. */
double conic_oracle_exact_weight(const oracle_view *view, const oracle_exact *exact, double x, double y,
                                 double *change);

/* The profile of a kernel under the prefilter: docs/reference/picture.md, Profile. */

/* Gives the view the profile of its kernel, if that has one. Errors: MEMORY. */
conic_status conic_oracle_profile_create(conic_context *context, oracle_view *view);
void conic_oracle_profile_release(conic_context *context, oracle_view *view);

/* The kernel's value at q, or its profile's where it has one: of a splat with the two shares of the filter, the lesser
 * first, in the direction, or with a part of q across. `doubt`, unless null, is by how much that may be another where
 * rounding decides how the profile is taken. */
double conic_oracle_response(const oracle_view *view, const double share[2], double direction, double across, double q,
                             double *doubt);

/* The direction, from N and M of the page, and what is added for what is round. */
double conic_oracle_direction(const oracle_view *view, const double share[2], double n, double m, double round);
