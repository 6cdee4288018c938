#include "lod/layers/build/layers_place.h"

#include <math.h>
#include <string.h>

#include "core/base/memory.h"
#include "core/base/message.h"
#include "lod/layers/format/layers_key.h"

void conic_layers_placing_init(const conic_layers_intake *intake, const conic_layers_plan *plan, const double origin[3],
                               const conic_layers_kept *kept, const char *task, conic_layers_placing *placing) {
  *placing = (conic_layers_placing){.intake = intake,
                                    .origin = {origin[0], origin[1], origin[2]},
                                    .quantum = plan->quantum,
                                    .last = (double)((UINT64_C(1) << plan->bits) - 1),
                                    .sample_bytes = plan->sample_bytes,
                                    .task = task,
                                    .kept = kept};
}

/* Of a distance from the low corner, in steps: which one it lies in. */
static uint32_t step_at(const conic_layers_placing *grid, double step) {
  return (uint32_t)(step > 0.0 ? step < grid->last ? step : grid->last : 0.0);
}

uint64_t conic_layers_key_about(const conic_layers_placing *placing, const double position[3]) {
  uint32_t steps[3];
  for (int axis = 0; axis < 3; axis++)
    steps[axis] = step_at(placing, floor((position[axis] - placing->origin[axis]) / placing->quantum));
  return conic_layers_key(steps[0], steps[1], steps[2]);
}

/* The sample's key, and, where it is bare, where in its steps it is. */
static void place_sample(const conic_layers_placing *grid, const conic_layers_block *block, const conic_layers_raw *raw,
                         conic_layers_sample *sample) {
  uint32_t steps[3];
  sample->bare = raw->is_bare;
  for (int axis = 0; axis < 3; axis++) {
    double place = ((block->origin[axis] - grid->origin[axis]) + (double)raw->position[axis]) / grid->quantum;
    double step = floor(place);
    steps[axis] = step_at(grid, step);
    int quarter = (int)(4.0 * (place - step));
    if (raw->is_bare)
      sample->bare = (uint8_t)(sample->bare | (quarter < 3 ? quarter : 3) << 2 * axis);
  }
  sample->key = conic_layers_key(steps[0], steps[1], steps[2]);
}

static conic_status place_written_block(const conic_layers_placing *grid, const conic_layers_block *block,
                                        const unsigned char *raws, conic_layers_sample *sample, conic_layers_take *take,
                                        void *to) {
  const conic_layers_intake *intake = grid->intake;
  conic_status status = CONIC_OK;
  for (size_t i = 0; i < block->count && status == CONIC_OK; i++) {
    const conic_layers_raw *raw = conic_layers_raw_at(raws, intake->raw_bytes, i);
    *sample = (conic_layers_sample){.normal = {raw->normal[0], raw->normal[1]},
                                    .size = raw->size,
                                    .color = {raw->color[0], raw->color[1], raw->color[2]}};
    memcpy(sample + 1, raw + 1, intake->extra_bytes);
    place_sample(grid, block, raw, sample);
    if (grid->kept->n == 0 || !conic_layers_kept_find(grid->kept, sample->key))
      status = take(to, sample);
  }
  return status;
}

conic_status conic_layers_place_all(const void *placing, conic_layers_take *take, void *to) {
  const conic_layers_placing *grid = placing;
  conic_context *context = grid->intake->context;
  uint64_t offset = 0, n_done = 0;
  conic_layers_block block;
  int is_there = 1;
  unsigned char *raws = conic_memory_allocate(context, CONIC_LAYERS_BLOCK, grid->intake->raw_bytes);
  conic_layers_sample *sample = conic_memory_allocate_zeroed(context, 1, grid->sample_bytes);
  conic_status status = raws && sample ? CONIC_OK : CONIC_ERROR_MEMORY;
  while (status == CONIC_OK) {
    status = conic_layers_intake_read(grid->intake, &offset, &block, raws, &is_there);
    if (status != CONIC_OK || !is_there)
      break;
    status = place_written_block(grid, &block, raws, sample, take, to);
    n_done += block.count;
    if (status == CONIC_OK)
      status = conic_progress(context, grid->task, (double)n_done / (double)grid->intake->n_own);
  }
  conic_memory_release(context, raws);
  conic_memory_release(context, sample);
  return status;
}
