/* What a renderer of floats may make of a Gaussian scene. For each pixel: the profile in double precision, with a bound
 * of its roundings; the verdict on a picture; and why the pixel is as it is. docs/reference/oracle.md says how. */
#ifndef CONIC_GAUSSIAN_JUDGE_H
#define CONIC_GAUSSIAN_JUDGE_H

#include "conic/gaussian_render.h"
#include "conic/oracle.h"

CONIC_BEGIN_C

typedef struct conic_float_model {
  size_t size;            /* sizeof(conic_float_model), set by the init function */
  int is_setup_in_float;  /* the set-up runs in float, and covariances are formed in space, where they cancel */
  int n_form_roundings;   /* of any term of q/2 before it is added */
  double setup_roundoff;  /* relative, of a step of the set-up; its results are also rounded to float */
  double exp_relative;    /* error of eˣ: this share of it … */
  double exp_by_argument; /* … and this times |x| */
} conic_float_model;

CONIC_API void conic_float_model_init_sized(conic_float_model *model, conic_float_kind kind, size_t size);
#define conic_float_model_init(model, kind) conic_float_model_init_sized(model, kind, sizeof *(model))

/* Decisions that rounding may turn either way. */
typedef enum conic_gaussian_doubt {
  CONIC_DOUBT_LEAST = 0,  /* α at its least */
  CONIC_DOUBT_SIGN = 1,   /* of q, which floats may make negative */
  CONIC_DOUBT_EDGE = 2,   /* of the tiles, of the box or of the cutoff */
  CONIC_DOUBT_NEAR = 3,   /* at the near plane, or at the eye */
  CONIC_DOUBT_ORDER = 4,  /* of two whose keys floats may swap */
  CONIC_DOUBT_END = 5,    /* T where compositing ends */
  CONIC_DOUBT_MOST = 6,   /* α at its greatest: either way gives the same */
  CONIC_DOUBT_SURFACE = 7 /* before or behind the surface of its pixel */
} conic_gaussian_doubt;

#define CONIC_N_GAUSSIAN_DOUBTS 8

/* "least", "sign" …; null for a number that is none. */
CONIC_API const char *conic_gaussian_doubt_name(conic_gaussian_doubt doubt);

/* The channels of a pixel, in this order. */
enum {
  CONIC_BOUND_RGB = 0, /* 3, over the background */
  CONIC_BOUND_T = 3,
  CONIC_BOUND_Z = 4,
  CONIC_BOUND_MEDIAN_Z = 5,
  CONIC_BOUND_INVERSE_Z = 6,
  CONIC_BOUND_NORMAL = 7, /* 3: Σ w·n, not normalised */
  CONIC_BOUND_COUNT = 10,
  CONIC_N_BOUNDS = 11
};

#define CONIC_MAX_BOUND_IDS 8

/* What a pixel may be. */
typedef struct conic_gaussian_bound {
  double value[CONIC_N_BOUNDS];                       /* in double */
  double low[CONIC_N_BOUNDS], high[CONIC_N_BOUNDS];   /* with the decisions of the double run */
  double least[CONIC_N_BOUNDS], most[CONIC_N_BOUNDS]; /* with the decisions in doubt either way */
  uint32_t doubts;                                    /* how many decisions are in doubt */
  uint32_t kinds;                                     /* bits 1 << conic_gaussian_doubt */
  int is_wide;                      /* there were too many decisions to follow each: the range is wider than need be */
  uint32_t id[CONIC_MAX_BOUND_IDS]; /* ids that may be the heaviest; CONIC_NO_ID among them: none may be */
  uint32_t last[CONIC_MAX_BOUND_IDS];
  int n_id, n_last; /* above CONIC_MAX_BOUND_IDS: any */
  uint64_t reserved[4];
} conic_gaussian_bound;

/* Bounds the pixels named (y · width + x); null `pixels` with n of the picture's size means all. `bounds` has room for
 * n. Null `model` is conic's own. Reports progress as "verify". Errors: ARGUMENT, MEMORY, CANCELLED. */
CONIC_API conic_status conic_gaussian_bound_pixels(conic_context *context, const conic_gaussians *gaussians,
                                                   const conic_camera *camera, const conic_gaussian_options *options,
                                                   const conic_float_model *model, const uint32_t *pixels, size_t n,
                                                   conic_gaussian_bound *bounds);

typedef conic_pixel_class conic_gaussian_class;

#define CONIC_N_GAUSSIAN_CLASSES CONIC_N_PIXEL_CLASSES

/* "equal", "rounded" …; null for a number that is none. */
CONIC_API const char *conic_gaussian_class_name(conic_gaussian_class number);

/* What surfaces among Gaussians look like: opaque, and one sample a pixel of `image`, which has as many pixels as the
 * judged picture has samples. It is taken as it is. */
typedef struct conic_gaussian_surfaces {
  const conic_image *image; /* rgba and Z; N and id where the judged picture has these */
  int is_linear;            /* the Gaussians' colours are: else the surfaces' are encoded by sRGB's curve */
  uint32_t first_id;        /* the id, in the judged picture, of the image's id 0 */
} conic_gaussian_surfaces;

