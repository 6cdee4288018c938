/* The derivative of a picture of a Gaussian scene, in double precision: the reference for the backward pass of a
 * differentiable renderer. docs/reference/gradient.md says with respect to what, and how it is found.
 *
 * With weights W for the numbers of each pixel, L = Σ W·C is a number; this is its gradient. Decisions (which Gaussians
 * a pixel shows, and in which order) are those of the double run, and do not change. */
#ifndef CONIC_GAUSSIAN_GRADIENT_H
#define CONIC_GAUSSIAN_GRADIENT_H

#include "conic/gaussian_judge.h"

CONIC_BEGIN_C

/* W: of width × height pixels, row by row from the top. Null: 0. */
typedef struct conic_gaussian_weights {
  int width, height;
  double *rgb;   /* 3 a pixel: of the display values over the background */
  double *alpha; /* of A = 1 − T */
  double *z;     /* of Z = Σ w·z / Σ w */
  uint64_t reserved[4];
} conic_gaussian_weights;

/* Reads weights: the channels R, G, B, A and Z of a picture, as conic_image_read takes it, or a NumPy array (.npy) of
 * the shape (height, width, n), n being 3 (R, G, B), 4 (and A) or 5 (and Z). Missing channels are 0. On success the
 * caller owns *weights; on failure it is empty. Errors: INPUT (also a number that is not finite), MEMORY,
 * UNSUPPORTED. */
CONIC_API conic_status conic_gaussian_weights_read(conic_context *context, const char *path,
                                                   conic_gaussian_weights *weights);
CONIC_API void conic_gaussian_weights_release(conic_context *context, conic_gaussian_weights *weights);

/* What makes a derivative doubtful: the decisions of conic_gaussian_doubt, and clamps beyond which it is 0. */
enum {
  CONIC_DOUBT_COLOR = CONIC_N_GAUSSIAN_DOUBTS, /* a channel, which is at least 0 */
  CONIC_DOUBT_SLOPE,                           /* x/z or y/z of the Jacobian */
  CONIC_DOUBT_COMPENSATION,                    /* the least share of the opacity */
  CONIC_N_GRADIENT_DOUBTS
};

/* "least", "sign" … "color", "slope", "compensation"; null for a number that is none. */
CONIC_API const char *conic_gradient_doubt_name(int doubt);

typedef struct conic_gradient_options {
  size_t size;                    /* sizeof(conic_gradient_options), set by the init function */
  const conic_float_model *model; /* its roundings put decisions in doubt; null: those of strict floats */
  uint32_t is_raw;                /* with respect to ln s and logit o */
  uint32_t leaves_doubts;         /* do not look for doubts */
  uint8_t *wrong_kinds;           /* where one is judged, takes of each Gaussian bits 1 << conic_gradient_kind of the
                                     kinds that are wrong; may be null */
  const conic_gaussian_surfaces *surfaces; /* among the Gaussians, which the derivative takes as given; null: there are
                                              none. Not where one is judged */
} conic_gradient_options;

/* Strict floats, activated values, doubts are looked for. */
CONIC_API void conic_gradient_options_init_sized(conic_gradient_options *options, size_t size);
#define conic_gradient_options_init(options) conic_gradient_options_init_sized(options, sizeof *(options))

/* Kinds of parameters. */
typedef enum conic_gradient_kind {
  CONIC_GRADIENT_MEAN = 0,
  CONIC_GRADIENT_SCALE = 1,
  CONIC_GRADIENT_ROTATION = 2,
  CONIC_GRADIENT_OPACITY = 3,
  CONIC_GRADIENT_SH = 4,
  CONIC_GRADIENT_PLACE = 5 /* the centre on the screen */
} conic_gradient_kind;

#define CONIC_N_GRADIENT_KINDS 6

/* "mean", "scale", "rotation", "opacity", "sh", "place"; null for a number that is none. */
CONIC_API const char *conic_gradient_kind_name(conic_gradient_kind kind);

/* Arrays of one number a Gaussian; the harmonics are laid out as in conic_gaussians. */
typedef struct conic_gaussian_gradient {
  size_t count;
  int sh_degree, is_raw;
  double *mean[3];     /* by the mean in the world */
  double *scale[3];    /* scale[2] is null for a set of 2D Gaussians */
  double *rotation[4]; /* by w, x, y, z as given; the division by their length is differentiated, too */
  double *opacity, *sh;
  double *place[2];            /* by the centre on the screen, in pixels; 0 for `exact` */
  uint32_t *doubt;             /* bits 1 << CONIC_DOUBT_…: the doubts about this Gaussian, where W is not 0 */
  double cam_from_world[3][4]; /* by the camera's matrix, each number by itself; the eye is −R⁻¹t */
  double fx, fy, cx, cy;       /* cx and cy are 0 for profiles that ignore them */
  double loss;                 /* L */
  size_t n_shown, n_doubtful;  /* Gaussians composited where W is not 0; those with a doubt */
  size_t doubtful[16];         /* by CONIC_DOUBT_… */
  uint64_t lacks;              /* of a file: bits 1 << conic_gradient_kind of the kinds that it lacks, which are 0
                                  here */
  uint64_t reserved[7];
} conic_gaussian_gradient;

