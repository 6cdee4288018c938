#include "cli/scene/shot_job.h"

#include "cli/scene/render_job.h"

int cli_shot_is_again(const cli_session *session, const cli_render_job *job) {
  if (!job->is_for_looking || session->again || session->host)
    return 0;
  for (int i = 0; i < job->n_inputs; i++)
    if (conic_shot_is_file(job->inputs[i]))
      return 1;
  return job->making.again_path != NULL;
}
