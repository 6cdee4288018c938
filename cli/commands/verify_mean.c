#include "cli/commands/verify_reference.h"
#include "cli/render/fill_shot.h"
#include "cli/render/sample_options.h"
#include "shots/way.h"

enum {
  MEANS = 1 << CONIC_PLANE_RGBA | 1 << CONIC_PLANE_ALBEDO | 1 << CONIC_PLANE_WEIGHT,
  OF_THE_MIDDLE = 1 << CONIC_PLANE_Z | 1 << CONIC_PLANE_COUNT | 1 << CONIC_PLANE_ID
};

typedef struct mean_work {
  cli_session *session;
  cli_render_job *scene;
  size_t n_pixels;
  const char *image_path;
  conic_image *image, sample;
  conic_accumulation *sums;
  cli_mean_verdict *result;
} mean_work;

/* The image with only these planes. */
static conic_image only(const conic_image *image, unsigned planes) {
  conic_image some = *image;
  for (int i = 0; i < CONIC_N_PLANES; i++)
    if (!(planes >> i & 1))
      some.planes[i] = NULL;
  return some;
}

static conic_status draw_judged(mean_work *work, const conic_camera *camera, conic_image *image) {
  cli_render_job *scene = work->scene;
  double start = cli_seconds();
  conic_status status =
      conic_render_drawing(work->session->context, scene->renderer, &conic_source_chosen(scene->source)->drawing,
                           camera, &scene->shot.render, 1, image, &scene->statistics);
  work->result->render_ms += 1e3 * (cli_seconds() - start);
  return status;
}

static conic_status ask_oracle(mean_work *work, const conic_camera *camera, conic_reference *reference) {
  double start = cli_seconds();
  conic_status status = cli_reference_draw(work->session, work->scene, camera, CONIC_ORACLE_METHOD, CONIC_FLOATS_OWN,
                                           work->n_pixels, work->image_path != NULL, reference);
  work->result->oracle_ms += 1e3 * (cli_seconds() - start);
  return status;
}

/* Judges the planes without means, which show what is seen through the pixels' centres. */
static conic_status judge_middle(mean_work *work) {
  cli_render_job *scene = work->scene;
  conic_context *context = work->session->context;
  conic_reference reference;
  conic_camera camera;
  memset(&reference, 0, sizeof reference);
  conic_status status = conic_shot_camera(context, &scene->shot, 0.5, &camera);
  if (status == CONIC_OK)
    status = conic_shot_move(&scene->shot, scene->source, 0.5);
  if (status == CONIC_OK)
    status = conic_source_choose(scene->source, &camera, &scene->shot.render, &scene->shot.view);
  if (status == CONIC_OK && !work->image_path)
    status = conic_image_allocate(context, camera.width, camera.height, scene->shot.planes, work->image);
  if (status == CONIC_OK && !work->image_path)
    status = draw_judged(work, &camera, work->image);
  if (status == CONIC_OK)
    status = cli_reference_check_size(work->image_path, work->image, &camera);
  if (status == CONIC_OK)
    status = ask_oracle(work, &camera, &reference);
  const conic_image drawn = only(work->image, OF_THE_MIDDLE);
  if (status == CONIC_OK)
    status = conic_oracle_compare(context, &reference, &drawn, &work->result->verdict);
  conic_shot_rest(&scene->shot, scene->source);
  conic_reference_release(context, &reference);
  return status;
}

static conic_status judge_sample(mean_work *work, uint64_t index, const conic_reference *reference) {
  cli_mean_verdict *result = work->result;
  conic_oracle_verdict verdict;
  conic_status status = conic_oracle_compare(work->session->context, reference, &work->sample, &verdict);
  if (status != CONIC_OK)
    return status;
  if (verdict.wrong_pixels && !result->n_wrong) {
    result->worst = verdict.worst;
    result->i_worst = index;
  }
  result->n_wrong += verdict.wrong_pixels;
  return conic_accumulation_add(work->sums, &work->sample);
}

static conic_status add_sample(mean_work *work, uint64_t index) {
  cli_render_job *scene = work->scene;
  conic_context *context = work->session->context;
  conic_reference reference;
  conic_sample place;
  memset(&reference, 0, sizeof reference);
  conic_status status = conic_shot_sample(scene->source, &scene->shot, index, &place);
  if (status == CONIC_OK)
    status = conic_source_choose(scene->source, &place.camera, &scene->shot.render, &scene->shot.view);
  if (status == CONIC_OK && work->sums)
    status = draw_judged(work, &place.camera, &work->sample);
  if (status == CONIC_OK)
    status = ask_oracle(work, &place.camera, &reference);
  if (status == CONIC_OK && work->sums)
    status = judge_sample(work, index, &reference);
  if (status == CONIC_OK)
    status = conic_reference_average(context, &reference, index, &work->result->reference);
  conic_reference_release(context, &reference);
  return status;
}

/* Makes room for samples, if they are drawn here. */
static conic_status begin_samples(mean_work *work, const conic_camera *camera) {
  conic_context *context = work->session->context;
  unsigned planes = work->scene->shot.planes;
  if (work->image_path || !(planes & CONIC_ACCUMULATED_PLANES))
    return CONIC_OK;
  conic_status status = conic_accumulation_create(context, camera->width, camera->height, planes, 0, &work->sums);
  return status == CONIC_OK ? conic_image_allocate(context, camera->width, camera->height, planes, &work->sample)
                            : status;
}

/* Adds the verdict on the means to that on the middle. */
static conic_status judge_mean(mean_work *work) {
  conic_oracle_verdict *all = &work->result->verdict, verdict;
  const conic_image means = only(work->image, MEANS);
  conic_status status = conic_oracle_compare(work->session->context, &work->result->reference, &means, &verdict);
  if (status != CONIC_OK)
    return status;
  for (int i = 0; i < CONIC_N_PLANES; i++)
    if (OF_THE_MIDDLE >> i & 1)
      verdict.planes[i] = all->planes[i];
  if (!verdict.wrong_pixels)
    verdict.worst = all->worst;
  verdict.wrong_pixels += all->wrong_pixels;
  verdict.pass &= all->pass && work->result->n_wrong == 0;
  *all = verdict;
  return CONIC_OK;
}

conic_status cli_verify_mean(cli_session *session, cli_render_job *scene, size_t n_pixels, const char *image_path,
                             conic_image *image, cli_mean_verdict *result) {
  int n_samples = (int)scene->accumulating.n_samples;
  mean_work work = {.session = session, .scene = scene, .n_pixels = n_pixels, .image_path = image_path, .image = image};
  memset(result, 0, sizeof *result);
  work.result = result;
  conic_status status = cli_shot_fill(session, scene, cli_sample_frame(scene));
  if (status == CONIC_OK)
    status = judge_middle(&work);
  if (status == CONIC_OK)
    status = conic_shot_focus(scene->source, scene->renderer, &scene->shot);
  if (status == CONIC_OK)
    status = begin_samples(&work, &scene->shot.camera);
  for (int i = 0; i < n_samples && status == CONIC_OK; i++) {
    cli_session_part(session, "sample", i + 1, n_samples);
    status = add_sample(&work, (uint64_t)i);
  }
  if (status == CONIC_OK && work.sums)
    status = conic_accumulation_resolve(work.sums, image);
  if (status == CONIC_OK)
    status = judge_mean(&work);
  conic_accumulation_destroy(work.sums);
  conic_image_release(session->context, &work.sample);
  return status;
}
