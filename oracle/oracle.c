/* The oracle: pixel by pixel, in double precision. What is asked, and room for the answer. */

#include "core/image/view_arguments.h"
#include "core/splats/columns.h"
#include "oracle/oracle_blocks.h"

const char *conic_oracle_question_name(conic_oracle_question question) {
  static const char *const names[] = {"method", "exact"};
  return (unsigned)question < 2 ? names[question] : NULL;
}

CONIC_DEFINE_NAMES(conic_unstable_reason_name, conic_unstable_reason, CONIC_N_UNSTABLE_REASONS, "cutoff", "clip",
                   "visibility", "formula", "facing", "weight_tie", "depth_tie", "precision")

/* What a fixed, well mixed number is made of another: whatever the machine, the same pixels are judged. */
static uint64_t mix(uint64_t x) {
  x = (x + 0x9e3779b97f4a7c15u) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

void conic_oracle_choose_pixels(uint64_t whole, size_t n, uint32_t *pixels) {
  for (size_t i = 0; i < n; i++) {
    uint64_t begin = whole * i / n, end = whole * (i + 1) / n;
    pixels[i] = (uint32_t)(begin + mix(i) % (end - begin));
  }
}

static conic_status allocate(conic_context *context, size_t n_pixels, conic_reference *r) {
  size_t whole = (size_t)r->width * (size_t)r->height;
  r->n_pixels = n_pixels && n_pixels < whole ? n_pixels : whole;
  for (int i = 0; i < CONIC_N_PLANES; i++) {
    size_t n_channels = (size_t)conic_plane_describe((conic_plane)i)->n_channels;
    if (i < CONIC_N_DRAWN_PLANES)
      r->planes[i] = conic_memory_allocate_zeroed(context, r->n_pixels * n_channels, sizeof(double));
    if (i < CONIC_N_DRAWN_PLANES && !r->planes[i])
      return CONIC_ERROR_MEMORY;
  }
  r->unstable = conic_memory_allocate_zeroed(context, r->n_pixels, sizeof *r->unstable);
  if (r->n_pixels < whole) {
    r->pixels = conic_memory_allocate(context, r->n_pixels, sizeof *r->pixels);
    if (!r->pixels)
      return CONIC_ERROR_MEMORY;
    conic_oracle_choose_pixels(whole, r->n_pixels, r->pixels);
  }
  return r->unstable ? CONIC_OK : CONIC_ERROR_MEMORY;
}

static conic_status check(conic_context *context, const conic_splats *splats, const oracle_request *request) {
  if (splats->count && (!splats->tangent_u[0] || !splats->tangent_v[0]))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "the splats have no tangent axes");
  if (!conic_oracle_question_name(request->question))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "no question to the oracle has the number %d",
                      (int)request->question);
  return CONIC_OK;
}

/* The camera of a picture whose pixels are the samples. */
static conic_camera camera_of_samples(const conic_camera *camera, int samples) {
  conic_camera fine = *camera;
  fine.width *= samples;
  fine.height *= samples;
  fine.fx *= samples;
  fine.fy *= samples;
  fine.cx *= samples;
  fine.cy *= samples;
  return fine;
}

/* The picture of what was checked; near_z is found where it is 0. */
static conic_status answer_drawing(conic_context *context, const conic_drawing *drawing, const conic_camera *camera,
                                   conic_render_options *settled, const oracle_request *request,
                                   conic_reference *reference) {
  const conic_camera fine = camera_of_samples(camera, request->samples);
  oracle_scene scene;
  oracle_mesh mesh;
  if (!(settled->near_z > 0.0) && drawing->triangles)
    settled->near_z = conic_drawing_near(drawing);
  reference->width = camera->width;
  reference->height = camera->height;
  reference->question = request->question;
  reference->white = conic_oracle_exp(settled->exposure * 0.69314718055994530942);
  conic_status status = allocate(context, request->n_pixels, reference);
  if (status == CONIC_OK)
    status =
        conic_oracle_scene_create(context, drawing->splats, &fine, settled, request->floats, request->is_brute, &scene);
  if (status == CONIC_OK) {
    status = conic_oracle_mesh_create(context, drawing, &scene, settled, &mesh);
    if (status == CONIC_OK) {
      const oracle_job job = {context, settled, &scene, &mesh, request->samples, reference};
      status = conic_oracle_work(&job);
    }
    conic_oracle_mesh_release(context, &mesh);
    conic_oracle_scene_release(context, &scene);
  }
  if (status != CONIC_OK)
    conic_reference_release(context, reference);
  return status;
}

