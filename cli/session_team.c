#include "cli/session_team.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static cli_team *own_team;
static int is_agreeing, agreed_failure;
static char first_error[2048];
static uint64_t n_units;
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
  if (!all) /* whoever makes a team ends it where there is no memory */
    all = malloc(total ? total : 1);
  if (!all)
    abort();
  team->broadcast(all, total);
  return all;
}

/* One loop is a unit of each process: they are told by their numbers. */
static void note_loop(void *data, const char *kind, const char *name, double start) {
  const cli_team *team = data;
  double now = cli_seconds();
  team->trace(kind, name, n_units++, start, now, 0);
  busy_seconds += now - start;
}

void cli_team_count_loops(uint64_t *units, double *seconds) {
  *units = n_units;
  *seconds = busy_seconds;
}

const conic_team *cli_team_of_library(const cli_session *session, conic_team *team) {
  if (!cli_team_is_shared(session))
    return NULL;
  *team = (conic_team){session->team->index, session->team->count, session->team, send_bytes,
                       receive_bytes,        release_bytes,        collect_bytes, note_loop};
  return team;
}

int cli_team_is_first(const cli_session *session) {
  return !session->team || session->team->index == 0;
}

void cli_team_trace(const cli_session *session, const char *kind, const char *name, uint64_t number, double from,
                    uint64_t sent_bytes) {
  if (session->team)
    session->team->trace(kind, name, number, from, cli_seconds(), sent_bytes);
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
