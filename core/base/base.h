/* What nearly every file stands on: the context with its memory, messages, options, threads and clocks, and the C
 * library's numbers, strings, sorting and streams. */
#pragma once

#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "core/base/clock.h"
#include "core/base/memory.h"
#include "core/base/message.h"
#include "core/base/options.h"
#include "core/base/real.h"
#include "core/base/threads.h"

/* Defines const char *FUNCTION(TYPE value): its name of n, in the order of the values; null beyond them. */
/* NOLINTBEGIN(bugprone-macro-parentheses): types and names, which stand bare */
#define CONIC_DEFINE_NAMES(function, type, n, ...)                                                                     \
  const char *function(type value) {                                                                                   \
    static const char *const names[n] = {__VA_ARGS__};                                                                 \
    return (unsigned)value < (n) ? names[value] : NULL;                                                                \
  }
/* NOLINTEND(bugprone-macro-parentheses) */
