/* Finds the mistake that explains a picture: docs/reference/diagnosis.md. */
#include <string.h>

#include "core/base/message.h"
#include "core/base/options.h"
#include "gaussians/scene/gaussian_set.h"
#include "judge/planted_gaussians.h"
#include "judge/planted_surfels.h"
#include "judge/trials.h"

typedef struct gaussian_world {
  conic_context *context;
  const conic_gaussians *gaussians;
  int samples;
} gaussian_world;

static conic_status draw_gaussian_world(void *data, const conic_planted *planted,
                                        const conic_diagnosis_samples *samples, conic_channels *values) {
  const gaussian_world *w = data;
  return conic_planted_gaussians_draw(w->context, w->gaussians, planted, w->samples, samples, values);
}

/* The camera for `samples` × `samples` samples a pixel. */
static conic_camera fine_camera_of(const conic_camera *camera, int samples) {
  conic_camera fine = *camera;
  const double n = samples;
  fine.width *= samples;
  fine.height *= samples;
  fine.fx *= n;
  fine.fy *= n;
  fine.cx *= n;
  fine.cy *= n;
  return fine;
}

static conic_planted right_gaussians(const conic_gaussians *gaussians, const conic_camera *camera,
                                     const conic_gaussian_options *options, const conic_gaussian_judging *judging) {
  conic_planted right = {.profile = options->profile,
                         .rules = *conic_gaussian_rules_of(options->profile),
                         .prefilter = options->prefilter,
                         .most_degree = gaussians->sh_degree,
                         .is_opaque = judging->is_opaque,
                         .axes = 1.0};
  right.camera = fine_camera_of(camera, judging->samples);
  if (right.rules.takes_middle) {
    right.camera.cx = 0.5 * right.camera.width;
    right.camera.cy = 0.5 * right.camera.height;
  }
  memcpy(right.behind, options->background, sizeof right.behind);
  return right;
}

static conic_status check_diagnosis(conic_context *context, const conic_camera *camera, const conic_image *image,
                                    const uint8_t *classes, const conic_diagnosis *found, int room, int samples) {
  if (!camera || !image || !classes || !found || room < 0)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "diagnose: an argument is null");
  if (image->width != camera->width || image->height != camera->height || camera->width < 1 || camera->height < 1)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "diagnose: the image is not of the camera's size");
  if (samples < 1 || samples > CONIC_MAX_SAMPLES || camera->width > 65535 / samples || camera->height > 65535 / samples)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "diagnose: there are 1 to %d samples", CONIC_MAX_SAMPLES);
  return CONIC_OK;
}

/* As many cells as take about the time of the usual number with one sample a pixel. */
static size_t cells_of(int samples) {
  size_t n = CONIC_MOST_CELLS / ((size_t)samples * (size_t)samples);
  return n > 8 ? n : 8;
}

static conic_status run_trials(conic_trials *trials, const conic_image *image, const conic_image *greatest,
                               const uint8_t *classes, int n_fine, conic_diagnosis *found, int room, int *n_found) {
  conic_diagnosis_samples samples;
  conic_status status =
      conic_diagnosis_samples_choose(trials->context, image, greatest, classes, cells_of(n_fine), &samples);
  trials->samples = &samples;
  if (status == CONIC_OK && samples.n)
    status = conic_trials_run(trials, found, room, n_found);
  conic_diagnosis_samples_release(&samples);
  return status;
}

conic_status conic_gaussian_diagnose(conic_context *context, const conic_gaussians *gaussians,
                                     const conic_camera *camera, const conic_gaussian_options *options,
                                     const conic_gaussian_judging *judging, const conic_image *image,
                                     const uint8_t *classes, conic_diagnosis *found, int room, int *n_found) {
  conic_gaussian_options own;
  conic_gaussian_judging how;
  conic_gaussian_options_init(&own);
  conic_gaussian_judging_init(&how);
  *n_found = 0;
  if (!gaussians || (options && !conic_options_take(&own, options)) ||
      (judging && !conic_options_take(&how, judging)) || !conic_gaussian_rules_of(own.profile))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "diagnose: an argument is null, or there is no such profile");
  conic_status status = conic_gaussians_check(context, gaussians, "diagnose");
  if (status == CONIC_OK)
    status = check_diagnosis(context, camera, image, classes, found, room, how.samples);
  if (status != CONIC_OK)
    return status;
  gaussian_world world = {context, gaussians, how.samples};
  const conic_planted right = right_gaussians(gaussians, camera, &own, &how);
  conic_trials trials = {.context = context, .right = &right, .draw = draw_gaussian_world, .world = &world};
  trials.n_suspects = conic_suspects_of_gaussians(&right, trials.suspects);
  return run_trials(&trials, image, how.greatest, classes, how.samples, found, room, n_found);
}

conic_status conic_drawing_diagnose(conic_context *context, const conic_drawing *drawing, const conic_camera *camera,
                                    const conic_render_options *options, int samples,
                                    const conic_oracle_judging *judging, const conic_image *image,
                                    const uint8_t *classes, conic_diagnosis *found, int room, int *n_found) {
  conic_planted_drawing world;
  conic_planted right = {.axes = 1.0, .is_of_surfels = 1};
  conic_oracle_judging how;
  conic_render_options_init(&right.options);
  conic_oracle_judging_init(&how);
  *n_found = 0;
  if (!drawing || (options && !conic_options_take(&right.options, options)) ||
      (judging && !conic_options_take(&how, judging)))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "diagnose: an argument is null");
  conic_status status = check_diagnosis(context, camera, image, classes, found, room, samples);
  if (status != CONIC_OK)
    return status;
  right.camera = *camera;
  status = conic_planted_drawing_begin(context, drawing, &right, samples, image, &world);
  conic_trials trials = {.context = context, .right = &right, .draw = conic_planted_drawing_draw, .world = &world};
  trials.n_suspects = conic_suspects_of_surfels(&right, trials.suspects);
  if (status == CONIC_OK)
    status = run_trials(&trials, image, how.greatest, classes, 1, found, room, n_found);
  conic_planted_drawing_end(&world);
  return status;
}
