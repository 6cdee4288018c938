/* The two kinds of scenes that pictures are judged by, with their findings in one form; and the fault that would
 * explain the wrong pixels. */

#include "cli/commands/gaussian_commands.h"
#include "cli/commands/verify_reference.h"
#include "cli/judge/judge_job.h"

static void take_worst(const conic_oracle_fault *faults, int n, cli_judgement *found) {
  found->n_worst = n;
  for (int k = 0; k < n; k++)
    found->worst[k].fault = faults[k];
}

static const conic_image *greatest_in(const cli_judge_job *job) {
  return job->picture.greatest.width ? &job->picture.greatest : NULL;
}

conic_status cli_judge_gaussians(cli_session *session, cli_judge_job *job) {
  const conic_gaussian_options options = cli_gaussian_options(&job->scene);
  cli_judgement *found = &job->found;
  conic_gaussian_judging judging;
  conic_gaussian_verdict verdict;
  conic_float_model model;
  conic_float_model_init(&model, (conic_float_kind)job->floats);
  conic_gaussian_judging_init(&judging);
  judging.model = &model;
  judging.n_pixels = (size_t)job->n_pixels;
  judging.samples = job->scene.shot.view.samples;
  judging.is_opaque = job->scene.shot.render.has_background;
  judging.greatest = greatest_in(job);
  judging.ranges = job->ranges;
  judging.faults = job->wrong_values;
  conic_status status =
      cli_draw_surfaces(&job->scene, &job->camera, conic_image_planes(&job->picture.image), &job->drawn);
  judging.surfaces = job->drawn.given;
  if (status == CONIC_OK)
    status = conic_gaussian_judge(session->context, conic_source_gaussians(job->scene.source), &job->camera, &options,
                                  &judging, &job->picture.image, job->classes, &verdict);
  if (status != CONIC_OK)
    return status;
  memcpy(found->pixels, verdict.pixels, sizeof found->pixels);
  memcpy(found->planes, verdict.planes, sizeof found->planes);
  for (int k = 0; k < CONIC_N_GAUSSIAN_DOUBTS; k++) {
    found->reasons[k] = conic_gaussian_doubt_name((conic_gaussian_doubt)k);
    found->explained_by[k] = verdict.explained_by[k];
  }
  found->judged = verdict.judged_pixels;
  found->covered = verdict.covered_pixels;
  found->doubtful = verdict.doubtful_pixels;
  found->vague = (size_t)verdict.vague_pixels;
  take_worst(verdict.worst, verdict.n_worst, found);
  return CONIC_OK;
}

conic_status cli_judge_splats(cli_session *session, cli_judge_job *job) {
  cli_judgement *found = &job->found;
  conic_oracle_judging judging;
  conic_oracle_judgement judgement;
  conic_reference reference = {.width = 0};
  conic_oracle_judging_init(&judging);
  judging.greatest = greatest_in(job);
  conic_status status =
      conic_source_choose(job->scene.source, &job->camera, &job->scene.shot.render, &job->scene.shot.view);
  if (status == CONIC_OK)
    status = cli_reference_draw(session, &job->scene, &job->camera, CONIC_ORACLE_METHOD, (conic_float_kind)job->floats,
                                (size_t)job->n_pixels, 1, &reference);
  if (status == CONIC_OK)
    status = conic_oracle_judge(session->context, &reference, &judging, &job->picture.image, job->classes, &judgement);
  if (status == CONIC_OK) {
    memcpy(found->pixels, judgement.pixels, sizeof found->pixels);
    memcpy(found->planes, judgement.verdict.planes, sizeof found->planes);
    for (int k = 0; k < CONIC_N_UNSTABLE_REASONS; k++) {
      found->reasons[k] = conic_unstable_reason_name((conic_unstable_reason)k);
      found->explained_by[k] = judgement.explained_by[k];
    }
    found->judged = reference.n_pixels;
    found->covered = reference.covered_pixels;
    found->doubtful = reference.unstable_pixels;
    take_worst(judgement.worst, judgement.n_worst, found);
  }
  conic_reference_release(session->context, &reference);
  return status;
}

static conic_status diagnose_gaussians(cli_session *session, cli_judge_job *job) {
  const conic_gaussian_options options = cli_gaussian_options(&job->scene);
  conic_gaussian_judging judging;
  conic_gaussian_judging_init(&judging);
  judging.samples = job->scene.shot.view.samples;
  judging.is_opaque = job->scene.shot.render.has_background;
  judging.greatest = greatest_in(job);
  judging.ranges = job->ranges;
  judging.surfaces = job->drawn.given;
  return conic_gaussian_diagnose(session->context, conic_source_gaussians(job->scene.source), &job->camera, &options,
                                 &judging, &job->picture.image, job->classes, job->found.faults, CLI_JUDGE_MOST_FAULTS,
                                 &job->found.n_faults);
}

static conic_status diagnose_splats(cli_session *session, cli_judge_job *job) {
  const conic_source_choice *choice = conic_source_chosen(job->scene.source);
  conic_oracle_judging judging;
  conic_oracle_judging_init(&judging);
  judging.greatest = greatest_in(job);
  return conic_drawing_diagnose(session->context, &choice->drawing, &job->camera, &job->scene.shot.render,
                                job->scene.shot.view.samples, &judging, &job->picture.image, job->classes,
                                job->found.faults, CLI_JUDGE_MOST_FAULTS, &job->found.n_faults);
}

static int is_blank(const conic_image *image) {
  const float *rgba = image->planes[CONIC_PLANE_RGBA];
  const size_t n = (size_t)image->width * (size_t)image->height;
  for (size_t i = 1; rgba && i < n; i++)
    for (size_t c = 0; c < 3; c++)
      if (rgba[4 * i + c] != rgba[c])
        return 0;
  return rgba != NULL;
}

conic_status cli_judge_diagnose(cli_session *session, cli_judge_job *job) {
  job->found.is_blank = is_blank(&job->picture.image);
  if (job->found.is_blank)
    return CONIC_OK;
  return cli_is_composited(&job->scene) ? diagnose_gaussians(session, job) : diagnose_splats(session, job);
}
