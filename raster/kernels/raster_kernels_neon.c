#if defined(__aarch64__)
#define TABLE conic_tile_kernels_neon
#define NAME "neon"
#include "raster/kernels/tile_kernels_body.h"
#else
typedef int conic_not_this_machine;
#endif
