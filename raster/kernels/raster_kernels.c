#include "raster/kernels/raster_kernels.h"

CONIC_DEFINE_KERNELS(conic_raster_kernels)
