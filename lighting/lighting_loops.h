/* The loop that takes most of the time of receiving light. */
#ifndef CONIC_LIGHTING_LOOPS_H
#define CONIC_LIGHTING_LOOPS_H

#include "core/lanes/instruction_sets.h"
#include "lighting/light_map.h"

typedef struct conic_lighting_loops {
  conic_receive_function *receive;
} conic_lighting_loops;

CONIC_DECLARE_LOOPS(conic_lighting_loops);

#endif
