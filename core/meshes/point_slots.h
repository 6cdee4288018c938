/* Points of a model by their place, colour and alpha, so that equal vertices become one. */
#pragma once

#include "core/splats/builder.h"

/* Zero before the first use; `slots` is released by the caller. */
typedef struct conic_point_slots {
  uint32_t *slots; /* a point + 1; 0: none */
  size_t n;        /* a power of two */
} conic_point_slots;

/* Makes room for so many points. Errors: MEMORY. */
conic_status conic_point_slots_reserve(conic_builder *builder, conic_point_slots *slots, size_t count);

/* The point that is like the next one of the model, whose values are there: an earlier one, or this one, which then
 * counts. There is room for it. */
uint32_t conic_point_slots_join(conic_builder *builder, conic_point_slots *slots);
