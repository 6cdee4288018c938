#include "lighting/receive_body.h"

void conic_lighting_kernels_scalar(conic_lighting_kernels *kernels) {
  *kernels = (conic_lighting_kernels){receive};
}
