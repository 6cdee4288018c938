/* What nearly every file stands on: the context with its memory, messages, options and threads, and the C library's
 * numbers and strings. */
#ifndef CONIC_BASE_H
#define CONIC_BASE_H

#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "conic/context.h"
#include "core/base/memory.h"
#include "core/base/message.h"
#include "core/base/options.h"
#include "core/base/real.h"
#include "core/base/threads.h"

#endif
