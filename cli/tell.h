/* What --verbose adds on standard error, in the same words from every command. Other lines go there by conic_log with
 * CONIC_LOG_INFO. */
#pragma once

#include "cli/session.h"

/* A stage and what it took; below 0: there was none. */
typedef struct cli_stage {
  const char *name;
  double seconds;
  const char *key; /* in JSON; null: the name */
  double parts;    /* of the seconds, what other stages are about */
} cli_stage;

/* What of the whole belongs to none of the stages. */
double cli_other_seconds(const cli_stage *stages, int n_stages, double whole_seconds);

/* The stages in their order, what else there was, and what they are together: "a frame", "in all". */
void cli_tell_stages(cli_session *session, const cli_stage *stages, int n_stages, const char *whole,
                     double whole_seconds);

/* The same for all of a run, with the memory that it took. */
void cli_tell_run(cli_session *session, const cli_stage *stages, int n_stages, double total_seconds);
