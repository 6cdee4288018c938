/* What each process of a team (cli/session_team.h) had to do with a command, for --json. */
#ifndef CONIC_TEAM_SHARES_H
#define CONIC_TEAM_SHARES_H

#include "cli/json_write.h"
#include "cli/session.h"

typedef struct cli_team_share {
  uint64_t n_units, sent_bytes, received_bytes, peak_bytes;
  double waited_seconds, busy_seconds;
} cli_team_share;

typedef struct cli_team_shares {
  cli_team_share *of; /* by process */
  int n;              /* 0: nothing is said */
} cli_team_shares;

/* Collective, where the work was shared and has succeeded: the first process gets what all did, which it releases;
 * this one did so many units in so long. */
void cli_team_shares_gather(const cli_session *session, uint64_t n_units, double busy_seconds, cli_team_shares *shares);
void cli_team_shares_release(cli_team_shares *shares);

/* The object "team", if there is something to say; `what` was shared: "frames". */
void cli_team_shares_report(cli_json *json, const char *what, const cli_team_shares *shares);

#endif
