#include "cli/session_team.h"

#include <pthread.h>
#include <string.h>

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static cli_team *own_team;
static int is_agreeing, agreed_failure;
static char first_error[2048];

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
