/* What several processes have to know of each other's samples before they build one cloud: what the first sample of
 * all has, their box, how many there are, and a few of them. It is what one process would know that had taken in all.
 */

#include "lod/layers/build/layers_raws.h"

/* What the first batch of all has. */
typedef struct batch_layout {
  int32_t is_known, has_failed, has_colors, n_values;
  struct {
    char name[40];
    int32_t type;
  } value[CONIC_MOST_POINT_VALUES];
} batch_layout;

/* The facts of one process's samples, and how many finite values of each name it has seen. */
typedef struct own_facts {
  conic_layers_facts facts;
  uint64_t n_seen[CONIC_MOST_POINT_VALUES];
} own_facts;

void conic_layers_facts_init(conic_layers_facts *facts) {
  *facts = (conic_layers_facts){.shortest = HUGE_VALF};
  for (int axis = 0; axis < 3; axis++) {
    facts->low[axis] = HUGE_VAL;
    facts->high[axis] = -HUGE_VAL;
  }
  for (size_t k = 0; k < CONIC_MOST_POINT_VALUES; k++) {
    facts->least[k] = HUGE_VAL;
    facts->greatest[k] = -HUGE_VAL;
  }
}

static void widen_ranges(const double *least, const double *greatest, size_t n, double *low, double *high) {
  for (size_t i = 0; i < n; i++) {
    low[i] = least[i] < low[i] ? least[i] : low[i];
    high[i] = greatest[i] > high[i] ? greatest[i] : high[i];
  }
}

static void add_facts(conic_layers_facts *facts, const conic_layers_facts *more) {
  facts->n_in += more->n_in;
  facts->n_samples += more->n_samples;
  facts->n_nan += more->n_nan;
  facts->n_bare += more->n_bare;
  facts->n_unseen += more->n_unseen;
  facts->n_bright += more->n_bright;
  facts->n_translucent += more->n_translucent;
  facts->n_dots += more->n_dots;
  facts->n_clips += more->n_clips;
  facts->shortest = more->shortest < facts->shortest ? more->shortest : facts->shortest;
  facts->longest = more->longest > facts->longest ? more->longest : facts->longest;
  widen_ranges(more->low, more->high, 3, facts->low, facts->high);
  widen_ranges(more->least, more->greatest, CONIC_MOST_POINT_VALUES, facts->least, facts->greatest);
}

static void describe_batch(const conic_splats *batch, batch_layout *layout) {
  const conic_point_values *values = batch->values;
  layout->is_known = 1;
  layout->has_colors = batch->color[0] != NULL;
  for (size_t k = 0; values && k < values->n; k++) {
    memcpy(layout->value[k].name, values->field[k].name, sizeof layout->value[k].name);
    layout->value[k].type = values->field[k].type ? conic_layers_number_of(values->field[k].type) : -1;
    layout->n_values++;
  }
}

/* Starts the samples as a batch would that has what the layout says. */
static conic_status start_with(conic_layers_raws *raws, const batch_layout *layout) {
  float none = 0.0f;
  conic_splats like = {.count = 0};
  conic_point_values *values = conic_memory_allocate_zeroed(raws->context, 1, sizeof *values);
  if (!values)
    return CONIC_ERROR_MEMORY;
  for (int channel = 0; channel < 3 && layout->has_colors; channel++)
    like.color[channel] = &none;
  for (int32_t k = 0; k < layout->n_values; k++) {
    memcpy(values->field[k].name, layout->value[k].name, sizeof values->field[k].name);
    values->field[k].type =
        layout->value[k].type < 0 ? NULL : conic_layers_number_name((unsigned)layout->value[k].type);
  }
  values->n = (size_t)layout->n_values;
  like.values = values;
  conic_status status = conic_layers_raws_start(raws, &like);
  conic_memory_release(raws->context, values);
  return status;
}

/* The layout goes from one process to the next. */
conic_status conic_layers_raws_agree(conic_layers_raws *raws, const conic_splats *batch, int has_failed) {
  const conic_team *team = raws->team;
  batch_layout layout = {.is_known = 0};
  conic_status status = CONIC_OK;
  if (raws->has_agreed)
    return CONIC_OK;
  raws->has_agreed = 1;
  if (team->index > 0) {
    size_t n_bytes;
    void *received = team->receive(team->data, team->index - 1, &n_bytes);
    memcpy(&layout, received, sizeof layout);
    team->release(team->data, received);
  }
  if (layout.has_failed)
    status = CONIC_ERROR_CANCELLED;
  layout.has_failed |= has_failed;
  if (!layout.is_known && batch)
    describe_batch(batch, &layout);
  if (layout.is_known && status == CONIC_OK && !has_failed)
    status = start_with(raws, &layout);
  layout.has_failed |= status != CONIC_OK;
  if (team->index + 1 < team->count)
    team->send(team->data, team->index + 1, &layout, sizeof layout);
  return status;
}

/* Puts what every process has of an array side by side, in place of its own; *n says how many elements. */
static void collect_array(const conic_team *team, void *array, size_t *n, size_t element_bytes) {
  *n = conic_team_collect(team, array, *n * element_bytes, array) / element_bytes;
}

typedef struct picking {
  conic_layers_raws *raws;
  uint64_t first, stride; /* how many samples come before; every stride-th of the team's is taken */
} picking;

