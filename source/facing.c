#include "source/facing.h"

#include "core/base/base.h"

conic_status conic_facing_begin(conic_context *context, const conic_splats *splats, conic_facing *facing) {
  *facing = (conic_facing){.n_dots = conic_splats_count_dots(splats)};
  if (!facing->n_dots)
    return CONIC_OK;
  facing->splats = *splats;
  for (int i = 0; i < 6; i++) {
    float **axes = i < 3 ? &facing->splats.tangent_u[i] : &facing->splats.tangent_v[i - 3], *own = *axes;
    *axes = conic_memory_allocate(context, splats->count, sizeof(float));
    if (*axes)
      memcpy(*axes, own, splats->count * sizeof(float));
  }
  for (int axis = 0; axis < 3; axis++)
    if (!facing->splats.tangent_u[axis] || !facing->splats.tangent_v[axis])
      return CONIC_ERROR_MEMORY;
  return CONIC_OK;
}

conic_status conic_facing_turn(conic_context *context, conic_facing *facing, const conic_camera *camera,
                               const conic_splats **drawn) {
  const conic_splats *splats = *drawn;
  if (!facing->n_dots)
    return CONIC_OK;
  memcpy(facing->splats.position, splats->position, sizeof facing->splats.position);
  *drawn = &facing->splats;
  return conic_splats_face(context, splats, camera, facing->splats.tangent_u, facing->splats.tangent_v);
}

void conic_facing_end(conic_context *context, conic_facing *facing) {
  for (int axis = 0; axis < 3 && facing->n_dots; axis++)
    conic_memory_release_these(context, facing->splats.tangent_u[axis], facing->splats.tangent_v[axis]);
  *facing = (conic_facing){.n_dots = 0};
}
