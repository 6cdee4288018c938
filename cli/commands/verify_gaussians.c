/* conic verify for a Gaussian scene: compares a picture with the bounds of what floats may make of its profile. */

#include "cli/commands/gaussian_commands.h"
#include "cli/commands/verify_reference.h"
#include "cli/render/sample_options.h"
#include "cli/scene/surfaces_drawn.h"
#include "shots/way.h"

typedef struct gaussian_report {
  const cli_render_job *scene;
  conic_gaussian_verdict verdict;
  conic_gaussian_judging judging;
  double render_ms, oracle_ms;
  size_t n_pixels; /* of the picture */
  int n_samples;   /* 0: it is no mean */
  size_t n_wrong;  /* pixels of the mean */
} gaussian_report;

const char *const cli_float_words[] = {"own", "strict", "fast", NULL};
const char *const cli_class_words[] = {"equal", "rounding", "explained", "wrong", "not judged"};

int cli_is_composited(const cli_render_job *scene) {
  return (scene->abilities & CONIC_SOURCE_COMPOSITES) != 0;
}

conic_gaussian_options cli_gaussian_options(const cli_render_job *scene) {
  conic_gaussian_options options = scene->shot.gaussians;
  for (int c = 0; c < 3; c++)
    options.background[c] = scene->shot.render.has_background ? scene->shot.render.background[c] : 0.0f;
  return options;
}

conic_status cli_gaussians_begin(cli_session *session, cli_render_job *scene, int floats,
                                 conic_gaussian_options *options, conic_float_model *model) {
  *options = cli_gaussian_options(scene);
  conic_float_model_init(model, (conic_float_kind)floats);
  conic_status status = cli_scene_begin(session, scene);
  if (status == CONIC_OK)
    status = cli_scene_open(session, scene);
  return status == CONIC_OK ? cli_scene_camera(session, scene, 0) : status;
}

static const char *profile_of(const cli_render_job *scene) {
  return conic_gaussian_profile_name(scene->shot.gaussians.profile);
}

static void write_by_doubt(cli_json *json, const char *key, const size_t *counts) {
  cli_json_object(json, key);
  for (int k = 0; k < CONIC_N_GAUSSIAN_DOUBTS; k++)
    cli_json_count(json, conic_gaussian_doubt_name((conic_gaussian_doubt)k), counts[k]);
  cli_json_close(json);
}

static void write_verdict(cli_json *json, const void *cookie) {
  const gaussian_report *r = cookie;
  const conic_gaussian_verdict *v = &r->verdict;
  cli_json_texts(json, NULL, {"against", "profile"}, {"profile", profile_of(r->scene)});
  if (r->scene->accumulating.is_sample_given)
    cli_json_count(json, "sample", r->scene->accumulating.i_sample);
  if (r->n_samples) {
    cli_json_object(json, "accumulated");
    cli_json_counts(json, NULL, {"samples", (uint64_t)r->n_samples}, {"wrong_pixels", r->n_wrong});
    cli_json_close(json);
  }
  if (r->judging.samples > 1)
    cli_json_count(json, "samples", (uint64_t)r->judging.samples);
  cli_json_object(json, "planes");
  for (int i = 0; i < CONIC_N_PLANES; i++)
    if (v->planes[i].is_compared) {
      cli_json_figures(json, conic_plane_describe((conic_plane)i)->name, {"max_abs", v->planes[i].max_abs},
                       {"widest", v->planes[i].bound});
    }
  cli_json_close(json);
  cli_json_counts(json, NULL, {"judged_pixels", v->judged_pixels}, {"covered_pixels", v->covered_pixels});
  cli_json_object(json, "classes");
  for (int k = 0; k < CONIC_N_GAUSSIAN_CLASSES; k++)
    cli_json_count(json, conic_gaussian_class_name((conic_gaussian_class)k), v->pixels[k]);
  cli_json_close(json);
  cli_json_count(json, "doubtful_pixels", v->doubtful_pixels);
  write_by_doubt(json, "doubtful_by_reason", v->doubtful);
  write_by_doubt(json, "explained_by_reason", v->explained_by);
  cli_json_counts(json, NULL, {"wide_pixels", v->wide_pixels}, {"wrong_pixels", v->pixels[CONIC_PIXEL_WRONG]});
  if (v->n_worst)
    cli_report_fault(json, "worst", &v->worst[0]);
  cli_json_figures(json, "ms", {"render", r->render_ms}, {"oracle", r->oracle_ms});
  cli_json_bool(json, "pass", v->pass);
}

