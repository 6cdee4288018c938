#if defined(__x86_64__)
#include "surface/loops/surface_loops_body.h"
#else
typedef int conic_not_this_machine;
#endif
