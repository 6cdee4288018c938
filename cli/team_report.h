/* What each process of a team (cli/session_team.h) had to do with a command, for --json. */
#pragma once

#include "cli/json_write.h"
#include "cli/session_team.h"

typedef struct cli_team_part {
  uint64_t n_units, sent_bytes, received_bytes, peak_bytes;
  double waited_seconds, busy_seconds;
} cli_team_part;

typedef struct cli_team_report {
  cli_team_part *of; /* by process */
  int n;             /* 0: nothing is said */
} cli_team_report;

/* Collective, where the work was shared and has succeeded: what all did, of which this process did so much. The caller
 * releases it. */
void cli_team_report_gather(const cli_session *session, cli_team_work work, cli_team_report *report);
void cli_team_report_release(cli_team_report *report);

/* The object "team", if there is something to say; `what` was shared: "frames". */
void cli_team_report_write(cli_json *json, const char *what, const cli_team_report *report);
