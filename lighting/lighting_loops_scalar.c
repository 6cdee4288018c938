#include "lighting/receive_body.h"
#include "lighting/shade_body.h"

CONIC_DEFINE_LOOPS(conic_lighting_loops)

void conic_lighting_loops_scalar(conic_lighting_loops *loops) {
  *loops = (conic_lighting_loops){receive, shade};
}
