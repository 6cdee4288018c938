/* All of a hierarchy, node by node: its points as they are in the file, or whether they can be read. */
#include <math.h>
#include <string.h>

#include "core/base/memory.h"
#include "core/base/message.h"
#include "lod/layers/draw/layers_octree.h"

typedef conic_status cloud_function(conic_layers *layers, uint32_t cloud, void *data);

/* Loads cloud after cloud; `visit` may be null. */
static conic_status visit_clouds(conic_layers *layers, int tolerates, cloud_function *visit, void *data,
                                 uint64_t *n_damaged) {
  conic_layers_expansion all = {.until_s = HUGE_VAL, .tolerates_damage = tolerates};
  conic_status status = conic_layers_octree_expand(layers, NULL, &all);
  *n_damaged = all.n_damaged;
  for (uint32_t i = 0; i < layers->header.n_clouds && status == CONIC_OK; i++) {
    conic_layers_loading loading = {
        .clouds = &i, .n = 1, .until_s = HUGE_VAL, .may_miss = tolerates, .tolerates_damage = tolerates};
    if (layers->entries[i].n_samples == 0)
      continue;
    status = conic_layers_store_load(layers, &loading);
    *n_damaged += loading.n_damaged;
    if (status == CONIC_OK && visit && layers->store.slots[i].cloud)
      status = visit(layers, i, data);
    if (status == CONIC_OK)
      conic_layers_store_unpin(layers, &loading);
    if (status == CONIC_OK)
      status = conic_progress(layers->context, "read", (double)i / (double)layers->header.n_clouds);
  }
  return status;
}

typedef struct stream_target {
  conic_batch_receiver *receive;
  void *cookie;
} stream_target;

static conic_status stream_cloud(conic_layers *layers, uint32_t cloud, void *data) {
  const stream_target *target = data;
  const conic_layers_cloud *from = layers->store.slots[cloud].cloud;
  conic_splats batch;
  memset(&batch, 0, sizeof batch);
  batch.count = from->count;
  memcpy(batch.origin, layers->header.origin, sizeof batch.origin);
  for (int axis = 0; axis < 3; axis++) {
    batch.position[axis] = from->position[axis];
    batch.color[axis] = from->color[axis];
  }
  return target->receive(target->cookie, &batch);
}

conic_status conic_layers_stream(conic_layers *layers, conic_batch_receiver *receive, void *cookie) {
  stream_target target = {receive, cookie};
  uint64_t n_damaged;
  if (!layers->octree)
    return conic_fail(layers->context, CONIC_ERROR_UNSUPPORTED, "%s: its samples are no raw points", layers->name);
  return visit_clouds(layers, 0, stream_cloud, &target, &n_damaged);
}

conic_status conic_layers_count_damaged(conic_layers *layers, uint64_t *n_damaged) {
  *n_damaged = 0;
  return layers->octree ? visit_clouds(layers, 1, NULL, NULL, n_damaged) : CONIC_OK;
}
