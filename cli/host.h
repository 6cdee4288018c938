/* A program that runs commands within itself, as Python does: what it lends and gets in place of files, and who hears
 * what a shell's user would see. */
#ifndef CONIC_HOST_H
#define CONIC_HOST_H

#include <stddef.h>

#include "conic/conic.h"

/* Something in memory, under the name that the arguments call it by: conic/loan.h. */
typedef struct cli_loan {
  const char *name;
  const void *what;
} cli_loan;

/* What lasts from one run to the next: a context, a renderer, and a few opened sources. One run at a time. */
typedef struct cli_kept cli_kept;

/* Null without memory. */
CONIC_API cli_kept *cli_kept_create(void);
/* Null is allowed. */
CONIC_API void cli_kept_destroy(cli_kept *kept);

/* Functions may be null. They are called on the caller's thread, but for `say`, which any of the context's may call. */
typedef struct cli_host {
  void *cookie;
  /* As the context's options have it: not 0 cancels. */
  int (*progress)(void *cookie, const char *task, double fraction);
  /* A line of a conic_log_level. */
  void (*say)(void *cookie, int level, const char *line);
  /* Asks for arrays for the planes of a frame, with anything in them; not 0: there is no memory. Null: render has no
   * picture to hand over, and needs outputs. */
  int (*lay_out)(void *cookie, int width, int height, unsigned planes, void **arrays);
  /* The frame is drawn. The arrays are the caller's, all else is the run's. */
  void (*take)(void *cookie, int i_frame, const char *view, const conic_image *image, const conic_camera *camera);
  const cli_loan *loans;
  size_t n_loans;
  cli_kept *kept;   /* null: nothing is kept */
  int keeps_source; /* so is what is opened: whoever opens the same files to be read alike has it again */

  /* What came of it. */
  int status;        /* a conic_status: of the failure, where the exit code is above 1 */
  char *json;        /* what --json would have been; the caller frees it by cli_host_release. Null: nothing */
  size_t json_bytes; /* and its length */
} cli_host;

/* Runs the command argv[0] and returns its exit code. Any number of threads may run commands at the same time. Nothing
 * is printed, and no signal is handled. */
CONIC_API int cli_host_run(cli_host *host, int argc, char **argv);
/* Releases the JSON. */
CONIC_API void cli_host_release(cli_host *host);

#endif
