/* The program, but for its main: finds the sub-command and hands over. */

#include "cli/command.h"

static void print_features(const char *label, int available) {
  fputs(label, stdout);
  int n_printed = 0;
  for (int i = 0; conic_feature_at(i); i++)
    if (conic_feature_at(i)->available == available)
      n_printed += printf(" %s", conic_feature_at(i)->name) > 0;
  puts(n_printed ? "" : " none");
}

static int print_version(void) {
  printf("conic %s\n", conic_version());
  puts("License: BSD-3-Clause. There is no warranty.");
  print_features("In this build:", 1);
  print_features("Not in this build:", 0);
  return CLI_DONE;
}

static int run_command(int argc, char **argv, const struct conic_executor *team) {
  const cli_command *command = cli_find_command(argv[0]);
  if (!command)
    return cli_refuse_command(argv[0]);
  cli_session session = {.command = command->name, .team = team};
  int exit_code = command->run(&session, argc, argv);
  for (int i = 0; i < 8 && exit_code < CLI_USAGE && session.old_spellings[i].name; i++)
    cli_note(&session, "%s: --%s is now %s", session.command, session.old_spellings[i].name,
             session.old_spellings[i].now);
  cli_session_close(&session);
  return exit_code;
}

static int run(int argc, char **argv, const struct conic_executor *team) {
  if (argc < 2) {
    cli_help_usage(stderr);
    return CLI_USAGE;
  }
  if (strcmp(argv[1], "help") == 0 || strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0)
    return cli_help(argc - 1, argv + 1);
  if (strcmp(argv[1], "--version") == 0 || strcmp(argv[1], "-V") == 0)
    return print_version();
  return run_command(argc - 1, argv + 1, team);
}

int cli_program(int argc, char **argv, const struct conic_executor *team) {
  int exit_code = run(argc, argv, team);
  errno = 0;
  if ((fflush(stdout) != 0 || ferror(stdout)) && exit_code < CLI_USAGE)
    exit_code =
        cli_error(CLI_RESOURCE, "standard output: cannot write: %s", errno ? strerror(errno) : "the device failed");
  return cli_exit_after_signals(exit_code);
}
