/* Messages to the context's log. */
#ifndef CONIC_MESSAGE_H
#define CONIC_MESSAGE_H

#include "conic/context.h"

/* Logs the formatted line as an error and returns `status`: `return conic_fail(context, CONIC_ERROR_INPUT, "%s: …",
 * …);` Understands %s %d %u %zu %lld %llu %g as printf does. */
conic_status conic_fail(conic_context *context, conic_status status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Logs at another level. */
void conic_log(conic_context *context, conic_log_level level, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Reports progress of `task` from the calling thread; returns CONIC_ERROR_CANCELLED when the callback asks to stop. */
conic_status conic_progress(conic_context *context, const char *task, double fraction);

#endif
