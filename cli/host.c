#include "cli/host.h"

#include "cli/command.h"

int cli_host_run(cli_host *host, int argc, char **argv) {
  const cli_command *command = argc > 0 ? cli_find_command(argv[0]) : NULL;
  cli_session session = {.command = command ? command->name : "conic", .host = host, .json_path = "-"};
  host->status = CONIC_OK;
  cli_session_host(&session);
  int exit_code =
      command ? command->run(&session, argc, argv) : cli_usage("there is no command '%s'", argc > 0 ? argv[0] : "");
  if (exit_code == CLI_RESOURCE && host->status == CONIC_OK)
    host->status = CONIC_ERROR_IO; /* outputs that cannot be written are found before the library is asked */
  cli_session_close(&session);
  cli_session_host(NULL);
  return exit_code;
}
