#include "lod/layers/build/layers_discs_body.h"

CONIC_DEFINE_LOOPS(conic_layers_disc_loops)

void conic_layers_disc_loops_scalar(conic_layers_disc_loops *loops) {
  *loops = (conic_layers_disc_loops){disc_off, disc_error};
}

conic_status conic_layers_chosen_create(conic_context *context, const conic_thinner *thinner, size_t n,
                                        conic_layers_chosen *chosen) {
  conic_isa isa;
  size_t room = n + CONIC_CHOSEN_BEHIND;
  *chosen = (conic_layers_chosen){.thinner = NULL};
  conic_status status = conic_isa_choose(context, CONIC_ISA_AUTO, &isa);
  float *columns = status == CONIC_OK ? conic_memory_allocate_zeroed(context, 7 * room, sizeof *columns) : NULL;
  if (!columns)
    return status == CONIC_OK ? CONIC_ERROR_MEMORY : status;
  chosen->thinner = thinner;
  conic_layers_disc_loops_init(&chosen->loops, isa);
  for (size_t axis = 0; axis < 3; axis++) {
    chosen->center[axis] = columns + axis * room;
    chosen->normal[axis] = columns + (3 + axis) * room;
  }
  chosen->radius = columns + 6 * room;
  return CONIC_OK;
}

void conic_layers_chosen_put(const conic_layers_chosen *chosen, size_t i, const conic_layers_disc *disc) {
  for (int axis = 0; axis < 3; axis++) {
    chosen->center[axis][i] = disc->center[axis];
    chosen->normal[axis][i] = disc->normal[axis];
  }
  chosen->radius[i] = disc->radius;
}
