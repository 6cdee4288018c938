/* What several processes have to know of each other's samples before they build one cloud: what the first one of all
 * has, their box, how many there are, and a few of them; as one process would know it that had taken in all. */
#include <math.h>
#include <string.h>

#include "core/base/memory.h"
#include "lod/layers/build/layers_intake.h"

/* What the first batch of all has. */
typedef struct intake_opening {
  int32_t is_known, has_failed, has_colors, n_values;
  struct {
    char name[40];
    int32_t type;
  } value[CONIC_MOST_POINT_VALUES];
} intake_opening;

/* What is added up, or the least or the greatest of all. */
typedef struct intake_facts {
  uint64_t n_in, n_samples, n_nan, n_bare, n_unseen, n_bright, n_translucent, n_dots, n_clips;
  double low[3], high[3];
  float shortest, longest;
  uint64_t n_seen[CONIC_MOST_POINT_VALUES];
  double least[CONIC_MOST_POINT_VALUES], greatest[CONIC_MOST_POINT_VALUES];
} intake_facts;

static void describe_opening(const conic_splats *batch, intake_opening *opening) {
  const conic_point_values *values = batch->values;
  opening->is_known = 1;
  opening->has_colors = batch->color[0] != NULL;
  for (size_t k = 0; values && k < values->n; k++) {
    memcpy(opening->value[k].name, values->field[k].name, sizeof opening->value[k].name);
    opening->value[k].type = values->field[k].type ? conic_layers_number_of(values->field[k].type) : -1;
    opening->n_values++;
  }
}

/* Starts the intake as a batch would that has what the opening says. */
static conic_status start_with(conic_layers_intake *intake, const intake_opening *opening) {
  float none = 0.0f;
  conic_splats like = {.count = 0};
  conic_point_values *values = conic_memory_allocate_zeroed(intake->context, 1, sizeof *values);
  if (!values)
    return CONIC_ERROR_MEMORY;
  for (int channel = 0; channel < 3 && opening->has_colors; channel++)
    like.color[channel] = &none;
  for (int32_t k = 0; k < opening->n_values; k++) {
    memcpy(values->field[k].name, opening->value[k].name, sizeof values->field[k].name);
    values->field[k].type =
        opening->value[k].type < 0 ? NULL : conic_layers_number_name((unsigned)opening->value[k].type);
  }
  values->n = (size_t)opening->n_values;
  like.values = values;
  conic_status status = conic_layers_intake_start(intake, &like);
  conic_memory_release(intake->context, values);
  return status;
}

/* From one process to the next: what the first batch had of those up to it. */
conic_status conic_layers_intake_meet(conic_layers_intake *intake, const conic_splats *batch, int has_failed) {
  const conic_team *team = intake->team;
  intake_opening opening = {.is_known = 0};
  conic_status status = CONIC_OK;
  if (intake->has_met)
    return CONIC_OK;
  intake->has_met = 1;
  if (team->index > 0) {
    size_t n_bytes;
    void *received = team->receive(team->data, team->index - 1, &n_bytes);
    memcpy(&opening, received, sizeof opening);
    team->release(team->data, received);
  }
  if (opening.has_failed)
    status = CONIC_ERROR_CANCELLED;
  opening.has_failed |= has_failed;
  if (!opening.is_known && batch)
    describe_opening(batch, &opening);
  if (opening.is_known && status == CONIC_OK && !has_failed)
    status = start_with(intake, &opening);
  opening.has_failed |= status != CONIC_OK;
  if (team->index + 1 < team->count)
    team->send(team->data, team->index + 1, &opening, sizeof opening);
  return status;
}

static void gather_facts(const conic_layers_intake *intake, intake_facts *facts) {
  const conic_layers_payload *p = &intake->payload;
  *facts = (intake_facts){.n_in = intake->n_in,
                          .n_samples = intake->n_own,
                          .n_nan = intake->n_nan,
                          .n_bare = intake->n_bare,
                          .n_unseen = intake->n_unseen,
                          .n_bright = intake->n_bright,
                          .n_translucent = p->n_translucent,
                          .n_dots = p->n_dots,
                          .n_clips = p->n_clips,
                          .shortest = p->shortest,
                          .longest = p->longest};
  memcpy(facts->low, intake->low, sizeof facts->low);
  memcpy(facts->high, intake->high, sizeof facts->high);
  for (size_t k = 0; k < p->n_values; k++) {
    facts->n_seen[k] = p->seen[k]->n_seen;
    facts->least[k] = p->low[k];
    facts->greatest[k] = p->high[k];
  }
}

