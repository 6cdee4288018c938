/* Messages to the context's log. */
#pragma once

#include <stdio.h>

#include "conic/context.h"

/* Functions with printf's arguments. MinGW has two kinds; ours is the standard's. */
#if defined(__MINGW_PRINTF_FORMAT)
#define CONIC_AS_PRINTF(format_at, first_at) __attribute__((format(__MINGW_PRINTF_FORMAT, format_at, first_at)))
#else
#define CONIC_AS_PRINTF(format_at, first_at) __attribute__((format(printf, format_at, first_at)))
#endif

/* Logs the formatted line as an error and returns `status`: `return conic_fail(context, CONIC_ERROR_INPUT, "%s: …",
 * …);` %s %d %u %zu %lld %llu %g work as in printf. */
conic_status conic_fail(conic_context *context, conic_status status, const char *format, ...) CONIC_AS_PRINTF(3, 4);
#ifdef __clang_analyzer__ /* which then knows that it fails */
#define conic_fail(context, status, ...) ((void)(conic_fail)(context, status, __VA_ARGS__), (status))
#endif

/* Logs at another level. */
void conic_log(conic_context *context, conic_log_level level, const char *format, ...) CONIC_AS_PRINTF(3, 4);

/* Reports progress of `task` from the calling thread; returns CONIC_ERROR_CANCELLED when the callback asks to stop. */
conic_status conic_progress(conic_context *context, const char *task, double fraction);
