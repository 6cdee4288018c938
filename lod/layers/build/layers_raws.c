#include "lod/layers/build/layers_raws.h"

#include "core/base/vectors.h"
#include "lod/layers/format/layers_key.h"

void conic_layers_raws_begin(conic_context *context, const char *path, size_t memory_bytes, float cutoff, int is_full,
                             const conic_team *team, conic_layers_raws *raws) {
  memset(raws, 0, sizeof *raws);
  raws->team = team;
  raws->context = context;
  raws->cutoff = cutoff;
  raws->is_full = is_full;
  raws->stride = 1;
  conic_code_scale_init(1.0, 1.0, 1.0f, &raws->scale);
  conic_spool_begin(context, path, memory_bytes, &raws->spool);
  conic_spool_begin(context, path, CONIC_SPOOL_SLAB, &raws->columns);
}

conic_status conic_layers_raws_start(conic_layers_raws *raws, const conic_splats *batch) {
  conic_status status = conic_layers_payload_begin(raws->context, batch, raws->is_full, raws->cutoff, &raws->payload);
  raws->raw_bytes = (sizeof(conic_layers_raw) + raws->payload.schema.extra_bytes + 7) / 8 * 8;
  raws->pending = conic_memory_allocate(raws->context, CONIC_LAYERS_BLOCK, raws->raw_bytes);
  raws->has_started = 1;
  raws->has_colors = batch->color[0] != NULL;
  return status == CONIC_OK && !raws->pending ? CONIC_ERROR_MEMORY : status;
}

void conic_layers_raws_end(conic_layers_raws *raws) {
  if (!raws->context)
    return;
  conic_spool_end(&raws->spool);
  conic_spool_end(&raws->columns);
  conic_layers_payload_end(&raws->payload);
  conic_memory_release(raws->context, raws->pending);
  raws->pending = NULL;
}

/* Whether the square of its length neither overflows nor vanishes; not where it is not finite. */
static int is_direction(const double v[3]) {
  double length2 = conic_dot(v, v);
  return length2 > 1e-60 && length2 < 1e60;
}

/* Which share of an ellipse's area its clip lines leave, counted at places in it. */
static double share_left(const conic_clip *clip, float cutoff) {
  enum { ACROSS = 6, SQUARE = 42 }; /* of a disc of radius 6.5 */
  int n = 0, n_left = 0;
  for (int i = -ACROSS; i <= ACROSS; i++)
    for (int k = -ACROSS; k <= ACROSS; k++) {
      int n_kept = 0;
      if (i * i + k * k > SQUARE)
        continue;
      for (int line = 0; line < clip->n_lines; line++) {
        const float *l = clip->lines[line];
        n_kept += !((l[0] * (float)i + l[1] * (float)k) * cutoff / ((float)ACROSS + 0.5f) + l[2] < 0.0f);
      }
      n++;
      n_left += n_kept >= (clip->operation == CONIC_CLIP_OR ? 1 : clip->n_lines);
    }
  return (double)n_left / (double)n;
}

/* The outline of the circle that stands for an ellipse. It lies between one that holds all of the ellipse and one with
 * the area that is drawn of it, as near to the latter as leaves no slits, by experiment. A full payload has the ellipse
 * itself; then the circle holds all of it. */
static float outline_of(const conic_layers_raws *raws, double longer, double shorter, const conic_clip *clip) {
  double share = clip && !raws->is_full ? share_left(clip, raws->cutoff) : 1.0;
  double length = raws->is_full ? longer : (2.0 * longer + sqrt(longer * shorter * share)) / 3.0;
  return (float)(length * (double)raws->cutoff);
}

/* The normal and the outline of a splat with axes; whether it has them. */
static int take_axes(conic_layers_raws *raws, const conic_splats *batch, size_t i, conic_layers_raw *raw) {
  double a[3], b[3], cross[3];
  conic_vector_at(batch->tangent_u, i, a);
  conic_vector_at(batch->tangent_v, i, b);
  if (!is_direction(a) || !is_direction(b))
    return 0;
  double length_a = conic_length(a), length_b = conic_length(b);
  conic_normalize(a);
  conic_normalize(b);
  conic_cross(a, b, cross);
  const float normal[3] = {(float)cross[0], (float)cross[1], (float)cross[2]};
  const double rounded[3] = {(double)normal[0], (double)normal[1], (double)normal[2]};
  if (!is_direction(rounded))
    return 0;
  conic_layers_code_normal(normal, raw->normal);
  double longer = fmax(length_a, length_b), shorter = fmin(length_a, length_b);
  if (batch->dot && batch->dot[i] != 0.0f) /* it is drawn as a circle */
    shorter = longer;
  float outline = outline_of(raws, longer, shorter, conic_layers_payload_clip(&raws->payload, batch, i));
  raw->size = conic_layers_code_size(outline);
  conic_layers_facts *facts = &raws->payload.facts;
  if (raw->size && !raws->is_full) {
    facts->shortest = outline < facts->shortest ? outline : facts->shortest;
    facts->longest = outline > facts->longest ? outline : facts->longest;
  }
  return 1;
}

