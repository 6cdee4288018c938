#if defined(__aarch64__)
#include "gaussians/loops/gaussian_body.h"
#else
typedef int conic_not_this_machine;
#endif
