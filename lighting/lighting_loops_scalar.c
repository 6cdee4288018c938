#include "lighting/receive_body.h"

void conic_lighting_loops_scalar(conic_lighting_loops *loops) {
  *loops = (conic_lighting_loops){receive};
}
