/* conic judge --gradients: judges another program's derivative of a picture. */
#pragma once

#include "cli/arguments.h"

typedef struct cli_gradient_files {
  const char *gradients, *weights;
  int is_raw;
} cli_gradient_files;

/* Its options, for the command's table. */
#define CLI_GRADIENT_OPTIONS(files)                                                                                    \
  {"gradients", CLI_TEXT, &(files).gradients, "FILE",                                                                  \
   "judge a derivative, in the place of a picture: .ply as conic gradient's, or .npz"},                                \
      {"weights",                                                                                                      \
       CLI_TEXT,                                                                                                       \
       &(files).weights,                                                                                               \
       "FILE",                                                                                                         \
       "of --gradients: W of L = sum W C, as conic gradient has it",                                                   \
       .acts.with = "gradients"},                                                                                      \
  {                                                                                                                    \
    "raw", CLI_FLAG, &(files).is_raw, NULL, "of --gradients: they are by ln s and logit o", .acts.with = "gradients"   \
  }

/* The command, where --gradients is among its arguments; returns the exit code. */
int cli_gradients_run(cli_session *session, int argc, char **argv);
