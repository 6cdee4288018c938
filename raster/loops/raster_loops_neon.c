#if defined(__aarch64__)
#include "raster/loops/raster_loops_body.h"
#else
typedef int conic_not_this_machine;
#endif
