/* What two pictures say of how they were made, where both do. */
#pragma once

#include "cli/json_write.h"
#include "cli/session.h"

typedef struct cli_diff_shots {
  conic_shot_file *shots[2]; /* both null: at least one says nothing */
} cli_diff_shots;

/* Reads both; one that this version does not understand says nothing. Errors: INPUT, MEMORY. */
conic_status cli_diff_shots_read(const cli_session *session, const char *const paths[2], cli_diff_shots *shots);
void cli_diff_shots_release(const cli_session *session, cli_diff_shots *shots);

/* The key "shot": the fields that differ. Errors: MEMORY. */
conic_status cli_diff_shots_report(cli_json *json, const cli_session *session, const cli_diff_shots *shots);
/* The same on standard output, a line each. */
void cli_diff_shots_print(const cli_session *session, const cli_diff_shots *shots);
