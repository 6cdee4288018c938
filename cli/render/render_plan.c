/* What a job comes to, as far as its options tell. */
#include "cli/render/frames.h"

int cli_lod_is_wanted(const cli_render_job *job) {
  return job->shot.view.error_px > 0.0 || job->budget > 0;
}

const char *cli_method_name(const cli_render_job *job) {
  return job->is_patch ? "patch" : conic_method_name(job->shot.render.method);
}

int cli_frames_are_many(const cli_render_job *job) {
  return job->is_turntable || job->is_every_view;
}

int cli_frames_are_several(const cli_render_job *job) {
  const cli_frames *frames = &job->frames;
  int is_one = frames->is_given ? frames->last - frames->first < frames->step : job->is_turntable && job->n_frames == 1;
  return cli_frames_are_many(job) && !is_one;
}

int cli_frames_count(const cli_render_job *job) {
  return (job->frames.last - job->frames.first) / job->frames.step + 1;
}
