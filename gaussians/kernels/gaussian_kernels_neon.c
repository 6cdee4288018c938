#if defined(__aarch64__)
#include "gaussians/kernels/gaussian_body.h"
#else
typedef int conic_not_this_machine;
#endif
