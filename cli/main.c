/* conic: the program, alone. */
#include "cli/command.h"
#include "cli/shell.h"

int main(int argc, char **argv) {
  char **arguments = cli_shell_begin(&argc, argv);
  return arguments ? cli_program(argc, arguments, NULL) : cli_error(CLI_RESOURCE, "out of memory");
}