static void forget_facts(conic_layers_intake *intake) {
  conic_layers_payload *p = &intake->payload;
  intake->n_in = intake->n_samples = intake->n_nan = intake->n_bare = intake->n_unseen = intake->n_bright = 0;
  p->n_translucent = p->n_dots = p->n_clips = 0;
  p->shortest = HUGE_VALF;
  p->longest = 0.0f;
  for (int axis = 0; axis < 3; axis++) {
    intake->low[axis] = HUGE_VAL;
    intake->high[axis] = -HUGE_VAL;
  }
  for (size_t k = 0; k < p->n_values; k++) {
    p->low[k] = HUGE_VAL;
    p->high[k] = -HUGE_VAL;
  }
}

static void add_facts(conic_layers_intake *intake, const intake_facts *facts) {
  conic_layers_payload *p = &intake->payload;
  intake->n_in += facts->n_in;
  intake->n_samples += facts->n_samples;
  intake->n_nan += facts->n_nan;
  intake->n_bare += facts->n_bare;
  intake->n_unseen += facts->n_unseen;
  intake->n_bright += facts->n_bright;
  p->n_translucent += facts->n_translucent;
  p->n_dots += facts->n_dots;
  p->n_clips += facts->n_clips;
  p->shortest = facts->shortest < p->shortest ? facts->shortest : p->shortest;
  p->longest = facts->longest > p->longest ? facts->longest : p->longest;
  for (int axis = 0; axis < 3; axis++) {
    intake->low[axis] = facts->low[axis] < intake->low[axis] ? facts->low[axis] : intake->low[axis];
    intake->high[axis] = facts->high[axis] > intake->high[axis] ? facts->high[axis] : intake->high[axis];
  }
  for (size_t k = 0; k < p->n_values; k++) {
    p->low[k] = facts->least[k] < p->low[k] ? facts->least[k] : p->low[k];
    p->high[k] = facts->greatest[k] > p->high[k] ? facts->greatest[k] : p->high[k];
  }
}

/* Of those of all, the few that are the own ones, and then those of all. `first`: how many samples come before. */
static conic_status unite_some(conic_layers_intake *intake, uint64_t first, uint64_t stride) {
  const conic_team *team = intake->team;
  conic_layers_block block;
  uint64_t offset = 0;
  int is_there = 1;
  unsigned char *samples = conic_memory_allocate(intake->context, CONIC_LAYERS_BLOCK, intake->raw_bytes);
  conic_status status = samples ? CONIC_OK : CONIC_ERROR_MEMORY;
  intake->n_some = 0;
  while (status == CONIC_OK) {
    status = conic_layers_intake_read(intake, &offset, &block, samples, &is_there);
    if (status != CONIC_OK || !is_there)
      break;
    for (uint64_t i = first % stride ? stride - first % stride : 0; i < block.count; i += stride) {
      const conic_layers_raw *raw = conic_layers_raw_at(samples, intake->raw_bytes, (size_t)i);
      for (int axis = 0; axis < 3; axis++)
        intake->some[intake->n_some][axis] = block.origin[axis] + (double)raw->position[axis];
      intake->n_some++;
    }
    first += block.count;
  }
  conic_memory_release(intake->context, samples);
  status = conic_team_agree(team, status);
  if (status != CONIC_OK)
    return status;
  size_t sizes[CONIC_MOST_IN_TEAM], n_bytes = 0;
  void *all = team->collect(team->data, intake->some, intake->n_some * sizeof *intake->some, sizes);
  for (int i = 0; i < team->count; i++)
    n_bytes += sizes[i];
  memcpy(intake->some, all, n_bytes);
  intake->n_some = n_bytes / sizeof *intake->some;
  team->release(team->data, all);
  return CONIC_OK;
}

