/* conic: the program, alone. */
#include "cli/host.h"

int main(int argc, char **argv) {
  return cli_host_program(argc, argv);
}
