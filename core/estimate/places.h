/* Which of many positions are the same. */
#pragma once

#include "core/base/base.h"

/* For each of n positions, fewer than 2³², the first one that equals it: itself, where none before it does. A NaN
 * equals none. Errors: MEMORY. */
conic_status conic_places_find(conic_context *context, const float *const position[3], size_t n, uint32_t *place);
