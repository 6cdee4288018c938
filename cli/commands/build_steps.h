/* What commands that make one file from another share: their arguments, their steps, and their messages. */
#pragma once

#include "cli/option_check.h"
#include "cli/team_report.h"
#include "cli/tell.h"

/* The first member of a command's job. */
typedef struct cli_build {
  cli_session *session;
  const char *input, *output;
  const char *columns;     /* of a text input; or null */
  const char *where;       /* which points of it are read; null: all */
  int colors_are;          /* what its colours mean, as in conic_read_options */
  int is_in_place;         /* the output replaces the input */
  cli_effects_job effects; /* of the options that were given */
  cli_stage stages[6];     /* in the order of the report; the names end their number */
  double total_seconds;
  int is_shared; /* several processes make it; the report on them is: */
  cli_team_report team;
} cli_build;

/* The steps of a command; each function gets the job. */
typedef struct cli_build_steps {
  int (*make)(void *job);                          /* reads, works and writes; returns the exit code */
  void (*tell)(const void *job);                   /* logs by conic_log what was made */
  void (*report)(cli_json *json, const void *job); /* writes the members of --json's object */
  void (*release)(void *job);                      /* after a failure, too; may be null */
} cli_build_steps;

/* Reads the arguments of a command with one input and one output, which option -o has put into build->output. Checks
 * that the output has that ending, and is not the input unless it replaces that. Returns as cli_parse. */
int cli_build_parse(cli_build *build, const cli_option *options, int n_options, int argc, char **argv,
                    const char *ending);

/* cli_parse, which notes the options for cli_build_know. */
int cli_build_arguments(cli_build *build, const cli_option *options, int n_options, int argc, char **argv,
                        const char **positional, int *n_positional);

/* The defaults, and what the arguments say of the input. */
void cli_build_reading(const cli_build *build, conic_read_options *options);

/* Refuses, or warns of, options that act on none of the facts of what is read. Errors: ARGUMENT. */
conic_status cli_build_know(cli_build *build, cli_facts possible);
/* The facts of a model that was read; and those that a file may have whose points are read in parts. */
cli_facts cli_build_facts(const conic_model *model);
cli_facts cli_build_facts_of_file(const cli_build *build, const char *path);

/* The option of commands whose output can replace the input. */
#define CLI_IN_PLACE(build)                                                                                            \
  { "in-place", CLI_FLAG, &(build).is_in_place, NULL, "write over the input, in place of -o, once all is written" }

/* Sets the input, and with --in-place the output. Returns CLI_DONE, or CLI_USAGE after a message. */
int cli_build_take_paths(cli_build *build, const char *input, const char *ending);

/* Checks the output against any number of inputs. Returns CLI_DONE or, after a message, the exit code. */
int cli_build_check(const cli_build *build, const char *const *inputs, int n_inputs, const char *ending);

/* conic_leave_far_points of the input. Errors: INPUT. */
conic_status cli_build_leave_far(const cli_build *build, conic_splats *points);

/* Warns where the input is a mesh, because the output only holds splats for its vertices. */
void cli_build_hint_faces(const cli_build *build, const conic_model *model);

/* For a command that a team shares: between these two calls, a context shares the library's work with the team. `make`
 * calls the first where that work begins, and the second when it has ended, before anything is written. The second
 * returns the status that all agreed on; without a team, the given one. Only the first process goes on; the others get
 * a status that leaves them nothing to do, or CONIC_OK when they are done. */
void cli_build_share(cli_build *build);
conic_status cli_build_part(cli_build *build, conic_status status);

/* Opens the session, makes the file, reports on it, and writes --json. Does nothing unless `parsed`, the result of
 * cli_build_parse, is CLI_DONE. Returns the exit code. */
int cli_build_run(void *job, const cli_build_steps *steps, int parsed);

/* Sets a stage's seconds to those since `start`, and returns the time. */
double cli_build_end_stage(cli_stage *stage, double start);

/* Writes the object "seconds", the rate of the work under `rate_key`, and the memory. */
void cli_build_report_cost(cli_json *json, const cli_build *build, const char *rate_key, double rate);
