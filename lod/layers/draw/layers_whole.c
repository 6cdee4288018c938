/* All of a layered point cloud as splats, for what needs every one of them. */
#include <math.h>
#include <string.h>

#include "core/base/memory.h"
#include "lod/layers/draw/layers_gather.h"

/* The leaves are the finest of the cut, in the order of their keys. */
static conic_status list_leaves(const conic_layers *layers, conic_layers_cut *cut, uint32_t *chosen) {
  uint32_t open[CONIC_LAYERS_MOST_LEVELS + 2] = {0};
  int n_open = 1;
  cut->places = conic_memory_allocate_zeroed(layers->context, layers->header.n_clouds, sizeof *cut->places);
  if (!cut->places)
    return CONIC_ERROR_MEMORY;
  while (n_open > 0) {
    uint32_t node = open[--n_open], child = layers->entries[node].child;
    if (child) {
      open[n_open++] = child + 1;
      open[n_open++] = child;
      continue;
    }
    chosen[cut->n] = (uint32_t)cut->n;
    cut->places[cut->n++].node = node;
  }
  return CONIC_OK;
}

conic_status conic_layers_splats(conic_layers *layers, float cutoff, conic_splats *splats) {
  conic_context *context = layers->context;
  conic_layers_cut cut = {0};
  conic_layers_set set = {0};
  memset(splats, 0, sizeof *splats);
  uint32_t *chosen = conic_memory_allocate(context, layers->header.n_clouds, sizeof *chosen);
  conic_status status = chosen ? list_leaves(layers, &cut, chosen) : CONIC_ERROR_MEMORY;
  conic_layers_gathering gathering = {
      .cut = &cut, .chosen = chosen, .n_chosen = cut.n, .cutoff = cutoff, .until_s = HUGE_VAL};
  if (status == CONIC_OK)
    status = conic_layers_gather(layers, &gathering, &set);
  memcpy(splats->origin, set.splats.origin, sizeof splats->origin);
  if (status == CONIC_OK)
    status = conic_splats_append(context, splats, &set.splats);
  conic_memory_release(context, chosen);
  conic_layers_cut_release(context, &cut);
  conic_layers_set_release(context, &set);
  return status;
}
