/* The reference of a picture of a Gaussian scene: computed slowly, in double precision, from all Gaussians at every
 * pixel. It implements docs/reference/gaussians.md once more and shares no code with the renderer. */
#ifndef CONIC_GAUSSIAN_ORACLE_H
#define CONIC_GAUSSIAN_ORACLE_H

#include "conic/gaussian_render.h"

CONIC_BEGIN_C

typedef enum conic_gaussian_question {
  CONIC_GAUSSIAN_PROFILE = 0, /* is the arithmetic right? The profile's own formulas, in double */
  CONIC_GAUSSIAN_OVERLAP = 1, /* is the profile right? Each Gaussian's optical depth at the pixel is spread along the
                                 ray as its density is; emission and absorption are integrated */
  CONIC_GAUSSIAN_VOLUME = 2   /* like OVERLAP, with densities in space: a ray through the centre of a ball of the same
                                 volume meets the Gaussian's opacity */
} conic_gaussian_question;

typedef struct conic_gaussian_reference {
  int width, height;
  double *rgb;          /* 3 a pixel, over the background */
  double *transparency; /* T, what is left of the light from behind */
  double *z;            /* Σ w·z / Σ w; 0 where no Gaussian is */
  double *median_z;     /* of the Gaussian at which T falls to ½; 0 where it stays above */
  double *inverse_z;    /* Σ w/z */
  double *normal;       /* 3 a pixel: Σ w·n in the world, not normalised */
  uint32_t *count;      /* Gaussians composited */
  uint32_t *id;         /* the Gaussian with the largest w, the first of equal ones; CONIC_NO_ID where none is */
  uint32_t *last;       /* the last one composited */
  double quadrature;    /* the largest change of rgb in the last halving of the steps; 0 for the profile's question */
  uint64_t reserved[8];
} conic_gaussian_reference;

/* Computes the reference. For OVERLAP and VOLUME only rgb, T, count and id are filled. On success the caller owns
 * *reference; on failure it is empty. Reports progress as "verify". The result is the same for any number of threads.
 * Errors: ARGUMENT, MEMORY, CANCELLED. */
CONIC_API conic_status conic_gaussian_oracle_render(conic_context *context, const conic_gaussians *gaussians,
                                                    const conic_camera *camera, const conic_gaussian_options *options,
                                                    conic_gaussian_question question,
                                                    conic_gaussian_reference *reference);

CONIC_API void conic_gaussian_reference_release(conic_context *context, conic_gaussian_reference *reference);

CONIC_END_C
#endif
