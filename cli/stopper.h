/* Ends a run that was asked to stop and does not: whatever it waits for or works on, a signal is obeyed within a
 * second, and nothing half-written stays. */
#pragma once

#include "conic/conic.h"

/* Begins to watch over a run of `command`, which is to stay; without threads to spare nobody does. A run that is ended
 * has the code that `exit_code` returns. */
void cli_stopper_begin(conic_context *context, const char *command, int (*exit_code)(void));

/* Stops watching; before the context ends. */
void cli_stopper_end(void);

/* Grants the run another third of a second, or, asked again, none. Whether somebody watches. For signal handlers. */
int cli_stopper_ask(void);
