#include "cli/session_team.h"

#include <pthread.h>

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static const conic_executor *own_team; /* null: this process is alone */
static conic_team members;             /* the library's */
static int is_agreeing, agreed_failure;
static char first_error[2048];
static cli_team_work units, stages;

/* An error is printed once all have agreed; what else others than the first process say is not printed. */
static int hold_message(conic_log_level level, const char *message) {
  if (!own_team || own_team->count < 2 || is_agreeing)
    return 0;
  if (level != CONIC_LOG_ERROR)
    return own_team->index > 0;
  pthread_mutex_lock(&lock);
  if (first_error[0] == '\0')
    snprintf(first_error, sizeof first_error, "%s", message);
  pthread_mutex_unlock(&lock);
  return 1;
}

int cli_team_is_shared(const cli_session *session) {
  return session->team && session->team->count > 1;
}

const conic_team *cli_team_of(const cli_session *session) {
  return cli_team_is_shared(session) ? session->team->team : NULL;
}

void cli_team_trace(const cli_session *session, const char *kind, const char *name, uint64_t number, conic_moment from,
                    uint64_t sent_bytes) {
  if (session->team)
    session->team->trace(session->team->data, kind, name, number, from, sent_bytes);
}

/* --- what all came to --- */

static int agree_codes(const conic_executor *team, int exit_code) {
  if (agreed_failure)
    return agreed_failure;
  exit_code = team->worst(team->data, exit_code, first_error, sizeof first_error);
  if (exit_code < CLI_USAGE)
    return exit_code;
  agreed_failure = exit_code;
  is_agreeing = 1;
  if (team->index == 0 && first_error[0])
    cli_error(exit_code, "%s", first_error);
  is_agreeing = 0;
  return exit_code;
}

int cli_team_agree(const cli_session *session, int exit_code) {
  return cli_team_is_shared(session) ? agree_codes(session->team, exit_code) : exit_code;
}

int cli_team_exit(const cli_session *session, conic_status status) {
  int own = cli_exit_of(status);
  if (!cli_team_is_shared(session))
    return own;
  int agreed = cli_team_agree(session, status == CONIC_ERROR_CANCELLED ? CLI_DONE : own);
  return agreed == CLI_DONE ? own : agreed;
}

static conic_status agree_statuses(void *unused, conic_status status) {
  int exit_code = agree_codes(own_team, cli_exit_of(status));
  (void)unused;
  return status != CONIC_OK || exit_code == CLI_DONE ? status : CONIC_ERROR_CANCELLED;
}

/* --- what this process did --- */

static void trace_own(void *unused, const char *kind, const char *name, uint64_t number, conic_moment since,
                      uint64_t bytes) {
  (void)unused;
  own_team->trace(own_team->data, kind, name, number, since, bytes);
}

static void note_unit(void *unused, const char *name, uint64_t number, conic_moment since, uint64_t handed_bytes) {
  units.n++;
  units.busy_seconds += cli_seconds() - since.clock_s;
  trace_own(unused, "unit", name, number, since, handed_bytes);
}

/* What was waited for others since the last stage is noted, too, as if it had all come last. */
static void note_stage(void *unused, const char *name, conic_moment from, uint64_t number) {
  static uint64_t sent_before;
  static double waited_before;
  uint64_t sent_bytes, received_bytes;
  double waited;
  conic_moment now = conic_moment_now();
  own_team->count_traffic(own_team->data, &sent_bytes, &received_bytes, &waited);
  double took = now.clock_s - from.clock_s, waited_now = waited - waited_before < took ? waited - waited_before : took;
  trace_own(unused, "stage", name, number, from, sent_bytes - sent_before);
  trace_own(unused, "wait", name, number, (conic_moment){now.clock_s - waited_now, now.processor_s}, 0);
  sent_before = sent_bytes;
  waited_before = waited;
  stages.n++;
  stages.busy_seconds += took - waited_now;
}

cli_team_work cli_team_units(void) {
  return units;
}

cli_team_work cli_team_stages(void) {
  return stages;
}

void cli_team_watch(conic_executor *alone) {
  if (!own_team)
    return;
  alone->did = note_unit;
  alone->trace = trace_own;
}

void cli_team_join(conic_executor *team) {
  own_team = team;
  cli_session_hold(hold_message);
  team->agree = agree_statuses;
  team->did = note_unit;
  if (!team->team)
    return;
  members = *team->team;
  members.note = note_stage;
  team->team = &members;
}