static conic_status pick_some(void *data, const conic_layers_block *block, const unsigned char *samples) {
  picking *p = data;
  conic_layers_raws *raws = p->raws;
  for (uint64_t i = p->first % p->stride ? p->stride - p->first % p->stride : 0; i < block->count; i += p->stride) {
    const conic_layers_raw *raw = conic_layers_raw_at(samples, raws->raw_bytes, (size_t)i);
    for (int axis = 0; axis < 3; axis++)
      raws->some[raws->n_some][axis] = block->origin[axis] + (double)raw->position[axis];
    raws->n_some++;
  }
  p->first += block->count;
  return CONIC_OK;
}

/* Replaces the few samples by some of the team's. `first`: how many samples come before this process's. */
static conic_status combine_some(conic_layers_raws *raws, uint64_t first, uint64_t stride) {
  picking p = {raws, first, stride};
  raws->n_some = 0;
  conic_status status = conic_team_agree(raws->team, conic_layers_raws_visit(raws, NULL, pick_some, &p));
  if (status == CONIC_OK)
    collect_array(raws->team, raws->some, &raws->n_some, sizeof *raws->some);
  return status;
}

/* The same of the finite ones of value k. */
static conic_status combine_values(conic_layers_raws *raws, size_t k, uint64_t first, uint64_t n_seen) {
  conic_value_sample *seen = raws->payload.seen[k];
  size_t row_bytes = raws->payload.n_values * sizeof(double);
  conic_status status = CONIC_OK;
  *seen = (conic_value_sample){.n_seen = n_seen, .stride = conic_value_stride(n_seen, CONIC_MOST_VALUES)};
  for (uint64_t i = 0; i < raws->n_own && status == CONIC_OK; i++) {
    double value;
    status = conic_spool_read(&raws->columns, i * row_bytes + k * sizeof value, &value, sizeof value);
    if (status == CONIC_OK && value - value == 0.0 && first++ % seen->stride == 0)
      seen->values[seen->n++] = value + 0.0; /* no negative zero */
  }
  status = conic_team_agree(raws->team, status);
  if (status == CONIC_OK)
    collect_array(raws->team, seen->values, &seen->n, sizeof *seen->values);
  return status;
}

/* A process without samples has to know what samples have, too. */
static conic_status combine_layouts(conic_layers_raws *raws) {
  const conic_team *team = raws->team;
  size_t sizes[CONIC_MOST_IN_TEAM];
  batch_layout own = {.is_known = raws->has_started}, found = {.is_known = 0};
  const conic_layers_payload *p = &raws->payload;
  own.has_colors = raws->has_colors;
  own.n_values = (int32_t)p->n_values;
  for (size_t k = 0; k < p->n_values; k++) {
    memcpy(own.value[k].name, p->schema.list[p->value[k]].name, sizeof own.value[k].name);
    own.value[k].type = p->schema.list[p->value[k]].type;
  }
  char *all = team->collect(team->data, &own, sizeof own, sizes);
  for (int i = 0; i < team->count && !found.is_known; i++)
    memcpy(&found, all + (size_t)i * sizeof found, sizeof found);
  team->release(team->data, all);
  return found.is_known && !raws->has_started ? start_with(raws, &found) : CONIC_OK;
}

static conic_status combine_facts(conic_layers_raws *raws) {
  const conic_team *team = raws->team;
  conic_layers_payload *p = &raws->payload;
  own_facts own = {.facts = p->facts}, *all = conic_memory_allocate(raws->context, (size_t)team->count, sizeof *all);
  uint64_t first = 0, first_seen[CONIC_MOST_POINT_VALUES] = {0}, n_seen[CONIC_MOST_POINT_VALUES] = {0};
  conic_status status = conic_team_agree(team, all ? CONIC_OK : CONIC_ERROR_MEMORY);
  if (status == CONIC_OK) {
    for (size_t k = 0; k < p->n_values; k++)
      own.n_seen[k] = p->seen[k]->n_seen;
    conic_team_collect(team, &own, sizeof own, all);
    conic_layers_facts_init(&p->facts);
  }
  for (int i = 0; i < team->count && status == CONIC_OK; i++) {
    add_facts(&p->facts, &all[i].facts);
    first += i < team->index ? all[i].facts.n_samples : 0;
    for (size_t k = 0; k < p->n_values; k++) {
      first_seen[k] += i < team->index ? all[i].n_seen[k] : 0;
      n_seen[k] += all[i].n_seen[k];
    }
  }
  conic_memory_release(raws->context, all);
  if (status == CONIC_OK)
    status = combine_some(raws, first, conic_value_stride(p->facts.n_samples, CONIC_LAYERS_SOME));
  for (size_t k = 0; k < p->n_values && status == CONIC_OK; k++)
    status = combine_values(raws, k, first_seen[k], n_seen[k]);
  return status;
}

conic_status conic_layers_raws_combine(conic_layers_raws *raws, conic_status status) {
  conic_status agreed = conic_layers_raws_agree(raws, NULL, status != CONIC_OK);
  status = conic_team_agree(raws->team, status == CONIC_OK ? agreed : status);
  if (status == CONIC_OK)
    status = conic_team_agree(raws->team, combine_layouts(raws));
  return status == CONIC_OK ? combine_facts(raws) : status;
}
