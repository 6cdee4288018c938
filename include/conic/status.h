/* What a function of conic returns: done, or the kind of failure.
 *
 * The message that says what failed and where goes to the context's log callback (conic/context.h) on the
 * thread that failed, before the function returns. */
#ifndef CONIC_STATUS_H
#define CONIC_STATUS_H

#include "conic/export.h"

CONIC_BEGIN_C

/* The values are pinned: a later version adds to them and never renumbers. */
typedef enum conic_status {
  CONIC_OK = 0,
  /* The caller asked for something without meaning: a null pointer, a size out of range, an unknown name. */
  CONIC_ERROR_ARGUMENT = 10,
  /* An input cannot be used: missing, unreadable, malformed, or with nothing in it to draw. */
  CONIC_ERROR_INPUT = 20,
  /* An allocation failed, or would have passed the context's limit. */
  CONIC_ERROR_MEMORY = 30,
  /* Writing failed: disk full, no permission, network. */
  CONIC_ERROR_IO = 31,
  /* What was asked for is not in this build or not on this machine. */
  CONIC_ERROR_UNSUPPORTED = 32,
  /* The progress callback asked to stop. */
  CONIC_ERROR_CANCELLED = 40
} conic_status;

/* A few English words for `status`; never null. The string is static. */
CONIC_API const char *conic_status_string(conic_status status);

CONIC_END_C
#endif
