/* --method patch: polynomials about the points, sampled frame by frame. */
#include "cli/render/render_job.h"

const char *cli_method_name(const cli_render_job *job) {
  return job->is_patch ? "patch" : conic_method_name(job->options.method);
}

conic_status cli_patch_open(cli_session *session, cli_render_job *job, const conic_splats *splats) {
  conic_patches_options options;
  double spacing = 1.0;
  conic_status status = CONIC_OK;
  conic_patches_options_init(&options);
  options.surface.degree = job->degree;
  options.surface.isa = job->options.isa;
  options.cutoff = job->options.kernel.cutoff;
  if (job->h.value > 0.0 && job->h.is_in_spacings)
    status = conic_splats_spacing(session->context, splats, &spacing);
  options.surface.h = job->h.value * spacing;
  if (status == CONIC_OK)
    status = conic_patches_create(session->context, splats, &options, &job->patches);
  if (status == CONIC_OK && job->options.epsilon < 0.0) /* the points', not their samples' */
    job->options.epsilon = (double)job->options.kernel.cutoff * job->options.splat_length;
  return status;
}

conic_status cli_patch_select(cli_render_job *job, const conic_camera *camera, double *ms) {
  double start = cli_seconds();
  conic_status status = conic_patches_select(job->patches, camera, &job->options, &job->patch_selection);
  *ms = 1e3 * (cli_seconds() - start);
  return status;
}

void cli_patch_close(cli_render_job *job) {
  conic_patches_destroy(job->patches);
  job->patches = NULL;
}
