/* Hybrid models as a scene: a .chy, or a mesh with --as hybrid. */
#include "cli/commands/hybrid_mesh.h"
#include "cli/render/render_job.h"

int cli_hybrid_is_wanted(const cli_render_job *job) {
  if (job->as == CLI_AS_HYBRID)
    return 1;
  for (int i = 0; i < job->n_inputs; i++)
    if (conic_hybrid_is_file(job->inputs[i]))
      return 1;
  return 0;
}

static conic_status build(cli_session *session, cli_render_job *job) {
  conic_triangles mesh;
  conic_hybrid_options options;
  double start = cli_seconds();
  conic_status status = cli_mesh_read(session, job->inputs[0], job->texture_path, &mesh);
  double read = cli_seconds();
  job->read_ms = 1e3 * (read - start);
  if (status != CONIC_OK)
    return status;
  conic_hybrid_options_init(&options);
  options.cutoff = job->options.kernel.cutoff;
  status = conic_hybrid_build(session->context, &mesh, &options, &job->hybrid, NULL);
  job->estimate_ms = 1e3 * (cli_seconds() - read);
  return status;
}

conic_status cli_hybrid_open(cli_session *session, cli_render_job *job) {
  double start = cli_seconds();
  conic_status status;
  if (conic_hybrid_is_file(job->inputs[0])) {
    status = conic_hybrid_read(session->context, job->inputs[0], &job->hybrid);
    job->read_ms = 1e3 * (cli_seconds() - start);
  } else
    status = build(session, job);
  return status == CONIC_OK ? conic_hybrid_describe(job->hybrid, &job->hybrid_info) : status;
}

conic_status cli_hybrid_select(cli_render_job *job, const conic_camera *camera, double *ms) {
  conic_hybrid_view view;
  conic_hybrid_view_init(&view);
  view.error_px = job->error_px;
  view.only_kind = job->only_kind;
  view.budget = job->budget;
  double start = cli_seconds();
  conic_status status = conic_hybrid_select(job->hybrid, camera, &job->options, &view, &job->hybrid_selection);
  *ms = 1e3 * (cli_seconds() - start);
  return status;
}

void cli_hybrid_close(cli_session *session, cli_render_job *job) {
  if (!job->hybrid)
    return;
  conic_hybrid_selection_release(session->context, &job->hybrid_selection);
  conic_hybrid_destroy(job->hybrid);
  job->hybrid = NULL;
}

/* A colour for a number: bright, and unlike those of its neighbours. */
static void color_of(uint32_t number, float color[3]) {
  uint32_t bits = (number + 1) * 2654435761u;
  bits ^= bits >> 15;
  bits *= 2246822519u;
  bits ^= bits >> 13;
  for (int channel = 0; channel < 3; channel++)
    color[channel] = 0.08f + 0.92f * (float)(bits >> 8 * channel & 0xFF) / 255.0f;
}

conic_status cli_hybrid_write_clusters(cli_session *session, const char *path, const conic_image *image) {
  conic_image map;
  const uint32_t *cluster = image->planes[CONIC_PLANE_CLUSTER];
  const float *from = image->planes[CONIC_PLANE_RGBA];
  conic_status status =
      conic_image_allocate(session->context, image->width, image->height, 1u << CONIC_PLANE_RGBA, &map);
  if (status != CONIC_OK)
    return status;
  float *to = map.planes[CONIC_PLANE_RGBA];
  for (size_t i = 0; i < (size_t)image->width * (size_t)image->height; i++) {
    float color[3], light = (from[4 * i] + from[4 * i + 1] + from[4 * i + 2]) / 3.0f;
    if (cluster[i] == CONIC_NO_ID)
      continue;
    color_of(cluster[i], color);
    for (int channel = 0; channel < 3; channel++)
      to[4 * i + (size_t)channel] = color[channel] * light;
    to[4 * i + 3] = 1.0f;
  }
  status = conic_image_write(session->context, path, &map);
  conic_image_release(session->context, &map);
  return status;
}
