/* conic render --error, --budget: what is chosen of an octree, frame by frame. */
#include "cli/render/render_job.h"

int cli_lod_is_wanted(const cli_render_job *job) {
  return job->error_px > 0.0 || job->budget > 0;
}

conic_status cli_lod_open(cli_session *session, cli_render_job *job) {
  double start = cli_seconds();
  conic_status status = conic_octree_read(session->context, job->inputs[0], &job->octree);
  if (status == CONIC_OK)
    status = conic_octree_describe(job->octree, &job->info);
  job->read_ms = 1e3 * (cli_seconds() - start);
  return status;
}

conic_status cli_lod_select(cli_render_job *job, const conic_camera *camera, double *ms) {
  conic_selection_options options;
  conic_selection_options_init(&options);
  options.error_px = job->error_px;
  options.budget = job->budget;
  double start = cli_seconds();
  conic_status status = conic_octree_select(job->octree, camera, &job->options, &options, &job->selection);
  *ms = 1e3 * (cli_seconds() - start);
  return status;
}

void cli_lod_close(cli_session *session, cli_render_job *job) {
  if (!job->octree)
    return;
  conic_selection_release(session->context, &job->selection);
  conic_octree_destroy(job->octree);
  job->octree = NULL;
}
