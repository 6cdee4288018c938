/* Which fault would explain the wrong pixels. */
#include "cli/judge/judge_job.h"

conic_status cli_judge_diagnose(cli_session *session, cli_judge_job *job) {
  (void)session;
  job->found.n_faults = 0;
  return CONIC_OK;
}
