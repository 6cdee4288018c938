#include "lighting/lighting_loops.h"

CONIC_DEFINE_LOOPS(conic_lighting_loops)
