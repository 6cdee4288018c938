/* conic-mpi: the program over the ranks of an MPI job. */

#include "cli/arguments.h"
#include "cli/command.h"
#include "cli/session_team.h"
#include "cli/shell.h"
#include "core/base/machine.h"
#include "mpi/ranks.h"
#include "mpi/timeline.h"

/* Whether all ranks work on it: for anything else than a shared command, and for its help, the first does. */
static int is_shared(int argc, char **argv) {
  const cli_command *command = argc > 1 ? cli_find_command(argv[1]) : NULL;
  for (int i = 2; i < argc; i++)
    if (strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-h") == 0)
      return 0;
  return command && command->is_shared;
}

/* "--trace FILE" or "--trace=FILE", which is then gone from the arguments; null where there is none. */
static const char *take_option(int *argc, char **argv, const char *name) {
  const char *value = NULL;
  size_t length = strlen(name);
  int n = 0;
  for (int i = 0; i < *argc; i++)
    if (i > 0 && strcmp(argv[i], name) == 0 && i + 1 < *argc)
      value = argv[++i];
    else if (i > 0 && strncmp(argv[i], name, length) == 0 && argv[i][length] == '=')
      value = argv[i] + length + 1;
    else
      argv[n++] = argv[i];
  argv[ *argc = n] = NULL;
  return value;
}

/* How many ranks work is cut for. */
static int settle_cut(const char *text, const char *trace_path, conic_executor *team) {
  unsigned long long n;
  if (!text)
    return CLI_DONE;
  if (!trace_path || !cli_parse_count(text, &n) || n < 1 || n > CONIC_MOST_IN_TEAM)
    return cli_usage("--trace-ranks: wanted is a number of ranks, 1 to %d, and a --trace", CONIC_MOST_IN_TEAM);
  team->cut_for = (int)n;
  return CLI_DONE;
}

static int run(int argc, char **argv) {
  const char *trace_path = take_option(&argc, argv, "--trace"), *cut = take_option(&argc, argv, "--trace-ranks");
  int threads = conic_machine_threads() / ranks_on_machine();
  conic_executor team;
  conic_team members;
  ranks_fill(&team, &members);
  team.threads = threads > 0 ? threads : 1;
  team.trace = timeline_note;
  const cli_session session = {.team = &team};
  cli_team_join(&team);
  int exit_code = settle_cut(cut, trace_path, &team);
  if (trace_path)
    timeline_begin();
  if (exit_code == CLI_DONE && is_shared(argc, argv))
    exit_code = cli_program(argc, argv, &team);
  else if (exit_code == CLI_DONE && team.index == 0)
    exit_code = cli_program(argc, argv, NULL);
  exit_code = cli_team_agree(&session, exit_code);
  return exit_code == CLI_DONE && trace_path ? timeline_write(trace_path) : exit_code;
}

int main(int argc, char **argv) {
  ranks_begin(&argc, &argv);
  char **arguments = cli_shell_begin(&argc, argv);
  int exit_code = arguments ? run(argc, arguments) : cli_error(CLI_RESOURCE, "out of memory");
  ranks_end();
  return exit_code;
}