static void print_verdict(const gaussian_report *r) {
  const conic_gaussian_verdict *v = &r->verdict;
  for (int i = 0; i < CONIC_N_PLANES; i++)
    if (v->planes[i].is_compared)
      printf("%-9s max %-11.4g widest range %.3g\n", conic_plane_describe((conic_plane)i)->name, v->planes[i].max_abs,
             v->planes[i].bound);
  if (r->n_samples)
    printf("samples   %d, %zu pixels of their mean wrong\n", r->n_samples, r->n_wrong);
  printf("judged    %zu of %zu pixels", v->judged_pixels,
         r->n_samples ? r->n_pixels * (size_t)r->n_samples : r->n_pixels);
  for (int k = 0; k < CONIC_N_GAUSSIAN_CLASSES; k++)
    printf("%s %zu %s", k ? "," : ":", v->pixels[k], conic_gaussian_class_name((conic_gaussian_class)k));
  printf("\ndoubtful  %zu of %zu covered pixels", v->doubtful_pixels, v->covered_pixels);
  const char *separator = ": ";
  for (int k = 0; k < CONIC_N_GAUSSIAN_DOUBTS; k++)
    if (v->doubtful[k]) {
      printf("%s%s %zu", separator, conic_gaussian_doubt_name((conic_gaussian_doubt)k), v->doubtful[k]);
      separator = ", ";
    }
  putchar('\n');
  if (v->wide_pixels)
    printf("wide      %zu pixels have more decisions in doubt than are followed both ways\n", v->wide_pixels);
  for (int k = 0; k < v->n_worst; k++)
    printf("worst     pixel %d,%d: %s[%d] is %.9g; it may be %.9g to %.9g\n", v->worst[k].x, v->worst[k].y,
           conic_plane_describe((conic_plane)v->worst[k].plane)->name, v->worst[k].channel, v->worst[k].found,
           v->worst[k].low, v->worst[k].high);
  puts(v->pass ? "pass" : "FAILED");
}

/* Draws the picture to judge, if none is given. */
static conic_status draw_composited(cli_session *session, cli_render_job *scene, const conic_camera *camera,
                                    conic_image *image, double *ms) {
  double start = cli_seconds();
  conic_status status =
      conic_image_allocate(session->context, camera->width, camera->height, scene->shot.planes, image);
  if (status == CONIC_OK)
    status = conic_source_draw(scene->source, scene->renderer, camera, &scene->shot.render, &scene->shot.view, image,
                               &scene->statistics);
  *ms = 1e3 * (cli_seconds() - start);
  return status;
}

static int tell_judgement(cli_session *session, const gaussian_report *r) {
  int exit_code = cli_json_write(session, write_verdict, r);
  if (exit_code != CLI_DONE)
    return exit_code;
  if (cli_json_leaves_text(session))
    print_verdict(r);
  return r->verdict.pass ? CLI_DONE : CLI_DIFFERENT;
}

/* Draws the picture, if it is not given, and judges it with the surfaces that are seen. */
static conic_status judge_picture(cli_session *session, cli_render_job *scene, const conic_camera *camera, int is_given,
                                  conic_image *image, gaussian_report *r) {
  cli_surfaces_drawn drawn = {.given = NULL};
  conic_gaussian_judging judging = r->judging;
  const conic_gaussian_options options = cli_gaussian_options(scene);
  conic_gaussian_verdict verdict;
  double ms = 0.0;
  conic_status status = is_given ? CONIC_OK : draw_composited(session, scene, camera, image, &ms);
  if (status == CONIC_OK)
    status = cli_draw_surfaces(scene, camera, conic_image_planes(image), &drawn);
  double start = cli_seconds();
  judging.surfaces = drawn.given;
  if (status == CONIC_OK)
    status = conic_gaussian_judge(session->context, conic_source_gaussians(scene->source), camera, &options, &judging,
                                  image, NULL, &verdict);
  if (status == CONIC_OK)
    conic_gaussian_verdict_add(&verdict, &r->verdict);
  conic_image_release(session->context, &drawn.image);
  r->render_ms += ms;
  r->oracle_ms += 1e3 * (cli_seconds() - start);
  return status;
}

/* --- means of samples --- */

typedef struct mean_judging {
  conic_image sample, mean; /* the mean of the judged samples … */
  conic_accumulation *sums;
  float *ranges, *widths; /* … and how far that of samples within their ranges may be from it; below 0: not judged */
  size_t n;
} mean_judging;

/* Of a mean of floats that somebody else has summed up. */
static const double sum_roundoff = 1e-6;

static conic_status begin_mean(conic_context *context, const cli_render_job *scene, mean_judging *m) {
  const conic_camera *camera = &scene->shot.camera;
  const unsigned planes = scene->shot.planes;
  m->n = (size_t)camera->width * (size_t)camera->height;
  m->ranges = conic_memory_allocate(context, m->n, sizeof *m->ranges);
  m->widths = conic_memory_allocate_zeroed(context, m->n, sizeof *m->widths);
  conic_status status = m->ranges && m->widths ? CONIC_OK : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK)
    status = conic_accumulation_create(context, camera->width, camera->height, planes, 0, &m->sums);
  return status == CONIC_OK ? conic_image_allocate(context, camera->width, camera->height, planes, &m->mean) : status;
}

