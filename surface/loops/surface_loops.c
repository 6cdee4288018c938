#include "surface/loops/surface_loops.h"

CONIC_DEFINE_LOOPS(conic_surface_loops)
