/* Several processes that run one command together, each with all of its arguments, as conic-mpi's ranks do: a
 * conic_executor of the session's. The first one, number 0, speaks for all. A command that knows teams shares out units
 * of its work; who does which unit decides no bit of what comes out.
 *
 * Collective functions are called by every process of the team in the same order. So whoever failed comes to the next
 * cli_team_agree, too, and after one that returned a failure there are no collective functions any more. */
#pragma once

#include "cli/session.h"
#include "shots/executor.h"

/* The team of this process from now on, which is to stay, and whose messages it keeps. Fills in what the program has to
 * say: its `agree` and `did`, and the library's `note`. */
void cli_team_join(conic_executor *team);

/* Whether there are others to share the work with. */
int cli_team_is_shared(const cli_session *session);
/* The same processes, as what the library builds by several takes them; null where nobody shares the work. */
const conic_team *cli_team_of(const cli_session *session);
/* What an executor that is alone does is noted as this process's. */
void cli_team_watch(conic_executor *alone);

/* Does what the team's function does, if there is a team. */
void cli_team_trace(const cli_session *session, const char *kind, const char *name, uint64_t number, conic_moment from,
                    uint64_t sent_bytes);
/* Collective: the exit code of what all came to; where a process was only told that another failed, its own does not
 * count. */
int cli_team_exit(const cli_session *session, conic_status status);
/* Collective: the greatest exit code of all, whose message the first process prints; alone, the code itself. After a
 * failure it is that failure at once. */
int cli_team_agree(const cli_session *session, int exit_code);

/* What this process did: units of the work, or what the library has noted. */
typedef struct cli_team_work {
  uint64_t n;
  double busy_seconds;
} cli_team_work;

cli_team_work cli_team_units(void);
cli_team_work cli_team_stages(void);
