#include "cli/session_team.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static cli_team *own_team;
static int is_agreeing, agreed_failure;
static char first_error[2048];
static uint64_t n_stages;
static double busy_seconds;

void cli_team_join(cli_team *team) {
  own_team = team && team->count > 1 ? team : NULL;
}

int cli_team_keeps(conic_log_level level, const char *message) {
  if (!own_team || is_agreeing)
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

/* --- the library's team --- */

static void send_bytes(void *data, int to, const void *bytes, size_t n_bytes) {
  const cli_team *team = data;
  team->send(to, bytes, n_bytes);
}

static void *receive_bytes(void *data, int from, size_t *n_bytes) {
  const cli_team *team = data;
  return team->receive(from, n_bytes);
}

static void release_bytes(void *data, void *bytes) {
  (void)data;
  free(bytes);
}

/* Gathered in the first process, and from there to all. */
static void *collect_bytes(void *data, const void *bytes, size_t n_bytes, size_t *sizes) {
  const cli_team *team = data;
  size_t total = 0;
  char *all = team->gather(bytes, n_bytes, sizes);
  team->broadcast(sizes, (size_t)team->count * sizeof *sizes);
  for (int i = 0; i < team->count; i++)
    total += sizes[i];
  if (team->index > 0)
    all = malloc(total ? total : 1);
  if (!all) /* whoever makes a team ends it where there is no memory */
    abort();
  team->broadcast(all, total);
  return all;
}

/* What was waited for others since the last stage is noted, too, as if it had all come last. */
static void note_stage(void *data, const char *name, conic_moment from, uint64_t number) {
  static uint64_t sent_before;
  static double waited_before;
  const cli_team *team = data;
  uint64_t sent_bytes, received_bytes;
  double waited;
  conic_moment now = conic_moment_now();
  team->count_traffic(&sent_bytes, &received_bytes, &waited);
  double took = now.clock_s - from.clock_s, waited_now = waited - waited_before < took ? waited - waited_before : took;
  team->trace("stage", name, number, from, now, sent_bytes - sent_before);
  team->trace("wait", name, number, (conic_moment){now.clock_s - waited_now, now.processor_s}, now, 0);
  sent_before = sent_bytes;
  waited_before = waited;
  n_stages++;
  busy_seconds += took - waited_now;
}

void cli_team_count_stages(uint64_t *n, double *seconds) {
  *n = n_stages;
  *seconds = busy_seconds;
}

const conic_team *cli_team_of_library(const cli_session *session, conic_team *team) {
  if (!cli_team_is_shared(session))
    return NULL;
  *team = (conic_team){session->team->index, session->team->count, session->team, send_bytes,
                       receive_bytes,        release_bytes,        collect_bytes, note_stage};
  return team;
}

int cli_team_is_first(const cli_session *session) {
  return !session->team || session->team->index == 0;
}

void cli_team_trace(const cli_session *session, const char *kind, const char *name, uint64_t number, conic_moment from,
                    uint64_t sent_bytes) {
  if (session->team)
    session->team->trace(kind, name, number, from, conic_moment_now(), sent_bytes);
}

int cli_team_agree(const cli_session *session, int exit_code) {
  if (!cli_team_is_shared(session))
    return exit_code;
  if (agreed_failure)
    return agreed_failure;
  exit_code = session->team->agree(exit_code, first_error, sizeof first_error);
  if (exit_code < CLI_USAGE)
    return exit_code;
  agreed_failure = exit_code;
  is_agreeing = 1;
  if (session->team->index == 0 && first_error[0])
    cli_error(exit_code, "%s", first_error);
  is_agreeing = 0;
  return exit_code;
}

int cli_team_exit(const cli_session *session, conic_status status) {
  int own = cli_exit_of(status);
  if (!cli_team_is_shared(session))
    return own;
  int agreed = cli_team_agree(session, status == CONIC_ERROR_CANCELLED ? CLI_DONE : own);
  return agreed == CLI_DONE ? own : agreed;
}
