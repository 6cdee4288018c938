#if defined(__aarch64__)
#define TABLE conic_surface_kernels_neon
#define NAME "neon"
#include "surface/kernels/surface_kernels_body.h"
#else
typedef int conic_not_this_machine;
#endif
