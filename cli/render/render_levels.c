/* conic render --progressive, --deadline: picture after picture as a source comes in, and within a time. */

#include "cli/render/shot_record.h"
#include "cli/render/units.h"
#include "core/files/disk.h"

/* The deadline counts from the start of the program's work, not of this picture. */
double cli_seconds_left(const cli_render_job *job) {
  double left = job->start_seconds + job->deadline - cli_seconds();
  return left > 1e-3 ? left : 1e-3; /* 0 would be no limit */
}

void cli_deadline_open(cli_render_job *job) {
  if (job->deadline > 0.0)
    job->access.seconds = cli_seconds_left(job);
}

void cli_deadline_begin(cli_render_job *job) {
  if (job->deadline > 0.0)
    job->shot.view.seconds = cli_seconds_left(job);
}

conic_status cli_render_picture(cli_render_job *job, conic_image *image, conic_shot_outcome *outcome) {
  conic_shot_work drawing;
  cli_deadline_begin(job);
  conic_status status = cli_shot_begin(job, &drawing);
  return status == CONIC_OK ? conic_shot_work_draw(&drawing, image, outcome) : status;
}

static conic_status write_progress(cli_session *session, cli_render_job *job, int i_picture, conic_image *image) {
  char path[4096];
  conic_status status = cli_shot_describe(session, job);
  int length = snprintf(path, sizeof path, "%s/%04d.exr", job->progressive_path, i_picture);
  if (length < 0 || (size_t)length >= sizeof path)
    return CONIC_ERROR_IO;
  image->shot = job->making.text;
  return status == CONIC_OK ? conic_image_write_as(session->context, path, image, &job->writing) : status;
}

static conic_status make_folder(const char *path) {
  if (conic_disk_make_folder(path) || errno == EEXIST)
    return CONIC_OK;
  cli_error(CLI_RESOURCE, "%s: cannot write: %s", path, strerror(errno));
  return CONIC_ERROR_IO;
}

/* A picture of the first level, of the first two, …, as long as one more level makes a finer one. */
conic_status cli_render_levels(cli_session *session, cli_render_job *job, conic_image *image,
                               conic_shot_outcome *outcome) {
  int n_levels = conic_source_measure(job->source)->n_levels;
  conic_status status = make_folder(job->progressive_path);
  for (int level = 1; level <= n_levels && status == CONIC_OK; level++) {
    job->shot.view.most_levels = level;
    status = cli_render_picture(job, image, outcome);
    if (status == CONIC_OK)
      status = write_progress(session, job, level, image);
    if (conic_source_chosen(job->source)->n_levels < level || (job->deadline > 0.0 && cli_seconds_left(job) <= 1e-3))
      break;
  }
  job->shot.view.most_levels = 0; /* the last picture has all */
  return status;
}