conic_status conic_oracle_draw(conic_context *context, const conic_drawing *drawing, const conic_camera *camera,
                               const conic_render_options *options, const oracle_request *request,
                               conic_reference *reference) {
  conic_entered_drawing entered;
  const conic_drawing whole = {&entered.splats, drawing->triangles ? &entered.triangles : NULL};
  conic_render_options settled;
  int samples = request->samples;
  memset(reference, 0, sizeof *reference);
  conic_status status = conic_view_arguments_take(context, "the oracle", camera, options, &settled);
  if (status != CONIC_OK)
    return status;
  if (samples < 1 || samples > CONIC_MAX_SAMPLES || camera->width > 65535 / samples || camera->height > 65535 / samples)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "samples: 1 to %d, and that times the picture's size at most %d",
                      CONIC_MAX_SAMPLES, 65535);
  status = conic_drawing_enter(context, "the oracle", drawing, &entered);
  if (status == CONIC_OK)
    status = check(context, &entered.splats, request);
  if (status == CONIC_OK)
    status = answer_drawing(context, &whole, camera, &settled, request, reference);
  conic_drawing_leave(context, &entered);
  return status;
}

conic_status conic_oracle_render_pixels(conic_context *context, const conic_drawing *drawing,
                                        const conic_camera *camera, const conic_render_options *options,
                                        conic_oracle_question question, int samples, size_t n_pixels,
                                        conic_reference *reference) {
  const oracle_request request = {question, samples, n_pixels, 0, CONIC_FLOATS_OWN};
  return conic_oracle_draw(context, drawing, camera, options, &request, reference);
}

CONIC_DEFINE_OPTIONS(conic_oracle_asking, .samples = 1)

conic_status conic_oracle_render_asked(conic_context *context, const conic_drawing *drawing, const conic_camera *camera,
                                       const conic_render_options *options, const conic_oracle_asking *asking,
                                       conic_reference *reference) {
  conic_oracle_asking own;
  memset(reference, 0, sizeof *reference);
  conic_oracle_asking_init(&own);
  if ((asking && !conic_options_take(&own, asking)) || (unsigned)own.floats >= CONIC_N_FLOAT_KINDS)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "the oracle: no such options or floats");
  const oracle_request request = {own.question, own.samples, own.n_pixels, 0, own.floats};
  return conic_oracle_draw(context, drawing, camera, options, &request, reference);
}

conic_status conic_oracle_render_drawing(conic_context *context, const conic_drawing *drawing,
                                         const conic_camera *camera, const conic_render_options *options,
                                         conic_oracle_question question, int samples, conic_reference *reference) {
  return conic_oracle_render_pixels(context, drawing, camera, options, question, samples, 0, reference);
}

conic_status conic_oracle_render_samples(conic_context *context, const conic_splats *splats, const conic_camera *camera,
                                         const conic_render_options *options, conic_oracle_question question,
                                         int samples, conic_reference *reference) {
  const conic_drawing alone = {.splats = splats};
  memset(reference, 0, sizeof *reference);
  return splats ? conic_oracle_render_pixels(context, &alone, camera, options, question, samples, 0, reference)
                : conic_fail(context, CONIC_ERROR_ARGUMENT, "the oracle needs splats");
}

conic_status conic_oracle_render(conic_context *context, const conic_splats *splats, const conic_camera *camera,
                                 const conic_render_options *options, conic_oracle_question question,
                                 conic_reference *reference) {
  return conic_oracle_render_samples(context, splats, camera, options, question, 1, reference);
}

void conic_reference_release(conic_context *context, conic_reference *reference) {
  for (int i = 0; i < CONIC_N_PLANES; i++)
    conic_memory_release(context, reference->planes[i]);
  conic_memory_release_these(context, reference->unstable, reference->pixels, reference->alternatives, reference->ids);
  memset(reference, 0, sizeof *reference);
}