/* The direction of a normal, or of a sight; 0 where it has none. */
static int take_direction(float *const direction[3], size_t i, conic_layers_raw *raw) {
  const float normal[3] = {direction[0][i], direction[1][i], direction[2][i]};
  double exact[3];
  conic_vector_at(direction, i, exact);
  if (!is_direction(exact))
    return 0;
  conic_layers_code_normal(normal, raw->normal);
  return 1;
}

static void take_color(conic_layers_raws *raws, const conic_splats *batch, size_t i, conic_layers_raw *raw) {
  int is_bright = 0;
  for (int channel = 0; channel < 3; channel++) {
    float value = batch->color[channel][i];
    is_bright |= value > 1.0f;
    raw->color[channel] = conic_code_srgb(&raws->scale, value);
  }
  raws->payload.facts.n_bright += is_bright != 0;
}

static void remember_some(conic_layers_raws *raws, const double position[3]) {
  if (raws->n_own % raws->stride)
    return;
  if (raws->n_some == CONIC_LAYERS_SOME) { /* every other, from now on */
    for (size_t i = 0; i < CONIC_LAYERS_SOME / 2; i++)
      memcpy(raws->some[i], raws->some[2 * i], sizeof raws->some[i]);
    raws->n_some /= 2;
    raws->stride *= 2;
    if (raws->n_own % raws->stride)
      return;
  }
  memcpy(raws->some[raws->n_some++], position, 3 * sizeof *position);
}

/* Puts one sample into `raw`, and says whether it can be used. */
static int take_sample(conic_layers_raws *raws, const conic_splats *batch, size_t i, conic_layers_raw *raw) {
  conic_layers_facts *facts = &raws->payload.facts;
  double position[3];
  memset(raw, 0, raws->raw_bytes);
  for (int axis = 0; axis < 3; axis++) {
    raw->position[axis] = batch->position[axis][i];
    position[axis] = batch->origin[axis] + (double)raw->position[axis];
  }
  if (!(fabs(position[0]) + fabs(position[1]) + fabs(position[2]) < 1e15)) {
    facts->n_nan++;
    return 0;
  }
  conic_widen_box(facts->low, facts->high, position);
  int has_normal = batch->tangent_u[0] && take_axes(raws, batch, i, raw);
  if (!has_normal && batch->normal[0])
    has_normal = take_direction(batch->normal, i, raw);
  int is_seen = !has_normal && batch->sight[0] && take_direction(batch->sight, i, raw);
  raw->is_bare = has_normal ? 0 : is_seen ? CONIC_LAYERS_SEEN : CONIC_LAYERS_BARE;
  facts->n_bare += !has_normal;
  facts->n_unseen += !has_normal && !is_seen;
  if (batch->color[0])
    take_color(raws, batch, i, raw);
  conic_layers_payload_take(&raws->payload, batch, i, raw + 1);
  remember_some(raws, position);
  facts->n_samples++;
  raws->n_own++;
  return 1;
}

/* Puts one sample into the pending block. */
static conic_status take_one(conic_layers_raws *raws, const conic_splats *batch, size_t i, conic_layers_block *block) {
  double row[CONIC_MOST_POINT_VALUES];
  unsigned char *raw = raws->pending + (size_t)block->count * raws->raw_bytes;
  if (!take_sample(raws, batch, i, (conic_layers_raw *)(void *)raw))
    return CONIC_OK;
  block->count++;
  if (!raws->team || raws->payload.n_values == 0)
    return CONIC_OK;
  conic_layers_payload_row(&raws->payload, i, row);
  return conic_spool_append(&raws->columns, row, raws->payload.n_values * sizeof *row);
}

conic_status conic_layers_raws_append(conic_layers_raws *raws, const conic_splats *batch) {
  conic_status begun = raws->has_started || batch->count == 0 ? CONIC_OK
                       : raws->team                           ? conic_layers_raws_agree(raws, batch, 0)
                                                              : conic_layers_raws_start(raws, batch);
  if (begun != CONIC_OK)
    return begun;
  if (raws->has_started && (batch->color[0] != NULL) != raws->has_colors)
    return conic_fail(raws->context, CONIC_ERROR_ARGUMENT, "%s: some samples have colours, others have none",
                      raws->spool.path);
  conic_layers_payload_turn_to(&raws->payload, batch);
  for (size_t first = 0; first < batch->count; first += CONIC_LAYERS_BLOCK) {
    size_t left = batch->count - first, end = first + (left < CONIC_LAYERS_BLOCK ? left : CONIC_LAYERS_BLOCK);
    conic_layers_block block = {.count = 0};
    memcpy(block.origin, batch->origin, sizeof block.origin);
    conic_status status = CONIC_OK;
    for (size_t i = first; i < end && status == CONIC_OK; i++)
      status = take_one(raws, batch, i, &block);
    raws->payload.facts.n_in += end - first;
    if (status == CONIC_OK)
      status = conic_spool_append(&raws->spool, &block, sizeof block);
    if (status == CONIC_OK)
      status = conic_spool_append(&raws->spool, raws->pending, (size_t)block.count * raws->raw_bytes);
    if (status != CONIC_OK)
      return status;
  }
  return CONIC_OK;
}

