/* Why a picture is wrong: which mistake of a renderer, or which other profile, takes its differences away.
 * docs/reference/diagnosis.md says what each name means. */
#ifndef CONIC_DIAGNOSIS_H
#define CONIC_DIAGNOSIS_H

#include "conic/gaussian_judge.h"
#include "conic/triangles.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct conic_diagnosis {
  const char *name; /* of a mistake, "half-pixel" …, or of a profile; static */
  const char *with; /* the other one, where two together explain the picture; else null */
  double share;     /* of the difference, which it takes away: 1 where nothing is left */
  uint64_t reserved[2];
} conic_diagnosis;

#define CONIC_MOST_DIAGNOSES 16

/* Looks at the wrong pixels of a picture, as conic_gaussian_judge found them by the same arguments: `classes` has the
 * picture's size, what is above CONIC_PIXEL_WRONG was not judged. `found` takes at most `room` explanations, the best
 * first, and *n_found how many there are: none where no pixel is wrong, or where nothing explains the picture. Of two
 * that explain it together, each is there once, one after the other. Reports progress as "diagnose". Errors: ARGUMENT,
 * MEMORY, CANCELLED. */
CONIC_API conic_status conic_gaussian_diagnose(conic_context *context, const conic_gaussians *gaussians,
                                               const conic_camera *camera, const conic_gaussian_options *options,
                                               const conic_gaussian_judging *judging, const conic_image *image,
                                               const uint8_t *classes, conic_diagnosis *found, int room, int *n_found);

/* The same of surface splats and triangles, with samples × samples samples a pixel, as conic_oracle_judge found the
 * wrong pixels; `options` as for conic_render. */
CONIC_API conic_status conic_drawing_diagnose(conic_context *context, const conic_drawing *drawing,
                                              const conic_camera *camera, const conic_render_options *options,
                                              int samples, const conic_oracle_judging *judging,
                                              const conic_image *image, const uint8_t *classes, conic_diagnosis *found,
                                              int room, int *n_found);

/* What a name stands for, in a sentence: "Pixel centres are half a pixel off." Static; null for what is no name. */
CONIC_API const char *conic_diagnosis_meaning(const char *name);

#ifdef __cplusplus
}
#endif
#endif