/* Finds the gradient for the profile and the background of `options` (null: the defaults). The same bits for any
 * number of threads. On success the caller owns *gradient; on failure it is empty. Null `how` is the defaults. Reports
 * progress as "gradient" and "doubts". Errors: ARGUMENT (also weights of another size than the camera's), MEMORY,
 * CANCELLED, UNSUPPORTED (the profiles of 2D Gaussians). */
CONIC_API conic_status conic_gaussian_gradient_find(conic_context *context, const conic_gaussians *gaussians,
                                                    const conic_camera *camera, const conic_gaussian_options *options,
                                                    const conic_gaussian_weights *weights,
                                                    const conic_gradient_options *how,
                                                    conic_gaussian_gradient *gradient);
CONIC_API void conic_gaussian_gradient_release(conic_context *context, conic_gaussian_gradient *gradient);

/* Whether gradients of the profile are found. */
CONIC_API int conic_gradient_has_profile(conic_gaussian_profile profile);

/* Writes a .ply of doubles. Its properties are those of 3D Gaussian splatting's scenes, then place_x, place_y and
 * doubt. The file appears under its name only when it is whole. Errors: MEMORY, IO. */
CONIC_API conic_status conic_gaussian_gradient_write(conic_context *context, const char *path,
                                                     const conic_gaussian_gradient *gradient);

/* Reads another program's gradient: a .ply with these properties, or an .npz with one row a Gaussian in each array:
 * means, quats (w, x, y, z), scales, opacities, sh of (n, harmonics, 3), and means2d in pixels. On success the caller
 * owns *gradient; on failure it is empty. Errors: INPUT, MEMORY, CANCELLED, UNSUPPORTED. */
CONIC_API conic_status conic_gaussian_gradient_read(conic_context *context, const char *path,
                                                    conic_gaussian_gradient *gradient);

/* A wrong number: the one of its Gaussian that is farthest off. */
typedef struct conic_gradient_fault {
  size_t gaussian;
  int kind, number; /* number: within the kind, as x, y, z; harmonics as in conic_gaussians */
  double found, value, low, high;
} conic_gradient_fault;

/* A mistake that a kind's wrong numbers look like. It is named where nine of ten wrong Gaussians become right if it is
 * assumed, and no right one becomes wrong. */
typedef struct conic_gradient_mistake {
  const char *name;       /* as "sh-direction"; null: none comes near */
  size_t righted, spoilt; /* Gaussians; `spoilt` is 0 where it is named */
  int is_named;
} conic_gradient_mistake;

typedef struct conic_gradient_verdict {
  size_t gaussians[4];                           /* by conic_gaussian_class */
  size_t wrong[CONIC_N_GRADIENT_KINDS];          /* Gaussians with a wrong number of a kind */
  double greatest[CONIC_N_GRADIENT_KINDS];       /* of the right numbers */
  double max_abs[CONIC_N_GRADIENT_KINDS];        /* of the differences; infinite where one is NaN */
  double share_of_bound[CONIC_N_GRADIENT_KINDS]; /* the greatest share of its rounding bound that a number used, among
                                                    the numbers within it */
  conic_gradient_fault worst[CONIC_MAX_FAULTS];  /* the Gaussians that are farthest off, the worst first */
  int n_worst, pass;                             /* pass: no number is wrong */
  conic_gradient_mistake mistakes[CONIC_N_GRADIENT_KINDS];
  uint64_t reserved[6];
} conic_gradient_verdict;

/* Judges another program's gradient, number by number, against what floats of `how->model` (null: those of a GPU's fast
 * mathematics) may give: docs/reference/gradient.md. `classes` takes the worst class of each Gaussian's numbers, and
 * may be null. Errors: as conic_gaussian_gradient_find; ARGUMENT also where the counts differ; UNSUPPORTED for
 * `exact`. */
CONIC_API conic_status conic_gaussian_gradient_judge(conic_context *context, const conic_gaussians *gaussians,
                                                     const conic_camera *camera, const conic_gaussian_options *options,
                                                     const conic_gaussian_weights *weights,
                                                     const conic_gradient_options *how,
                                                     const conic_gaussian_gradient *theirs, uint8_t *classes,
                                                     conic_gradient_verdict *verdict);

CONIC_END_C
#endif
