/* The oracle: the reference of a picture, computed slowly and in double precision.
 *
 * It implements docs/reference/picture.md once more, from the equations, pixel by pixel over all splats, and shares no
 * code with the renderer; docs/reference/oracle.md says how it computes and how far it can be trusted. To measure a
 * renderer of splats, ask for the reference of a scene, then compare an image with it. */
#ifndef CONIC_ORACLE_H
#define CONIC_ORACLE_H

#include "conic/triangles.h"

CONIC_BEGIN_C

typedef enum conic_oracle_question {
  CONIC_ORACLE_METHOD = 0, /* is the arithmetic right? The method's own formula, in double */
  CONIC_ORACLE_EXACT = 1   /* is the method right? The kernel, projected exactly, convolved with the pixel's filter */
} conic_oracle_question;

/* "method", "exact"; null for a number that is no question. */
CONIC_API const char *conic_oracle_question_name(conic_oracle_question question);

/* Why a pixel is unstable: a decision there is so close that a renderer in single precision may take it either way. The
 * pixel may then hold any of several alternatives. */
typedef enum conic_unstable_reason {
  CONIC_UNSTABLE_CUTOFF = 0,     /* whether a splat's footprint covers the pixel */
  CONIC_UNSTABLE_CLIP = 1,       /* whether the ray formula's range of depths, its box or a clip line covers it */
  CONIC_UNSTABLE_VISIBILITY = 2, /* whether a splat lies behind another */
  CONIC_UNSTABLE_FORMULA = 3,    /* which formula draws a splat, or whether it is drawn at all */
  CONIC_UNSTABLE_FACING = 4,     /* to which side a splat's normal points */
  CONIC_UNSTABLE_WEIGHT_TIE = 5, /* which splat is the heaviest, where that changes Z */
  CONIC_UNSTABLE_DEPTH_TIE = 6,  /* which splat is the nearest, where passes = 1 lets it win the pixel */
  CONIC_UNSTABLE_PRECISION = 7   /* no decision: single precision cannot hold the value to the bound */
} conic_unstable_reason;

#define CONIC_N_UNSTABLE_REASONS 8
#define CONIC_MAX_UNSTABLE_REASONS 16

/* "cutoff", "clip" …; null for a number that is no reason. */
CONIC_API const char *conic_unstable_reason_name(conic_unstable_reason reason);

/* How the method's weights differ from the exact ones, over all pairs of a splat and a pixel that it covers and where
 * it is visible. The percentiles are good to 6 %. */
typedef struct conic_weight_error {
  double max_abs, p999;             /* of the weights of unit-peak kernels, opacity left out */
  double max_of_peak, p999_of_peak; /* relative to the splat's peak, the amplitude at its centre */
  double quadrature;                /* the largest change in the last refinement of the integrals */
  size_t n_weights;
} conic_weight_error;

/* Stands for all ids, where too many are admissible to list them. */
#define CONIC_ANY_ID 0xFFFFFFFEu

/* The range that an unstable pixel's planes may have together, if its decisions fall in one way: the least and the
 * greatest value of each channel of rgba, Z, N, albedo, weight and count, one after another. */
#define CONIC_N_ALTERNATIVE_VALUES 13
typedef struct conic_alternative {
  uint32_t pixel, number; /* the pixel's place in the reference's planes; number among the pixel's alternatives */
  double low[CONIC_N_ALTERNATIVE_VALUES], high[CONIC_N_ALTERNATIVE_VALUES];
} conic_alternative;

/* An id that is as good as the reference's: of a splat that is equally near up to rounding, or CONIC_ANY_ID. */
typedef struct conic_admissible_id {
  uint32_t pixel, id;
} conic_admissible_id;

typedef struct conic_reference {
  int width, height;
  conic_oracle_question question;
  double *planes[CONIC_MAX_PLANES]; /* laid out like an image's planes; count and id are whole numbers */
  uint8_t *unstable;                /* a pixel's reasons, as bits 1 << conic_unstable_reason; 0: stable */
  uint32_t *pixels;                 /* null; or, where only some pixels are judged, their numbers in ascending order:
                                       planes and `unstable` hold these pixels alone, one after another */
  double white;                     /* 2^exposure, the factor of rgba */
  size_t covered_pixels, unstable_pixels;
  int samples;                              /* N × N a pixel; what follows counts samples */
  size_t covered_samples, unstable_samples; /* as covered_pixels and unstable_pixels where N is 1 */
  size_t undecided_ids;                     /* pixels with CONIC_ANY_ID: their ids are not compared */
  size_t unstable_by_reason[CONIC_MAX_UNSTABLE_REASONS];
  conic_weight_error weight_error; /* for the exact question; else zero */
  size_t n_pixels;                 /* the judged pixels */
  size_t unbounded_pixels;         /* unstable pixels whose alternatives do not bound them */
  conic_alternative *alternatives; /* of all unstable pixels, pixel by pixel; none for the exact question */
  size_t n_alternatives;
  conic_admissible_id *ids; /* other admissible ids than the plane's, pixel by pixel; for unstable pixels, all */
  size_t n_ids;
  uint64_t reserved[2];
} conic_reference;

