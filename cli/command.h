/* The sub-commands, one file each: cli/NAME.c. */
#ifndef CONIC_COMMAND_H
#define CONIC_COMMAND_H

#include "cli/session.h"

/* Whatever a scene is read from. */
#define CLI_READABLE "PLY, XYZ, PTS, CSV, LAS, PCD, OBJ, STL, OFF, glTF, GLB, 3MF, DAE, FBX, .cot, .chy, .lpc"

typedef struct cli_command {
  const char *name;
  const char *summary; /* one line for `conic help` */
  const char *usage;   /* "conic render IN… -o OUT [options]" */
  /* argv[0] is the sub-command's name. Returns the exit code. */
  int (*run)(cli_session *session, int argc, char **argv);
} cli_command;

extern const cli_command cli_make, cli_prepare, cli_octree, cli_layer, cli_mls, cli_hybrid, cli_render, cli_diff,
    cli_info, cli_verify, cli_judge, cli_conformance, cli_explain, cli_chart, cli_bench, cli_devices, cli_convert;

/* The command of that name, or null. */
const cli_command *cli_find_command(const char *name);

#endif
