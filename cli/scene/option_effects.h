/* Whether the options of a picture change anything, and go together: by the facts on which each has an effect. */
#ifndef CONIC_OPTION_EFFECTS_H
#define CONIC_OPTION_EFFECTS_H

#include "cli/arguments.h"

struct cli_render_job;
struct cli_scene_words;

/* Options that were given, and parts of their values that have an effect of their own. */
enum { CLI_MOST_GIVEN = 160 };
typedef struct cli_given {
  const char *dashes, *name;
  cli_effect acts;
} cli_given;

/* Part of a cli_render_job. */
typedef struct cli_effects_job {
  cli_given given[CLI_MOST_GIVEN];
  int n_given;
  unsigned long long asked;             /* facts of what is asked for */
  unsigned long long certain, possible; /* facts of what is drawn: those that hold, and those that may */
} cli_effects_job;

/* Notes the options of a table that cli_parse_noting has found. */
void cli_effects_note(cli_effects_job *own, const cli_option *table, int n, const char *const *values);

/* Wrong usage, or a warning, of what has no effect or does not go together: once the options are parsed and the inputs
 * are told by their first bytes, and again once the scene is open. */
int cli_effects_check(const cli_session *session, const struct cli_scene_words *words, struct cli_render_job *job);
int cli_effects_check_open(const cli_session *session, struct cli_render_job *job);

/* A fact in words, for the help. */
const char *cli_fact_name(int fact);

#endif
