/* Finds the fault that would explain the wrong pixels. */
#include "cli/commands/gaussian_commands.h"
#include "cli/judge/judge_job.h"
#include "conic/source.h"

static conic_status diagnose_gaussians(cli_session *session, cli_judge_job *job, const conic_image *greatest) {
  const conic_gaussian_options options = cli_gaussian_options(&job->scene);
  conic_gaussian_judging judging;
  conic_gaussian_judging_init(&judging);
  judging.samples = job->scene.shot.view.samples;
  judging.is_opaque = job->scene.shot.render.has_background;
  judging.greatest = greatest;
  return conic_gaussian_diagnose(session->context, conic_source_gaussians(job->scene.source), &job->camera, &options,
                                 &judging, &job->picture.image, job->classes, job->found.faults, CLI_JUDGE_MOST_FAULTS,
                                 &job->found.n_faults);
}

static conic_status diagnose_splats(cli_session *session, cli_judge_job *job, const conic_image *greatest) {
  const conic_source_choice *choice = conic_source_chosen(job->scene.source);
  conic_oracle_judging judging;
  conic_oracle_judging_init(&judging);
  judging.greatest = greatest;
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
  const conic_image *greatest = job->picture.greatest.width ? &job->picture.greatest : NULL;
  return cli_is_composited(&job->scene) ? diagnose_gaussians(session, job, greatest)
                                        : diagnose_splats(session, job, greatest);
}
