/* What a renderer of Gaussian scenes has of each Gaussian before it composites, with the range that floats may give:
 * means on the screen, conics, radii, colours, and which tiles list it. Names and layouts are gsplat's. */
#ifndef CONIC_GAUSSIAN_INTERMEDIATES_H
#define CONIC_GAUSSIAN_INTERMEDIATES_H

#include "conic/gaussian_judge.h"

CONIC_BEGIN_C

/* The arrays that have a row for each Gaussian. */
typedef enum conic_intermediate {
  CONIC_INTERMEDIATE_RADII = 0,           /* 2, whole pixels; 0: the Gaussian is left out, and has nothing else */
  CONIC_INTERMEDIATE_MEANS2D = 1,         /* 2, in pixels; the first pixel's centre is at ½, ½ */
  CONIC_INTERMEDIATE_DEPTHS = 2,          /* z of the mean */
  CONIC_INTERMEDIATE_COVARS2D = 3,        /* 3: xx, xy and yy, in square pixels, dilated */
  CONIC_INTERMEDIATE_CONICS = 4,          /* 3: the inverse of that */
  CONIC_INTERMEDIATE_TILE_BOXES = 5,      /* 4: the first tile in x and y, and the first behind */
  CONIC_INTERMEDIATE_TILES_PER_GAUSS = 6, /* how many tiles list it */
  CONIC_INTERMEDIATE_OPACITIES = 7,       /* compensated */
  CONIC_INTERMEDIATE_COLORS = 8,          /* 3, as seen from the eye */
  CONIC_INTERMEDIATE_TRANSMITTANCES = 9   /* T before it at the pixel of its mean; NaN where it is not composited */
} conic_intermediate;

#define CONIC_N_INTERMEDIATES 10

/* "radii", "means2d" …; null for a number that is none. */
CONIC_API const char *conic_intermediate_name(conic_intermediate number);

typedef struct conic_intermediate_array {
  double *value, *low, *high; /* in double, and the range of floats; null: the profile has none */
  int n_columns;
} conic_intermediate_array;

/* A Gaussian that is left out has zeros for values, and any value is in its ranges but for radii and tiles. */
typedef struct conic_gaussian_intermediates {
  size_t count;
  conic_intermediate_array arrays[CONIC_N_INTERMEDIATES];
  int tile_width, tile_height; /* tiles of 16 × 16 pixels; 0: the profile has none */
  size_t n_isects;             /* entries of tiles' lists, by the values in double, in their order: */
  int64_t *isect_ids;          /* the tile's number << 32 | the depth's bits as a float */
  int64_t *flatten_ids;        /* the Gaussian */
  int64_t *isect_offsets;      /* where each tile's entries begin */
  uint64_t reserved[4];
} conic_gaussian_intermediates;

/* Finds them for the profile of `options`. Null `model` is that of a GPU's fast mathematics. On success the caller owns
 * *found; on failure it is empty. Reports progress as "project" and "transmittances". Errors: ARGUMENT, MEMORY,
 * CANCELLED. */
CONIC_API conic_status conic_gaussian_intermediates_find(conic_context *context, const conic_gaussians *gaussians,
                                                         const conic_camera *camera,
                                                         const conic_gaussian_options *options,
                                                         const conic_float_model *model,
                                                         conic_gaussian_intermediates *found);
CONIC_API void conic_gaussian_intermediates_release(conic_context *context, conic_gaussian_intermediates *found);

/* Writes an .npz with all of them, ranges as NAME_low and NAME_high; or, if the name ends in .csv, a line for each
 * Gaussian. Errors: MEMORY, IO. */
CONIC_API conic_status conic_gaussian_intermediates_write(conic_context *context, const char *path,
                                                          const conic_gaussian_intermediates *found);

/* The steps of a renderer, in their order. */
typedef enum conic_gaussian_stage {
  CONIC_GAUSSIAN_STAGE_PROJECTION = 0,
  CONIC_GAUSSIAN_STAGE_SORT = 1,
  CONIC_GAUSSIAN_STAGE_ALPHA = 2,
  CONIC_GAUSSIAN_STAGE_COLOR = 3,
  CONIC_GAUSSIAN_STAGE_BLENDING = 4
} conic_gaussian_stage;

#define CONIC_N_GAUSSIAN_STAGES 5

/* "projection", "sort" …; null for a number that is none. */
CONIC_API const char *conic_gaussian_stage_name(conic_gaussian_stage stage);

#define CONIC_MAX_JUDGED_ARRAYS 16

/* One array of theirs, and its number that is farthest outside of its range. */
typedef struct conic_judged_array {
  const char *name;
  conic_gaussian_stage stage;
  size_t judged, wrong; /* Gaussians; entries of lists; pixels */
  size_t row;           /* the Gaussian, the entry or the pixel y · width + x */
  int column;
  uint32_t gaussian; /* CONIC_NO_ID: it is of none */
  double found, value, low, high;
  const char *what; /* what is wrong with it that no range tells; null: nothing */
} conic_judged_array;

typedef struct conic_intermediates_verdict {
  conic_judged_array arrays[CONIC_MAX_JUDGED_ARRAYS]; /* those that are there, by stages */
  int n_arrays;
  uint64_t reserved[4];
} conic_intermediates_verdict;

/* Judges an .npz with arrays of another program by their names: those above; flatten_ids and isect_ids, which go
 * together, isect_offsets, gaussian_ids (which Gaussian a row is of); and, of the picture's size, colors or
 * render_colors, and alphas or render_alphas. A first axis of length 1 is left aside. Of a Gaussian that is left out,
 * and without radii of any that may be, nothing is judged. Errors: as conic_gaussian_intermediates_find; INPUT. */
CONIC_API conic_status conic_gaussian_intermediates_judge(conic_context *context, const conic_gaussians *gaussians,
                                                          const conic_camera *camera,
                                                          const conic_gaussian_options *options,
                                                          const conic_float_model *model, const char *path,
                                                          conic_intermediates_verdict *verdict);

CONIC_END_C
#endif
