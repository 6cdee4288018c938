#if defined(__x86_64__)
#include "raster/kernels/raster_kernels_body.h"
#else
typedef int conic_not_this_machine;
#endif
