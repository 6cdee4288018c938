#include "lighting/lighting_kernels.h"

CONIC_DEFINE_KERNELS(conic_lighting_kernels)
