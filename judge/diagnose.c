/* Finds the mistake that explains a picture: docs/reference/diagnosis.md. */

#include "core/base/color.h"
#include "gaussians/scene/gaussian_set.h"
#include "judge/diagnosis_samples.h"
#include "oracle/gaussians/oracle_surface.h"

/* --- pictures of surfels --- */

typedef struct surfels_drawing {
  conic_context *context;
  conic_drawing drawing;
  conic_renderer *renderer;
  conic_image image, matt; /* matt: without highlights; empty where there are none */
  int samples;
} surfels_drawing;

/* Begins drawing the planes of `image`. Moves the background from the right options to `behind`. The caller ends
 * *drawing, on failure too. Errors: MEMORY. */
static conic_status planted_drawing_begin(conic_context *context, const conic_drawing *drawing, conic_planted *right,
                                          int samples, const conic_image *image, surfels_drawing *w) {
  const unsigned planes = (conic_image_planes(image) & CONIC_DRAWN_PLANES) | 1u << CONIC_PLANE_RGBA |
                          1u << CONIC_PLANE_ALBEDO | 1u << CONIC_PLANE_WEIGHT;
  const float white = conic_exposure_factor(right->options.exposure);
  memset(w, 0, sizeof *w);
  w->context = context;
  w->drawing = *drawing;
  w->samples = samples;
  right->is_opaque = right->options.has_background;
  for (int c = 0; c < 3 && right->options.has_background; c++)
    right->behind[c] = white * right->options.background[c];
  right->options.has_background = 0;
  if (!(right->options.near_z > 0.0))
    right->options.near_z = conic_drawing_near(drawing);
  conic_status status = conic_renderer_create(context, &w->renderer);
  if (status == CONIC_OK)
    status = conic_image_allocate(context, image->width, image->height, planes, &w->image);
  if (status == CONIC_OK && right->options.shading == CONIC_SHADE_PHONG)
    status = conic_image_allocate(context, image->width, image->height, 1u << CONIC_PLANE_RGBA, &w->matt);
  return status;
}

static void planted_drawing_end(surfels_drawing *w) {
  conic_image_release(w->context, &w->image);
  conic_image_release(w->context, &w->matt);
  if (w->renderer)
    conic_renderer_destroy(w->renderer);
}

/* Multiplies the axes by a factor, in arrays of their own. Errors: MEMORY. */
static conic_status lengthen_axes(conic_context *context, double factor, conic_splats *splats, float **room) {
  const size_t n = splats->count;
  const size_t strides[2] = {splats->strides.tangent_u, splats->strides.tangent_v};
  *room = conic_memory_allocate(context, n, 6 * sizeof **room);
  if (!*room)
    return CONIC_ERROR_MEMORY;
  for (int k = 0; k < 6; k++) {
    float **axis = k < 3 ? &splats->tangent_u[k] : &splats->tangent_v[k - 3], *to = *room + (size_t)k * n;
    const size_t stride = strides[k / 3] ? strides[k / 3] / sizeof(float) : 1;
    for (size_t i = 0; i < n; i++)
      to[i] = (float)(factor * (double)(*axis)[i * stride]);
    *axis = to;
  }
  splats->strides.tangent_u = splats->strides.tangent_v = 0;
  return CONIC_OK;
}

static conic_status draw_both(surfels_drawing *w, const conic_planted *p, const conic_drawing *drawing) {
  conic_render_options options = p->options;
  conic_renderer_slip(w->renderer, p->slips);
  conic_status status =
      conic_render_drawing(w->context, w->renderer, drawing, &p->camera, &options, w->samples, &w->image, NULL);
  options.shading = CONIC_SHADE_LAMBERT;
  if (status == CONIC_OK && w->matt.planes[CONIC_PLANE_RGBA])
    status = conic_render_drawing(w->context, w->renderer, drawing, &p->camera, &options, w->samples, &w->matt, NULL);
  return status;
}

