#include "cli/render/sample_options.h"

#include "cli/render/fill_shot.h"
#include "shots/way.h"

int cli_sample_frame(const cli_render_job *job) {
  return job->frames.first - 1;
}

int cli_sample_check(const cli_session *session, cli_render_job *job) {
  static const char *const no_paths[1] = {NULL};
  cli_accumulate_job *own = &job->accumulating;
  const char *command = session->command;
  int is_one_of_many = own->n_samples > 0 || own->is_sample_given;
  int answer = cli_frames_check(session, job, no_paths, 1);
  if (answer != CLI_DONE)
    return answer;
  if (!job->frames.is_given)
    job->frames.last = job->frames.first;
  if (cli_frames_count(job) != 1)
    return cli_usage("%s: it looks at one picture; --frames takes one number here", command);
  if (!is_one_of_many)
    return CLI_DONE;
  cli_shot_take_options(job);
  return cli_accumulate_settle(session, job);
}

conic_status cli_sample_camera(cli_session *session, cli_render_job *job, conic_camera *camera) {
  const cli_accumulate_job *own = &job->accumulating;
  conic_sample sample;
  conic_status status = cli_shot_fill(session, job, cli_sample_frame(job));
  if (status != CONIC_OK || !own->is_sample_given) {
    *camera = job->shot.camera;
    return status;
  }
  status = conic_shot_focus(job->source, job->renderer, &job->shot);
  if (status == CONIC_OK)
    status = conic_shot_sample(job->source, &job->shot, own->i_sample, &sample);
  *camera = sample.camera;
  if (job->abilities & CONIC_SOURCE_MIXES)
    conic_sample_see(own->i_sample, 1, &job->shot.view);
  return status;
}
