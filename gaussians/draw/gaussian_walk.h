/* A picture of Gaussians with all that each pixel is composited of, band by band. */
#pragma once

#include "gaussians/draw/gaussian_parts.h"

typedef struct conic_gaussian_walk {
  conic_context *context;
  conic_gaussian_picture *picture;
  const conic_image *surfaces; /* of the picture's size, behind the Gaussians; null: there are none */
  int width, height;
  uint32_t *counts;      /* of Gaussians, by pixel */
  uint64_t n_all;        /* their sum */
  int first_row, n_rows; /* of the band */
  conic_gaussian_steps steps;
  size_t room;
} conic_gaussian_walk;

/* Takes a band of the walk, whose rows follow those of the band before. */
typedef conic_status conic_gaussian_band_taker(void *cookie, const conic_gaussian_walk *walk);

/* Counts what there is at each pixel. Surfaces have rgba, Z and id. The caller releases *walk, after a failure, too.
 * Errors: as conic_gaussians_render. */
conic_status conic_gaussian_walk_begin(conic_context *context, const conic_gaussians *gaussians,
                                       const conic_camera *camera, const conic_gaussian_options *options,
                                       const conic_image *surfaces, conic_gaussian_walk *walk);
/* Composites all bands once more, from the first to the last. Errors: as above, and the taker's. */
conic_status conic_gaussian_walk_run(conic_gaussian_walk *walk, conic_gaussian_band_taker *take, void *cookie);
void conic_gaussian_walk_release(conic_gaussian_walk *walk);

/* What a pixel of the band is composited of, in that order. */
static inline const conic_gaussian_step *conic_gaussian_walk_at(const conic_gaussian_walk *walk, size_t pixel,
                                                                uint32_t *n) {
  *n = walk->counts[pixel];
  return &walk->steps.steps[walk->steps.next[pixel - (size_t)walk->first_row * (size_t)walk->width] - *n];
}
