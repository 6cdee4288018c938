/* conic render of a layered point cloud: from a file or a URL, in bounded memory, and picture after picture as it comes
 * in. */
#include <errno.h>
#include <string.h>
#include <sys/stat.h>

#include "cli/render/render_job.h"

int cli_layers_is_input(const char *name) {
  return conic_layers_is_url(name) || conic_layers_is_file(name);
}

int cli_layers_is_wanted(const cli_render_job *job) {
  return job->n_inputs == 1 && cli_layers_is_input(job->inputs[0]);
}

conic_status cli_layers_open(cli_session *session, cli_render_job *job) {
  conic_layers_access access;
  double start = cli_seconds();
  conic_layers_access_init(&access);
  access.memory_bytes = (uint64_t)job->layers.memory_mib << 20;
  access.connect_seconds = access.stall_seconds = job->layers.timeout;
  conic_status status = conic_layers_open(session->context, job->inputs[0], &access, &job->layers.file);
  if (status == CONIC_OK)
    conic_layers_measure(job->layers.file, job->options.kernel.cutoff, &job->layers.scale);
  job->read_ms = 1e3 * (cli_seconds() - start);
  return status;
}

static conic_status draw(cli_session *session, cli_render_job *job, int most_levels, const conic_camera *camera,
                         conic_image *image, conic_render_statistics *statistics) {
  conic_layers_draw_options options;
  (void)session;
  conic_layers_draw_options_init(&options);
  options.error_px = job->error_px;
  options.budget = job->budget;
  options.most_levels = most_levels;
  options.occlusion = (conic_occlusion)job->layers.occlusion;
  options.samples = job->samples;
  options.may_be_coarser = job->layers.progressive_path || job->layers.deadline > 0.0;
  if (job->layers.deadline > 0.0) { /* it counts from the start of the program's work, not of this picture */
    double left = job->layers.start_seconds + job->layers.deadline - cli_seconds();
    options.seconds = left > 1e-3 ? left : 1e-3;
  }
  return conic_layers_draw(job->layers.file, job->renderer, camera, &job->options, &options, image, statistics,
                           &job->layers.drawn);
}

static conic_status write_progress(cli_session *session, const cli_render_job *job, int i_picture,
                                   const conic_image *image) {
  char path[4096];
  int length = snprintf(path, sizeof path, "%s/%04d.exr", job->layers.progressive_path, i_picture);
  if (length < 0 || (size_t)length >= sizeof path)
    return CONIC_ERROR_IO;
  return conic_image_write(session->context, path, image);
}

static conic_status make_folder(const char *path) {
  if (mkdir(path, 0777) == 0 || errno == EEXIST)
    return CONIC_OK;
  cli_error(CLI_RESOURCE, "%s: cannot write: %s", path, strerror(errno));
  return CONIC_ERROR_IO;
}

static int is_late(const cli_render_job *job) {
  return job->layers.deadline > 0.0 && cli_seconds() > job->layers.start_seconds + job->layers.deadline;
}

/* A picture of the first level, of the first two, …, as long as one more level makes a finer one. */
static conic_status draw_levels(cli_session *session, cli_render_job *job, const conic_camera *camera,
                                conic_image *image, conic_render_statistics *statistics) {
  int n_levels = job->layers.scale.n_levels;
  conic_status status = make_folder(job->layers.progressive_path);
  for (int level = 1; level <= n_levels && status == CONIC_OK; level++) {
    status = draw(session, job, level, camera, image, statistics);
    if (status == CONIC_OK)
      status = write_progress(session, job, level, image);
    job->layers.n_pictures = level;
    if (job->layers.drawn.n_levels < level || is_late(job))
      break;
  }
  return status;
}

conic_status cli_layers_draw(cli_session *session, cli_render_job *job, const conic_camera *camera, conic_image *image,
                             conic_render_statistics *statistics) {
  if (job->layers.progressive_path)
    return draw_levels(session, job, camera, image, statistics);
  return draw(session, job, 0, camera, image, statistics);
}

void cli_layers_close(cli_render_job *job) {
  conic_layers_close(job->layers.file);
  job->layers.file = NULL;
}

void cli_render_layers_report(cli_json *json, const cli_render_job *job) {
  const conic_layers_drawn *d = &job->layers.drawn;
  cli_json_count(json, "clouds_culled", d->n_clouds_culled);
  cli_json_number(json, "error_px", d->error_px);
  cli_json_object(json, "layers");
  cli_json_count(json, "clouds", job->layers.scale.n_clouds);
  cli_json_count(json, "clouds_drawn", d->n_clouds);
  cli_json_count(json, "clouds_grazing", d->n_clouds_grazing);
  cli_json_count(json, "clouds_read", d->n_clouds_read);
  cli_json_count(json, "clouds_missing", d->n_clouds_missing);
  cli_json_count(json, "places", d->n_places);
  cli_json_count(json, "places_hidden", d->n_places_hidden);
  cli_json_count(json, "places_grazing", d->n_places_grazing);
  cli_json_count(json, "places_coarser", d->n_places_coarser);
  cli_json_number(json, "coarser_px", d->missing_error_px);
  cli_json_count(json, "splats_hidden", d->n_splats_left);
  cli_json_count(json, "levels", (uint64_t)d->n_levels);
  cli_json_count(json, "bands", (uint64_t)d->n_bands);
  cli_json_count(json, "bytes_received", d->n_bytes_received);
  if (job->layers.progressive_path)
    cli_json_count(json, "pictures", (uint64_t)job->layers.n_pictures);
  cli_json_close(json);
}