static conic_status judge_sample(cli_session *session, cli_render_job *scene, int i, mean_judging *m,
                                 gaussian_report *r) {
  conic_sample place;
  conic_status status = conic_shot_sample(scene->source, &scene->shot, (uint64_t)i, &place);
  conic_sample_see((uint64_t)i, 1, &scene->shot.view);
  for (size_t k = 0; k < m->n; k++)
    m->ranges[k] = -1.0f;
  if (status == CONIC_OK)
    status = judge_picture(session, scene, &place.camera, 0, &m->sample, r);
  if (status == CONIC_OK)
    status = conic_accumulation_add(m->sums, &m->sample);
  for (size_t k = 0; k < m->n; k++)
    m->widths[k] = m->ranges[k] < 0.0f ? -1.0f : m->widths[k] + m->ranges[k] / (float)r->n_samples;
  conic_image_release(session->context, &m->sample);
  return status;
}

/* Whether a plane's pixel is that of the mean of samples that are each within what they may be; fills in the fault. */
static int is_mean(const mean_judging *m, const conic_image *image, int plane, size_t i, conic_oracle_fault *fault) {
  const int n = conic_plane_describe((conic_plane)plane)->n_channels;
  const int n_judged = n == 4 && image->lacks_alpha ? 3 : n;
  for (int c = 0; c < n_judged && image->planes[plane]; c++) {
    const double found = (double)((const float *)image->planes[plane])[(size_t)n * i + (size_t)c],
                 mean = (double)((const float *)m->mean.planes[plane])[(size_t)n * i + (size_t)c];
    const double most = (double)m->widths[i] + sum_roundoff * (fabs(mean) > 1.0 ? fabs(mean) : 1.0);
    *fault = (conic_oracle_fault){.plane = plane,
                                  .channel = c,
                                  .x = (int)(i % (size_t)image->width),
                                  .y = (int)(i / (size_t)image->width),
                                  .found = found,
                                  .low = mean - most,
                                  .high = mean + most};
    if (!(fabs(found - mean) <= most))
      return 0;
  }
  return 1;
}

static void judge_mean(const mean_judging *m, const conic_image *image, gaussian_report *r) {
  conic_gaussian_verdict *v = &r->verdict;
  for (size_t i = 0; i < m->n; i++) {
    conic_oracle_fault fault;
    if (m->widths[i] < 0.0f ||
        (is_mean(m, image, CONIC_PLANE_RGBA, i, &fault) && is_mean(m, image, CONIC_PLANE_TRANSPARENCY, i, &fault)))
      continue;
    if (!v->n_worst)
      v->worst[v->n_worst++] = fault;
    r->n_wrong++;
    v->pass = 0;
  }
}

/* Judges each sample, and then the picture, which is drawn as conic render draws it where none is given. */
static conic_status judge_samples(cli_session *session, cli_render_job *scene, const char *image_path,
                                  conic_image *image, gaussian_report *r) {
  const conic_source_view view = scene->shot.view;
  mean_judging m = {.sums = NULL};
  conic_shot_outcome outcome;
  conic_status status = conic_shot_focus(scene->source, scene->renderer, &scene->shot);
  if (status == CONIC_OK && !image_path) {
    status = conic_image_allocate(session->context, scene->shot.camera.width, scene->shot.camera.height,
                                  scene->shot.planes, image);
    if (status == CONIC_OK)
      status = conic_shot_draw(scene->source, scene->renderer, &scene->shot, image, &outcome);
  }
  if (status == CONIC_OK)
    status = begin_mean(session->context, scene, &m);
  r->judging.ranges = m.ranges;
  for (int i = 0; i < r->n_samples && status == CONIC_OK; i++) {
    cli_session_part(session, "sample", i + 1, r->n_samples);
    status = judge_sample(session, scene, i, &m, r);
    scene->shot.view = view;
  }
  if (status == CONIC_OK)
    status = conic_accumulation_resolve(m.sums, &m.mean);
  if (status == CONIC_OK)
    judge_mean(&m, image, r);
  conic_shot_rest(&scene->shot, scene->source);
  conic_accumulation_destroy(m.sums);
  conic_image_release(session->context, &m.mean);
  conic_memory_release_these(session->context, m.ranges, m.widths);
  return status;
}

int cli_verify_composited(cli_session *session, cli_render_job *scene, size_t n_pixels, const char *image_path,
                          conic_image *image) {
  gaussian_report r = {.scene = scene, .n_samples = (int)scene->accumulating.n_samples, .verdict = {.pass = 1}};
  conic_camera camera;
  conic_gaussian_judging_init(&r.judging);
  r.judging.n_pixels = n_pixels;
  r.judging.samples = scene->shot.view.samples;
  r.judging.is_opaque = scene->shot.render.has_background;
  conic_status status = cli_sample_camera(session, scene, &camera);
  if (status == CONIC_OK && image_path)
    status = cli_reference_check_size(image_path, image, &camera);
  if (status == CONIC_OK)
    status = r.n_samples ? judge_samples(session, scene, image_path, image, &r)
                         : judge_picture(session, scene, &camera, image_path != NULL, image, &r);
  r.n_pixels = (size_t)image->width * (size_t)image->height;
  return status == CONIC_OK ? tell_judgement(session, &r) : cli_exit_of(status);
}