conic_status conic_layers_raws_visit(const conic_layers_raws *raws, const char *task, conic_layers_visit_block *visit,
                                     void *data) {
  conic_layers_block block;
  uint64_t n_done = 0;
  unsigned char *samples = conic_memory_allocate(raws->context, CONIC_LAYERS_BLOCK, raws->raw_bytes);
  conic_status status = samples ? CONIC_OK : CONIC_ERROR_MEMORY;
  for (uint64_t at = 0; at < conic_spool_bytes(&raws->spool) && status == CONIC_OK;) {
    status = conic_spool_read(&raws->spool, at, &block, sizeof block);
    at += sizeof block;
    if (status == CONIC_OK)
      status = conic_spool_read(&raws->spool, at, samples, (size_t)block.count * raws->raw_bytes);
    at += block.count * raws->raw_bytes;
    if (status == CONIC_OK)
      status = visit(data, &block, samples);
    n_done += block.count;
    if (status == CONIC_OK && task)
      status = conic_progress(raws->context, task, (double)n_done / (double)raws->n_own);
  }
  conic_memory_release(raws->context, samples);
  return status;
}

/* --- on the grid --- */

void conic_layers_grid_init(const conic_layers_raws *raws, const conic_layers_plan *plan, const double origin[3],
                            const conic_layers_kept *kept, const char *task, conic_layers_grid *grid) {
  *grid = (conic_layers_grid){.raws = raws,
                              .origin = {origin[0], origin[1], origin[2]},
                              .quantum = plan->quantum,
                              .last = (double)((UINT64_C(1) << plan->bits) - 1),
                              .sample_bytes = plan->sample_bytes,
                              .task = task,
                              .kept = kept};
}

/* The step in which a distance from the low corner, in steps, lies. */
static uint32_t step_at(const conic_layers_grid *grid, double step) {
  return (uint32_t)(step > 0.0 ? step < grid->last ? step : grid->last : 0.0);
}

uint64_t conic_layers_grid_key(const conic_layers_grid *grid, const double position[3]) {
  uint32_t steps[3];
  for (int axis = 0; axis < 3; axis++)
    steps[axis] = step_at(grid, floor((position[axis] - grid->origin[axis]) / grid->quantum));
  return conic_layers_key(steps[0], steps[1], steps[2]);
}

/* Finds the sample's key, and, where it is bare, where in its steps it is. */
static void place_sample(const conic_layers_grid *grid, const conic_layers_block *block, const conic_layers_raw *raw,
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

typedef struct placing {
  const conic_layers_grid *grid;
  conic_layers_sample *sample;
  conic_layers_take *take;
  void *to;
} placing;

static conic_status place_raws(void *data, const conic_layers_block *block, const unsigned char *raws) {
  const placing *p = data;
  const conic_layers_raws *from = p->grid->raws;
  conic_status status = CONIC_OK;
  for (size_t i = 0; i < block->count && status == CONIC_OK; i++) {
    const conic_layers_raw *raw = conic_layers_raw_at(raws, from->raw_bytes, i);
    *p->sample = (conic_layers_sample){.normal = {raw->normal[0], raw->normal[1]},
                                       .size = raw->size,
                                       .color = {raw->color[0], raw->color[1], raw->color[2]}};
    memcpy(p->sample + 1, raw + 1, from->payload.schema.extra_bytes);
    place_sample(p->grid, block, raw, p->sample);
    if (p->grid->kept->n == 0 || !conic_layers_kept_find(p->grid->kept, p->sample->key))
      status = p->take(p->to, p->sample);
  }
  return status;
}

conic_status conic_layers_grid_run(const void *grid, conic_layers_take *take, void *to) {
  placing p = {.grid = grid, .take = take, .to = to};
  conic_context *context = p.grid->raws->context;
  p.sample = conic_memory_allocate_zeroed(context, 1, p.grid->sample_bytes);
  conic_status status =
      p.sample ? conic_layers_raws_visit(p.grid->raws, p.grid->task, place_raws, &p) : CONIC_ERROR_MEMORY;
  conic_memory_release(context, p.sample);
  return status;
}
