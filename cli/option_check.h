/* Whether options change anything: by the facts and the other options on which each has an effect (cli_option.acts). */
#pragma once

#include "cli/arguments.h"

/* Options that were given, and parts of their values that have an effect of their own. */
enum { CLI_MOST_GIVEN = 160 };
typedef struct cli_given {
  const char *dashes, *name;
  cli_effect acts;
} cli_given;

typedef struct cli_effects_job {
  cli_given given[CLI_MOST_GIVEN];
  int n_given;
  int is_strict;               /* what would be a warning is wrong usage, too */
  cli_facts asked;             /* facts of what is asked for */
  cli_facts certain, possible; /* facts of what is read: those that hold, and those that may */
} cli_effects_job;

/* Notes one, or those of a table that cli_parse_noting has found. */
void cli_effects_add(cli_effects_job *own, const char *dashes, const char *name, const cli_effect *acts);
void cli_effects_note(cli_effects_job *own, const cli_option *table, int n, const char *const *values);

/* Wrong usage, or a warning, of each that has no effect by the facts that are known; each is said once, though more may
 * be known later. `remedy` says what to do where what is read, `input`, has none of these facts; it may be null. */
int cli_effects_check_given(const cli_session *session, cli_effects_job *own, const char *input,
                            const char *(*remedy)(const cli_effects_job *own, cli_facts lacked));

/* The same of `with`, as soon as the arguments are read. */
int cli_effects_check_with(const cli_session *session, const cli_option *table, int n, const char *const *values,
                           const char *const *positional, int n_positional);

/* A fact in a word, for the help. */
const char *cli_fact_name(int fact);
