/* What nearly every file stands on: the context with its memory, messages, options, threads and clocks, and the C
 * library's numbers, strings, sorting and streams. */
#ifndef CONIC_BASE_H
#define CONIC_BASE_H

#include <errno.h>
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "conic/context.h"
#include "core/base/clock.h"
#include "core/base/memory.h"
#include "core/base/message.h"
#include "core/base/names.h"
#include "core/base/options.h"
#include "core/base/real.h"
#include "core/base/threads.h"

#endif
