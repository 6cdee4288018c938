/* Surface splats and triangles with a mistake, drawn by the renderer. */
#ifndef CONIC_PLANTED_SURFELS_H
#define CONIC_PLANTED_SURFELS_H

#include "judge/diagnosis_samples.h"

typedef struct conic_planted_drawing {
  conic_context *context;
  conic_drawing drawing;
  conic_renderer *renderer;
  conic_image image, matt; /* matt: without highlights; empty where there are none */
  int samples;
} conic_planted_drawing;

/* Begins drawing the planes of `image`. Moves the background from the right options to `behind`. The caller ends
 * *drawing, on failure too. Errors: MEMORY. */
conic_status conic_planted_drawing_begin(conic_context *context, const conic_drawing *drawing, conic_planted *right,
                                         int samples, const conic_image *image, conic_planted_drawing *world);
void conic_planted_drawing_end(conic_planted_drawing *world);

/* The conic_planted_drawer of a conic_planted_drawing. Errors: as conic_render_drawing. */
conic_status conic_planted_drawing_draw(void *world, const conic_planted *planted,
                                        const conic_diagnosis_samples *samples, conic_channels *values);

#endif
