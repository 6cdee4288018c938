#if defined(__x86_64__)
#define TABLE conic_tile_kernels_avx2
#define NAME "avx2"
#include "raster/kernels/tile_kernels_body.h"
#else
typedef int conic_not_this_machine;
#endif
