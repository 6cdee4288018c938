/* A scene as the commands that draw one take it: read, given axes, measured, framed. */
#include <string.h>

#include "cli/render_job.h"

/* Reads an input, and gives its points axes where it has none. */
static conic_status read_input(cli_session *session, const cli_render_job *job, const char *path, conic_splats *splats,
                               double *estimate_seconds) {
  conic_model model;
  conic_read_options read_options;
  conic_estimate_options estimate_options;
  conic_repairs repairs;
  conic_read_options_init(&read_options);
  conic_estimate_options_init(&estimate_options);
  read_options.cutoff = estimate_options.cutoff = job->options.kernel.cutoff;
  estimate_options.n_neighbours = job->n_neighbours;
  conic_status status = conic_model_read(session->context, path, &read_options, &model);
  if (status != CONIC_OK)
    return status;
  double low[3], high[3], start = cli_seconds();
  if (conic_splats_bounds(&model.points, low, high) == 0) {
    cli_error(CLI_INPUT, "%s: nothing to draw: %s", path,
              model.points.count ? "no point is finite" : "it holds no points");
    status = CONIC_ERROR_INPUT;
  }
  if (status == CONIC_OK)
    status = conic_model_to_splats(session->context, &estimate_options, &model, &repairs);
  if (status == CONIC_OK && splats->count == 0) {
    *splats = model.points; /* the first input's arrays are taken over, not copied */
    memset(&model.points, 0, sizeof model.points);
  } else if (status == CONIC_OK)
    status = conic_splats_append(session->context, splats, &model.points);
  *estimate_seconds += cli_seconds() - start;
  conic_model_release(session->context, &model);
  return status;
}

conic_status cli_scene_read(cli_session *session, cli_render_job *job, conic_splats *splats) {
  double start = cli_seconds(), estimate_seconds = 0.0;
  memset(splats, 0, sizeof *splats);
  for (int i = 0; i < job->n_inputs; i++) {
    conic_status status = read_input(session, job, job->inputs[i], splats, &estimate_seconds);
    if (status != CONIC_OK)
      return status;
  }
  job->read_ms = 1e3 * (cli_seconds() - start - estimate_seconds);
  job->estimate_ms = 1e3 * estimate_seconds;
  return CONIC_OK;
}

conic_status cli_scene_measure(cli_session *session, cli_render_job *job, const conic_splats *splats) {
  double start = cli_seconds();
  conic_status status = conic_splats_length(session->context, splats, &job->options.splat_length);
  if (status == CONIC_OK && job->options.near_z == 0.0)
    job->options.near_z = conic_default_near(splats);
  job->estimate_ms += 1e3 * (cli_seconds() - start);
  return status;
}

conic_status cli_scene_camera(cli_session *session, const cli_render_job *job, const conic_splats *splats, int i_frame,
                              conic_camera *camera) {
  double low[3], high[3];
  conic_framing framing = job->framing;
  if (job->camera_path)
    return conic_camera_read(session->context, job->camera_path, camera);
  conic_splats_bounds(splats, low, high);
  framing.azimuth_deg += 360.0 * (double)i_frame / (double)job->n_frames;
  return conic_camera_frame(session->context, &framing, low, high, camera);
}
