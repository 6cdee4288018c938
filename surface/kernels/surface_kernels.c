#include "surface/kernels/surface_kernels.h"

CONIC_DEFINE_KERNELS(conic_surface_kernels)
