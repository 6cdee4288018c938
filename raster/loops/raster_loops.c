#include "raster/loops/raster_loops.h"

CONIC_DEFINE_LOOPS(conic_raster_loops)