/* Computes the reference picture of `splats` (with tangent axes). `options` as for conic_render, without `tile` and
 * `isa`. splat_length is found where it is 0; give that of all splats where `splats` are some of them. All planes are
 * there. On success the caller owns *reference; on failure it is empty. Takes microseconds per splat and pixel for the
 * method's question, some hundred times that for the exact one; reports progress as "verify". The result is the same
 * for any number of threads. Errors: ARGUMENT, MEMORY, CANCELLED. */
CONIC_API conic_status conic_oracle_render(conic_context *context, const conic_splats *splats,
                                           const conic_camera *camera, const conic_render_options *options,
                                           conic_oracle_question question, conic_reference *reference);

/* conic_oracle_render with samples × samples samples a pixel (docs/reference/picture.md), 1 to 16. A pixel is as
 * unstable as its samples together. */
CONIC_API conic_status conic_oracle_render_samples(conic_context *context, const conic_splats *splats,
                                                   const conic_camera *camera, const conic_render_options *options,
                                                   conic_oracle_question question, int samples,
                                                   conic_reference *reference);

/* conic_oracle_render_samples for splats and triangles. Textures are filtered by conic_texture_sample, which is not in
 * question. Errors also: INPUT (conic_triangles_check). */
CONIC_API conic_status conic_oracle_render_drawing(conic_context *context, const conic_drawing *drawing,
                                                   const conic_camera *camera, const conic_render_options *options,
                                                   conic_oracle_question question, int samples,
                                                   conic_reference *reference);

/* conic_oracle_render_drawing for `n_pixels` of the picture's pixels, as docs/reference/oracle.md chooses them; 0: for
 * all. */
CONIC_API conic_status conic_oracle_render_pixels(conic_context *context, const conic_drawing *drawing,
                                                  const conic_camera *camera, const conic_render_options *options,
                                                  conic_oracle_question question, int samples, size_t n_pixels,
                                                  conic_reference *reference);

/* What is known of the floats of the program that drew. */
typedef enum conic_float_kind {
  CONIC_FLOATS_OWN = 0,    /* conic's: set up in double, rounded to float, then as picture.md or gaussians.md has it */
  CONIC_FLOATS_STRICT = 1, /* all in float, in any order, products fused or not, eˣ to 2 ulp */
  CONIC_FLOATS_FAST = 2    /* as STRICT, with the eˣ of a GPU's fast mathematics */
} conic_float_kind;

#define CONIC_N_FLOAT_KINDS 3

typedef struct conic_oracle_asking {
  size_t size; /* sizeof(conic_oracle_asking), set by the init function */
  conic_oracle_question question;
  int samples;             /* N × N a pixel */
  size_t n_pixels;         /* 0: all */
  conic_float_kind floats; /* of the renderer whose picture will be compared */
} conic_oracle_asking;

/* The method's question, one sample, all pixels, conic's own floats. */
CONIC_API void conic_oracle_asking_init_sized(conic_oracle_asking *asking, size_t size);
#define conic_oracle_asking_init(asking) conic_oracle_asking_init_sized(asking, sizeof *(asking))

/* conic_oracle_render_drawing as `asking` says; null is the default. */
CONIC_API conic_status conic_oracle_render_asked(conic_context *context, const conic_drawing *drawing,
                                                 const conic_camera *camera, const conic_render_options *options,
                                                 const conic_oracle_asking *asking, conic_reference *reference);

/* Makes the reference one of the picture under eye-dome lighting of that strength (conic/lighting.h), as the picture's
 * own plane Z gives it. Errors: ARGUMENT (no Z, or another size). */
CONIC_API conic_status conic_oracle_eye_dome(conic_context *context, const conic_camera *camera, double stops,
                                             const conic_image *image, conic_reference *reference);

/* The widest range of a channel of the plane among the alternatives, measured as in conic_oracle_plane_verdict; 0 for
 * id, and where there are none. */
CONIC_API double conic_reference_width(const conic_reference *reference, conic_plane plane);

CONIC_API void conic_reference_release(conic_context *context, conic_reference *reference);

/* Adds the picture `sample`, of the same size and pixels, to `mean`, the mean of `n_before` pictures; with n_before 0,
 * `mean` is overwritten. The mean holds rgba, albedo and weight; do not compare other planes with it. Each pixel has
 * one alternative: from the mean of the least values that the samples may have to the mean of the greatest. A pixel is
 * as unstable as its samples together, and the mean has as many unbounded pixels as its worst sample. Errors: ARGUMENT
 * (also another question than the method's), MEMORY; after MEMORY, `mean` is empty. */
CONIC_API conic_status conic_reference_average(conic_context *context, const conic_reference *sample, uint64_t n_before,
                                               conic_reference *mean);