typedef struct conic_gaussian_judging {
  size_t size;                    /* sizeof(conic_gaussian_judging), set by the init function */
  const conic_float_model *model; /* of what drew the picture; null: conic's own */
  size_t n_pixels;                /* so many are judged, spread evenly; 0: all */
  int samples;                    /* the picture has N × N a pixel */
  int is_opaque;                  /* the picture has a background, so A = 1 */
  const conic_image *greatest;    /* null; or the image holds the least values that its codes stand for, and this holds
                                     the greatest, plane by plane (conic/picture.h) */
  float *ranges;                  /* null; or takes, of the picture's size, how wide the range of each judged pixel is:
                                     the sum over its channels, of depths relative. For conic_gaussian_diagnose */
  uint32_t *faults;               /* null; or takes which planes of each judged pixel are wrong, as bits 1 << plane, and
                                     of rgba which channels, as bits 1 << (CONIC_MAX_PLANES + channel). For
                                     conic_faults_locate */
  const conic_gaussian_surfaces *surfaces; /* null: there are only Gaussians */
} conic_gaussian_judging;

/* All pixels, conic's own floats, one sample. */
CONIC_API void conic_gaussian_judging_init_sized(conic_gaussian_judging *judging, size_t size);
#define conic_gaussian_judging_init(judging) conic_gaussian_judging_init_sized(judging, sizeof *(judging))

typedef struct conic_gaussian_verdict {
  conic_oracle_plane_verdict planes[CONIC_MAX_PLANES]; /* max_abs: from the double's value, relative for Z and above 1;
                                                          bound: the widest range of a pixel; p999 is not set */
  size_t judged_pixels, covered_pixels, wide_pixels;
  size_t pixels[CONIC_N_GAUSSIAN_CLASSES];      /* by class */
  size_t doubtful_pixels;                       /* some decision is in doubt */
  size_t doubtful[CONIC_N_GAUSSIAN_DOUBTS];     /* by kind; a pixel may have several */
  size_t explained_by[CONIC_N_GAUSSIAN_DOUBTS]; /* of the explained pixels */
  conic_oracle_fault worst[CONIC_MAX_FAULTS];   /* the most wrong pixels, the worst first */
  int n_worst;
  int pass;              /* no pixel is wrong */
  uint64_t vague_pixels; /* a colour's range is wider than 1/255: smaller faults do not show there */
  uint64_t reserved[3];
} conic_gaussian_verdict;

/* Judges the picture's planes that Gaussian scenes have. `classes`, of the picture's size, takes each judged pixel's
 * class, and may be null. Errors: ARGUMENT (also a size that is not the camera's), MEMORY, CANCELLED. */
CONIC_API conic_status conic_gaussian_judge(conic_context *context, const conic_gaussians *gaussians,
                                            const conic_camera *camera, const conic_gaussian_options *options,
                                            const conic_gaussian_judging *judging, const conic_image *image,
                                            uint8_t *classes, conic_gaussian_verdict *verdict);

/* Adds a verdict to another one, which begins as zero but for `pass`: the verdict on both pictures. */
CONIC_API void conic_gaussian_verdict_add(const conic_gaussian_verdict *verdict, conic_gaussian_verdict *sum);

/* Fills the plane `doubt` of the image: how many decisions are in doubt at each pixel, or at its most doubtful sample.
 * Errors: as conic_gaussian_judge. */
CONIC_API conic_status conic_gaussian_find_doubts(conic_context *context, const conic_gaussians *gaussians,
                                                  const conic_camera *camera, const conic_gaussian_options *options,
                                                  const conic_gaussian_judging *judging, conic_image *image);

/* What becomes of a Gaussian at a pixel. */
typedef enum conic_gaussian_part {
  CONIC_PART_COMPOSITED = 0,
  CONIC_PART_HIDDEN = 1,  /* compositing had ended */
  CONIC_PART_FAINT = 2,   /* α is below its least, or q below 0 */
  CONIC_PART_OUTSIDE = 3, /* the pixel is not in its tiles, in its box or within the cutoff */
  CONIC_PART_NEAR = 4,    /* it is too near, or behind the eye */
  CONIC_PART_BEHIND = 5   /* it is behind a surface */
} conic_gaussian_part;

#define CONIC_N_GAUSSIAN_PARTS 6

/* "composited", "hidden" …; null for a number that is none. */
CONIC_API const char *conic_gaussian_part_name(conic_gaussian_part part);

typedef struct conic_gaussian_entry {
  uint32_t index;
  conic_gaussian_part part;
  double key, z;           /* key: its place in the order, as a float; z: its depth at the pixel */
  double q, q_low, q_high; /* the value in double, and the range that floats may give */
  double alpha, alpha_low, alpha_high;
  double before, after, weight; /* T and w; 0 unless it is composited */
  double color[3], opacity;     /* as the profile sees them */
  uint32_t doubts;              /* bits 1 << conic_gaussian_doubt */
  uint64_t reserved[4];
} conic_gaussian_entry;

typedef struct conic_gaussian_listing {
  conic_gaussian_entry *entries; /* in the order of compositing */
  size_t n;
  conic_gaussian_bound bound;
  int has_ended;   /* compositing ended before the last of them */
  int has_surface; /* there is a surface at the pixel, which takes the light that is left: */
  double surface_z, surface_weight, surface_color[3]; /* its colour as Gaussians have theirs */
  uint32_t surface_id, reserved_int;
  uint64_t reserved[4];
} conic_gaussian_listing;

/* Lists every Gaussian that reaches the pixel of a picture of one sample a pixel, among the given surfaces (null: there
 * are none). On success the caller owns *listing. Errors: as conic_gaussian_bound_pixels. */
CONIC_API conic_status conic_gaussian_explain(conic_context *context, const conic_gaussians *gaussians,
                                              const conic_camera *camera, const conic_gaussian_options *options,
                                              const conic_float_model *model, const conic_gaussian_surfaces *surfaces,
                                              int x, int y, conic_gaussian_listing *listing);
CONIC_API void conic_gaussian_listing_release(conic_context *context, conic_gaussian_listing *listing);

CONIC_END_C
#endif
