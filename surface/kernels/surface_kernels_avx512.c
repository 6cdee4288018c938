#if defined(__x86_64__)
#define TABLE conic_surface_kernels_avx512
#define NAME "avx512"
#include "surface/kernels/surface_kernels_body.h"
#else
typedef int conic_not_this_machine;
#endif