/* How an image compares with a reference. */
typedef struct conic_oracle_plane_verdict {
  int is_compared;      /* the image has the plane */
  double max_abs, p999; /* of Z relative; of rgba (before its exposure), albedo and weight relative above 1. An unstable
                           pixel differs by its distance from the alternative that fits it best. The percentile is over
                           covered, stable pixels. NaN counts as infinite */
  double bound;         /* the most that max_abs may be; NaN where there is no bound */
} conic_oracle_plane_verdict;

/* The most wrong pixel: where, in which plane and channel, and what its value may be. */
typedef struct conic_oracle_fault {
  int x, y, plane, channel;
  double found, low, high;
} conic_oracle_fault;

typedef struct conic_oracle_verdict {
  conic_oracle_plane_verdict planes[CONIC_MAX_PLANES];
  size_t compared_pixels, unstable_pixels, covered_pixels; /* compared: those with one value, as stable pixels have */
  double unbounded_limit;                                  /* share of the judged pixels that may be unbounded */
  int pass;                                                /* every bound and the limit are kept */
  size_t wrong_pixels;                                     /* pixels outside of the bounds */
  conic_oracle_fault worst;                                /* where there are wrong pixels */
  uint64_t reserved[2];
} conic_oracle_verdict;

/* Compares `image`, of the reference's size, with it. For the method's question it is held against the bounds of
 * docs/reference/oracle.md. The exact question has no bounds: everything passes, and unstable pixels are left out.
 * Errors: ARGUMENT, MEMORY. */
CONIC_API conic_status conic_oracle_compare(conic_context *context, const conic_reference *reference,
                                            const conic_image *image, conic_oracle_verdict *verdict);

/* The verdict on a pixel. */
typedef enum conic_pixel_class {
  CONIC_PIXEL_EQUAL = 0,     /* each value is the float next to the double */
  CONIC_PIXEL_ROUNDED = 1,   /* within the bounds of rounding */
  CONIC_PIXEL_EXPLAINED = 2, /* decisions in doubt went another way */
  CONIC_PIXEL_WRONG = 3
} conic_pixel_class;

#define CONIC_N_PIXEL_CLASSES 4

/* "equal", "rounded" …; null for a number that is none. */
CONIC_API const char *conic_pixel_class_name(conic_pixel_class number);

#define CONIC_MAX_FAULTS 8

typedef struct conic_oracle_judging {
  size_t size;                 /* sizeof(conic_oracle_judging), set by the init function */
  const conic_image *greatest; /* null; or the image holds the least values that its codes stand for, and this holds the
                                  greatest, plane by plane (conic/picture.h) */
} conic_oracle_judging;

/* The values are exact. */
CONIC_API void conic_oracle_judging_init_sized(conic_oracle_judging *judging, size_t size);
#define conic_oracle_judging_init(judging) conic_oracle_judging_init_sized(judging, sizeof *(judging))

typedef struct conic_oracle_judgement {
  conic_oracle_verdict verdict;
  size_t pixels[CONIC_N_PIXEL_CLASSES];            /* by class */
  size_t explained_by[CONIC_MAX_UNSTABLE_REASONS]; /* of the explained pixels; a pixel may have several reasons */
  conic_oracle_fault worst[CONIC_MAX_FAULTS];      /* the most wrong pixels, the worst first */
  int n_worst;
  uint64_t reserved[4];
} conic_oracle_judgement;

/* Judges an image as conic_oracle_compare does, against the reference of the method's question. `classes`, of the
 * picture's size, takes each judged pixel's class, and may be null. Null `judging` is the default. Errors: ARGUMENT,
 * MEMORY. */
CONIC_API conic_status conic_oracle_judge(conic_context *context, const conic_reference *reference,
                                          const conic_oracle_judging *judging, const conic_image *image,
                                          uint8_t *classes, conic_oracle_judgement *judgement);

/* One splat in camera space, alone and not rounded to float in between: its centre and axes. */
typedef struct conic_oracle_splat {
  double center[3], tangent_u[3], tangent_v[3];
} conic_oracle_splat;

/* What the method's bare formula and the exact kernel give for a splat at a place of the screen. */
typedef struct conic_oracle_sample {
  int covers;           /* q is below the support, and the formula's other conditions hold */
  double q;             /* the formula's squared distance in standard deviations */
  double weight, exact; /* of the unit-peak kernel; 0 where it is below any bound */
  double inverse_depth, plane_inverse_depth;
  double quadrature; /* the last change of `exact` under refinement */
} conic_oracle_sample;

/* Evaluates the formula of options->method at `n` places (x, y) of the camera's picture, in pixels. Of the options, the
 * method, the kernel, the prefilter and near_z count. Errors: ARGUMENT (also a splat that reaches near_z, which has no
 * footprint on the screen, and one without a plane). */
CONIC_API conic_status conic_oracle_probe(conic_context *context, const conic_oracle_splat *splat,
                                          const conic_camera *camera, const conic_render_options *options,
                                          const double (*places)[2], size_t n, conic_oracle_sample *samples);

CONIC_END_C
#endif
