/* The loops of discs; included by one file an instruction set. */
#include "lod/layers/build/layers_discs_body.h"

CONIC_FILL_LOOPS(conic_layers_disc_loops) {
  *loops = (conic_layers_disc_loops){disc_off, disc_error};
}
