#if defined(__aarch64__)
#include "gaussians/kernels/ray_lanes.h"
#else
typedef int conic_not_this_machine;
#endif