/* The same of the finite ones of value k. */
static conic_status unite_values(conic_layers_intake *intake, size_t k, uint64_t first, uint64_t n_seen) {
  const conic_team *team = intake->team;
  conic_value_sample *seen = intake->payload.seen[k];
  size_t row_bytes = intake->payload.n_values * sizeof(double);
  conic_status status = CONIC_OK;
  *seen = (conic_value_sample){.n_seen = n_seen, .stride = conic_value_stride(n_seen, CONIC_MOST_VALUES)};
  for (uint64_t i = 0; i < intake->n_own && status == CONIC_OK; i++) {
    double value;
    status = conic_spool_read(&intake->columns, i * row_bytes + k * sizeof value, &value, sizeof value);
    if (status == CONIC_OK && value - value == 0.0 && first++ % seen->stride == 0)
      seen->values[seen->n++] = value + 0.0; /* no negative zero */
  }
  status = conic_team_agree(team, status);
  if (status != CONIC_OK)
    return status;
  size_t sizes[CONIC_MOST_IN_TEAM], n_bytes = 0;
  void *all = team->collect(team->data, seen->values, seen->n * sizeof *seen->values, sizes);
  for (int i = 0; i < team->count; i++)
    n_bytes += sizes[i];
  memcpy(seen->values, all, n_bytes);
  seen->n = n_bytes / sizeof *seen->values;
  team->release(team->data, all);
  return CONIC_OK;
}

/* A process without samples has to know what samples have, too. */
static conic_status unite_openings(conic_layers_intake *intake) {
  const conic_team *team = intake->team;
  size_t sizes[CONIC_MOST_IN_TEAM];
  intake_opening own = {.is_known = intake->has_started}, found = {.is_known = 0};
  const conic_layers_payload *p = &intake->payload;
  own.has_colors = intake->has_colors;
  own.n_values = (int32_t)p->n_values;
  for (size_t k = 0; k < p->n_values; k++) {
    memcpy(own.value[k].name, p->schema.list[p->value[k]].name, sizeof own.value[k].name);
    own.value[k].type = p->schema.list[p->value[k]].type;
  }
  char *all = team->collect(team->data, &own, sizeof own, sizes);
  for (int i = 0; i < team->count && !found.is_known; i++)
    memcpy(&found, all + (size_t)i * sizeof found, sizeof found);
  team->release(team->data, all);
  return found.is_known && !intake->has_started ? start_with(intake, &found) : CONIC_OK;
}

static conic_status unite_facts(conic_layers_intake *intake) {
  const conic_team *team = intake->team;
  intake_facts own, *all = conic_memory_allocate(intake->context, (size_t)team->count, sizeof *all);
  uint64_t first = 0, first_seen[CONIC_MOST_POINT_VALUES] = {0}, n_seen[CONIC_MOST_POINT_VALUES] = {0};
  conic_status status = conic_team_agree(team, all ? CONIC_OK : CONIC_ERROR_MEMORY);
  if (status == CONIC_OK) {
    gather_facts(intake, &own);
    conic_team_collect(team, &own, sizeof own, all);
    forget_facts(intake);
  }
  for (int i = 0; i < team->count && status == CONIC_OK; i++) {
    add_facts(intake, &all[i]);
    first += i < team->index ? all[i].n_samples : 0;
    for (size_t k = 0; k < intake->payload.n_values; k++) {
      first_seen[k] += i < team->index ? all[i].n_seen[k] : 0;
      n_seen[k] += all[i].n_seen[k];
    }
  }
  conic_memory_release(intake->context, all);
  if (status == CONIC_OK)
    status = unite_some(intake, first, conic_value_stride(intake->n_samples, CONIC_LAYERS_SOME));
  for (size_t k = 0; k < intake->payload.n_values && status == CONIC_OK; k++)
    status = unite_values(intake, k, first_seen[k], n_seen[k]);
  return status;
}

conic_status conic_layers_intake_unite(conic_layers_intake *intake, conic_status status) {
  conic_status met = conic_layers_intake_meet(intake, NULL, status != CONIC_OK);
  status = conic_team_agree(intake->team, status == CONIC_OK ? met : status);
  if (status == CONIC_OK)
    status = conic_team_agree(intake->team, unite_openings(intake));
  return status == CONIC_OK ? unite_facts(intake) : status;
}
