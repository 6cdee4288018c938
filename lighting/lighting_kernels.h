/* The loop that takes most of the time of receiving light. */
#ifndef CONIC_LIGHTING_KERNELS_H
#define CONIC_LIGHTING_KERNELS_H

#include "core/lanes/instruction_sets.h"
#include "lighting/light_map.h"

typedef struct conic_lighting_kernels {
  conic_receive_function *receive;
} conic_lighting_kernels;

CONIC_DECLARE_KERNELS(conic_lighting_kernels);

#endif
