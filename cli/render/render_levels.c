/* conic render --progressive, --deadline: picture after picture as a source comes in, and within a time. */
#include <errno.h>
#include <string.h>

#include "cli/render/gather_picture.h"
#include "cli/render/lit_picture.h"
#include "cli/render/sharing.h"
#include "cli/scene/backdrop.h"
#include "core/files/disk.h"

/* The deadline counts from the start of the program's work, not of this picture. */
static double seconds_left(const cli_render_job *job) {
  double left = job->start_seconds + job->deadline - cli_seconds();
  return left > 1e-3 ? left : 1e-3; /* 0 would be no limit */
}

void cli_deadline_open(cli_render_job *job) {
  if (job->deadline > 0.0)
    job->access.seconds = seconds_left(job);
}

conic_status cli_render_picture(cli_session *session, cli_render_job *job, const conic_camera *camera,
                                conic_image *image, conic_render_statistics *statistics) {
  if (job->deadline > 0.0)
    job->view.seconds = seconds_left(job);
  const cli_looking looking = {camera, &job->options, &job->view, NULL};
  conic_status status = cli_draw_looking(session, job, &looking, image, statistics);
  if (status == CONIC_OK)
    status = cli_light_picture(session, job, camera, image);
  if (status == CONIC_OK && cli_sharing_has_picture(session, job))
    cli_backdrop_show(job, image);
  return status;
}

static conic_status write_progress(cli_session *session, const cli_render_job *job, int i_picture,
                                   const conic_image *image) {
  char path[4096];
  int length = snprintf(path, sizeof path, "%s/%04d.exr", job->progressive_path, i_picture);
  if (length < 0 || (size_t)length >= sizeof path)
    return CONIC_ERROR_IO;
  return conic_image_write_as(session->context, path, image, &job->writing);
}

static conic_status make_folder(const char *path) {
  if (conic_disk_make_folder(path) || errno == EEXIST)
    return CONIC_OK;
  cli_error(CLI_RESOURCE, "%s: cannot write: %s", path, strerror(errno));
  return CONIC_ERROR_IO;
}

/* A picture of the first level, of the first two, …, as long as one more level makes a finer one. */
conic_status cli_render_levels(cli_session *session, cli_render_job *job, const conic_camera *camera,
                               conic_image *image, conic_render_statistics *statistics) {
  int n_levels = conic_source_measure(job->source)->n_levels;
  conic_status status = make_folder(job->progressive_path);
  for (int level = 1; level <= n_levels && status == CONIC_OK; level++) {
    job->view.most_levels = level;
    status = cli_render_picture(session, job, camera, image, statistics);
    if (status == CONIC_OK)
      status = write_progress(session, job, level, image);
    if (conic_source_chosen(job->source)->n_levels < level || (job->deadline > 0.0 && seconds_left(job) <= 1e-3))
      break;
  }
  return status;
}
