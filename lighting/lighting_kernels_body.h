/* The kernels of lighting; included by one file an instruction set. */
#include "lighting/receive_body.h"

CONIC_FILL_KERNELS(conic_lighting_kernels) {
  *kernels = (conic_lighting_kernels){receive};
}
