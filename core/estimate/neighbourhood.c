#include "core/estimate/neighbourhood.h"

#include "core/base/vectors.h"

/* Slots in one call of a task, and calls between two reports of progress. */
enum { CHUNK = 1024, CHUNKS_A_REPORT = 64 };

typedef struct slots_work {
  conic_slots_task *task;
  void *data;
  size_t n_slots;
} slots_work;

static void do_chunk(void *data, size_t i_item) {
  const slots_work *work = data;
  size_t begin = i_item * CHUNK;
  work->task(work->data, begin, begin + CHUNK < work->n_slots ? begin + CHUNK : work->n_slots);
}

conic_status conic_slots_for(conic_context *context, size_t n_slots, conic_slots_task *task, void *data, double from,
                             double to) {
  slots_work work = {task, data, n_slots};
  return conic_parallel_runs(context, "estimate", from, to, (n_slots + CHUNK - 1) / CHUNK, CHUNKS_A_REPORT, do_chunk,
                             &work);
}

conic_status conic_slots_share(conic_context *context, size_t n_slots, conic_slots_task *task, void *data, double from,
                               double to, const conic_team_column *columns, size_t n) {
  slots_work work = {task, data, n_slots};
  conic_team_loop loop = conic_team_loop_of("estimate", from, to, n_slots, CHUNK, CHUNKS_A_REPORT, do_chunk, &work);
  memcpy(loop.columns, columns, n * sizeof *columns);
  return conic_team_runs(context, &loop);
}

conic_status conic_neighbourhood_create(conic_context *context, const float *const positions[3], size_t count,
                                        size_t n_neighbours, conic_neighbourhood *neighbourhood) {
  memset(neighbourhood, 0, sizeof *neighbourhood);
  conic_status status = conic_neighbours_build(context, positions, count, &neighbourhood->tree);
  if (status != CONIC_OK)
    return status;
  size_t n_slots = neighbourhood->tree.n_slots, n_others = n_slots ? n_slots - 1 : 0;
  neighbourhood->n_neighbours = n_neighbours < n_others ? n_neighbours : n_others;
  neighbourhood->neighbours =
      conic_memory_allocate(context, n_slots, neighbourhood->n_neighbours * sizeof *neighbourhood->neighbours);
  neighbourhood->flags = conic_memory_allocate_zeroed(context, n_slots, sizeof *neighbourhood->flags);
  neighbourhood->normals = conic_memory_allocate_zeroed(context, n_slots, sizeof *neighbourhood->normals);
  if (neighbourhood->neighbours && neighbourhood->flags && neighbourhood->normals)
    return CONIC_OK;
  conic_neighbourhood_release(context, neighbourhood);
  return CONIC_ERROR_MEMORY;
}

void conic_neighbourhood_release(conic_context *context, conic_neighbourhood *neighbourhood) {
  conic_neighbours_release(context, &neighbourhood->tree);
  conic_memory_release_these(context, neighbourhood->neighbours, neighbourhood->flags, neighbourhood->normals);
  memset(neighbourhood, 0, sizeof *neighbourhood);
}

typedef struct listing {
  conic_neighbourhood *neighbourhood;
  unsigned flags;
} listing;

static void list_slots(void *data, size_t begin, size_t end) {
  const listing *l = data;
  conic_neighbourhood *neighbourhood = l->neighbourhood;
  double distances2[CONIC_MAX_NEIGHBOURS];
  conic_neighbours_around around = {0};
  for (size_t slot = begin; slot < end; slot++) {
    if (!(neighbourhood->flags[slot] & l->flags) || neighbourhood->flags[slot] & CONIC_SLOT_LISTED)
      continue;
    conic_neighbours_of_slot(&neighbourhood->tree, slot, neighbourhood->n_neighbours, &around,
                             neighbourhood->neighbours + slot * neighbourhood->n_neighbours, distances2);
    neighbourhood->flags[slot] |= CONIC_SLOT_LISTED;
  }
}

conic_status conic_neighbourhood_list(conic_context *context, conic_neighbourhood *neighbourhood, unsigned flags,
                                      double from, double to) {
  listing l = {neighbourhood, flags};
  const conic_team_column columns[] = {
      {neighbourhood->neighbours, neighbourhood->n_neighbours * sizeof *neighbourhood->neighbours},
      {neighbourhood->flags, sizeof *neighbourhood->flags}};
  return conic_slots_share(context, neighbourhood->tree.n_slots, list_slots, &l, from, to, columns, 2);
}

void conic_neighbourhood_spread(conic_neighbourhood *neighbourhood, unsigned flags, unsigned more) {
  for (size_t slot = 0; slot < neighbourhood->tree.n_slots; slot++) {
    if (!(neighbourhood->flags[slot] & flags))
      continue;
    const uint32_t *list = conic_neighbourhood_of(neighbourhood, slot);
    for (size_t i = 0; i < neighbourhood->n_neighbours; i++)
      neighbourhood->flags[list[i]] |= (uint8_t)more;
  }
}

/* --- the spread of points about a slot --- */

conic_covariance conic_covariance_about(const conic_neighbourhood *neighbourhood, size_t slot) {
  conic_covariance covariance = {.count = 1.0};
  conic_neighbourhood_position(neighbourhood, slot, covariance.origin);
  return covariance;
}

void conic_covariance_add(conic_covariance *covariance, const conic_neighbourhood *neighbourhood, const uint32_t *slots,
                          size_t n) {
  double *sum = covariance->sum, *products = covariance->products;
  for (size_t i = 0; i < n; i++) {
    double d[3];
    conic_neighbourhood_position(neighbourhood, slots[i], d);
    for (int axis = 0; axis < 3; axis++) {
      d[axis] -= covariance->origin[axis];
      sum[axis] += d[axis];
    }
    conic_add_outer(products, d, d);
  }
  covariance->count += (double)n;
}

void conic_covariance_matrix(const conic_covariance *covariance, double matrix[6]) {
  const double *sum = covariance->sum, *products = covariance->products;
  double share = 1.0 / covariance->count;
  matrix[0] = products[0] - sum[0] * sum[0] * share;
  matrix[1] = products[1] - sum[0] * sum[1] * share;
  matrix[2] = products[2] - sum[0] * sum[2] * share;
  matrix[3] = products[3] - sum[1] * sum[1] * share;
  matrix[4] = products[4] - sum[1] * sum[2] * share;
  matrix[5] = products[5] - sum[2] * sum[2] * share;
}
