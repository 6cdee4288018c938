/* What the commands that make one file of another share: their arguments, their run, and what they say of it. */
#ifndef CONIC_BUILD_STEPS_H
#define CONIC_BUILD_STEPS_H

#include "cli/arguments.h"
#include "cli/json_write.h"
#include "cli/team_report.h"
#include "cli/tell.h"

/* The first member of a command's job. */
typedef struct cli_build {
  cli_session *session;
  const char *input, *output;
  const char *columns; /* of an input that is text, or null */
  const char *where;   /* which points of it are wanted; null: all */
  int is_in_place;     /* the output is the input */
  cli_stage stages[6]; /* in the order in which they are told; their number is that of the names */
  double total_seconds;
  int is_shared; /* several processes make it, which did: */
  cli_team_report team;
} cli_build;

/* What a command does; each function gets the job. */
typedef struct cli_build_steps {
  int (*make)(void *job);                          /* reads, works and writes; returns the exit code */
  void (*tell)(const void *job);                   /* says by conic_log what was made */
  void (*report)(cli_json *json, const void *job); /* writes the members of --json's object */
  void (*release)(void *job);                      /* after failure, too; may be null */
} cli_build_steps;

/* Reads the arguments of a command with one input, and an output that option -o has put into build->output, and sees
 * to it that they can stand: the output has that ending, and is not the input unless that is to be replaced. Returns as
 * cli_parse. */
int cli_build_parse(cli_build *build, const cli_option *options, int n_options, int argc, char **argv,
                    const char *ending);

/* The option of commands that can replace their input. */
#define CLI_IN_PLACE(build)                                                                                            \
  { "in-place", CLI_FLAG, &(build).is_in_place, NULL, "write over the input, in place of -o, once all is written" }

/* Sets the input, and with --in-place the output. Returns CLI_DONE, or CLI_USAGE after a message. */
int cli_build_take_paths(cli_build *build, const char *input, const char *ending);

/* What of that concerns the output, for any number of inputs. Returns CLI_DONE or, after a message, the exit code. */
int cli_build_check(const cli_build *build, const char *const *inputs, int n_inputs, const char *ending);

/* Refuses points that reach farther out than can be drawn, in the words of conic render. Errors: INPUT. */
conic_status cli_build_check_reach(const cli_build *build, const conic_splats *points);

/* Warns where the input is a mesh, of which the output will only hold what stands for the vertices. */
void cli_build_hint_faces(const cli_build *build, const conic_model *model);

/* Of a command that a team shares, between these two whatever the library shares with a context: `make` calls them
 * where that begins, and when it has ended and nothing is written yet. The second returns what all came to, alone the
 * status itself; only the first process goes on, and where it returns CONIC_OK to the others nothing is left to do. */
void cli_build_share(cli_build *build);
conic_status cli_build_part(cli_build *build, conic_status status);

/* Opens the session, makes the file, says so, and writes --json; nothing where `parsed`, which cli_build_parse
 * returned, is not CLI_DONE. Returns the exit code. */
int cli_build_run(void *job, const cli_build_steps *steps, int parsed);

/* Sets a stage's seconds to those since `start`, and returns the time. */
double cli_build_end_stage(cli_stage *stage, double start);

/* The object "seconds", and what of so many is done a second of the work. */
void cli_build_report_seconds(cli_json *json, const cli_build *build, const char *rate_key, double rate);

#endif
