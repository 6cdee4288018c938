/* Which mistake explains a picture: docs/reference/diagnosis.md. */
#include "conic/diagnosis.h"
#include "core/base/message.h"

const char *conic_diagnosis_meaning(const char *name) {
  (void)name;
  return NULL;
}

conic_status conic_gaussian_diagnose(conic_context *context, const conic_gaussians *gaussians,
                                     const conic_camera *camera, const conic_gaussian_options *options,
                                     const conic_gaussian_judging *judging, const conic_image *image,
                                     const uint8_t *classes, conic_diagnosis *found, int room, int *n_found) {
  (void)options;
  (void)judging;
  *n_found = 0;
  if (!gaussians || !camera || !image || !classes || !found || room < 0)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "diagnose: an argument is null");
  return CONIC_OK;
}

conic_status conic_drawing_diagnose(conic_context *context, const conic_drawing *drawing, const conic_camera *camera,
                                    const conic_render_options *options, int samples, const conic_image *image,
                                    const uint8_t *classes, conic_diagnosis *found, int room, int *n_found) {
  (void)options;
  (void)samples;
  *n_found = 0;
  if (!drawing || !camera || !image || !classes || !found || room < 0)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "diagnose: an argument is null");
  return CONIC_OK;
}
