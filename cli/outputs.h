/* What a run writes, asked about before the work: whether it can be written, and what it would be written over. */
#pragma once

#include "cli/session.h"

/* Wrong usage where two of the run's outputs (null entries are fine), --json's included, go to standard output or, by
 * whatever names, to the same file; CLI_RESOURCE where the folder that one would stand in is not there or may not be
 * written to. Returns CLI_DONE, or one of these after a message. */
int cli_check_outputs(const cli_session *session, const char *const *paths, int n_paths);

/* Wrong usage where one of the outputs (null entries are fine), or --json's, is one of the inputs: for outputs of
 * another kind than the inputs. Returns CLI_DONE, or CLI_USAGE after a message. */
int cli_check_inputs_stay(const cli_session *session, const char *const *inputs, int n_inputs,
                          const char *const *outputs, int n_outputs);

/* Wrong usage where the ending of an output's name (null is fine) is that of another kind of file than `ending`, say a
 * picture's: what stands there was hardly meant to be written over. Returns CLI_DONE, or CLI_USAGE after a message. */
int cli_check_ending(const char *path, const char *ending);

/* Adds to a picture's header, where there is room, a text or, where that is null, a number. */
void cli_name_attribute(conic_image *image, const char *name, const char *text, double value);
