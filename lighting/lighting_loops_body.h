/* The loops of lighting; included by one file an instruction set. */
#include "lighting/receive_body.h"
#include "lighting/shade_body.h"

CONIC_FILL_LOOPS(conic_lighting_loops) {
  *loops = (conic_lighting_loops){receive, shade};
}