static void take_samples(const surfels_drawing *w, const conic_planted *p, const conic_diagnosis_samples *s,
                         conic_channels *values) {
  const float *matt = w->matt.planes[CONIC_PLANE_RGBA];
  for (size_t i = 0; i < s->n; i++) {
    size_t x = (size_t)(s->places[i][0] - p->moves[0] + s->width) % (size_t)s->width;
    size_t y = (size_t)(s->places[i][1] - p->moves[1] + s->height) % (size_t)s->height;
    x = p->mirrors[0] ? (size_t)s->width - 1 - x : x;
    y = p->mirrors[1] ? (size_t)s->height - 1 - y : y;
    const size_t pixel = y * (size_t)s->width + x;
    float *v = values[i];
    conic_channels_of_image(&w->image, pixel, v);
    v[CONIC_CHANNEL_T] = 1.0f - v[CONIC_CHANNEL_A];
    for (size_t c = 0; c < 3 && matt; c++) {
      v[CONIC_CHANNEL_GLOSS + c] = v[c] - matt[4 * pixel + c];
      v[c] = matt[4 * pixel + c];
    }
  }
}

/* The conic_planted_drawer of a surfels_drawing. Errors: as conic_render_drawing. */
static conic_status planted_drawing_draw(void *world, const conic_planted *p, const conic_diagnosis_samples *samples,
                                         conic_channels *values) {
  surfels_drawing *w = world;
  conic_drawing drawing = w->drawing;
  conic_splats splats;
  float *room = NULL;
  conic_status status = CONIC_OK;
  if (p->axes != 1.0 && drawing.splats && drawing.splats->tangent_u[0] && drawing.splats->tangent_v[0]) {
    splats = *drawing.splats;
    drawing.splats = &splats;
    status = lengthen_axes(w->context, p->axes, &splats, &room);
  }
  if (status == CONIC_OK)
    status = draw_both(w, p, &drawing);
  if (status == CONIC_OK)
    take_samples(w, p, samples, values);
  conic_memory_release(w->context, room);
  return status;
}

/* --- diagnoses --- */

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
                         .rules = *conic_profile_row_of(options->profile),
                         .prefilter = options->prefilter,
                         .most_degree = gaussians->sh_degree,
                         .n_whole = gaussians->count,
                         .is_opaque = judging->is_opaque,
                         .surfaces = judging->surfaces,
                         .size = 1.0f,
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

static conic_status run_trials(conic_trials *trials, const conic_judged_picture *picture, int n_fine,
                               conic_diagnosis *found, int room, int *n_found) {
  conic_diagnosis_samples samples;
  conic_status status = conic_diagnosis_samples_choose(trials->context, picture, cells_of(n_fine), &samples);
  trials->picture = picture;
  trials->samples = &samples;
  if (status == CONIC_OK && samples.n)
    status = conic_trials_run(trials, found, room, n_found);
  conic_diagnosis_samples_release(&samples);
  trials->samples = NULL;
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
      (judging && !conic_options_take(&how, judging)) || !conic_profile_row_of(own.profile))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "diagnose: an argument is null, or there is no such profile");
  conic_status status = conic_gaussians_check(context, gaussians, "diagnose");
  if (status == CONIC_OK)
    status = check_diagnosis(context, camera, image, classes, found, room, how.samples);
  if (status == CONIC_OK && how.surfaces &&
      !conic_oracle_surfaces_fit(how.surfaces, how.samples * image->width, how.samples * image->height,
                                 conic_image_planes(image)))
    status = conic_fail(context, CONIC_ERROR_ARGUMENT, "diagnose: the surfaces are not those of the picture's samples");
  if (status != CONIC_OK)
    return status;
  gaussian_world world = {context, gaussians, how.samples};
  const conic_planted right = right_gaussians(gaussians, camera, &own, &how);
  conic_trials trials = {.context = context, .right = &right, .draw = draw_gaussian_world, .world = &world};
  trials.n_suspects = conic_suspects_of_gaussians(&right, trials.suspects);
  return run_trials(&trials, &(conic_judged_picture){image, how.greatest, classes, how.ranges}, how.samples, found,
                    room, n_found);
}

conic_status conic_drawing_diagnose(conic_context *context, const conic_drawing *drawing, const conic_camera *camera,
                                    const conic_render_options *options, int samples,
                                    const conic_oracle_judging *judging, const conic_image *image,
                                    const uint8_t *classes, conic_diagnosis *found, int room, int *n_found) {
  surfels_drawing world;
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
  status = planted_drawing_begin(context, drawing, &right, samples, image, &world);
  conic_trials trials = {.context = context, .right = &right, .draw = planted_drawing_draw, .world = &world};
  trials.n_suspects = conic_suspects_of_surfels(&right, trials.suspects);
  if (status == CONIC_OK)
    status = run_trials(&trials, &(conic_judged_picture){image, how.greatest, classes, NULL}, 1, found, room, n_found);
  planted_drawing_end(&world);
  return status;
}
