/* conic judge --intermediates: judges what another program has of each Gaussian before it composites. */
#pragma once

#include "cli/arguments.h"

/* Its option, for the command's table, into a const char *. */
#define CLI_INTERMEDIATES_OPTION(path)                                                                                 \
  {                                                                                                                    \
    "intermediates", CLI_TEXT, &(path), "FILE.npz",                                                                    \
        "judge means2d, conics, isect_ids … in the place of a picture, as conic project has them"                    \
  }

/* The command, where --intermediates is among its arguments; returns the exit code. */
int cli_intermediates_run(cli_session *session, int argc, char **argv);
