/* The search for neighbours among the leaves around some: of few and of many, with ties, and with leaves that are not
 * full. */
#include "bench/loops/cross.h"
#include "core/estimate/neighbour_loops.h"

enum { N_QUERIES = 60, MOST_KEYS = 100 };

typedef struct leaves_desk {
  cross_desk memory;
  conic_near_leaves *leaves;
  float *keys;
  uint32_t *n_found, *slots, *places; /* what is found by all queries, one after the other */
  double *distances2;
} leaves_desk;

static void fill_leaves(conic_near_leaves *leaves, size_t n, float *keys, uint64_t seed) {
  uint64_t state = seed;
  leaves->n = n;
  for (size_t k = 0; k < CONIC_NEAR_LEAVES_ROOM; k++)
    for (int axis = 0; axis < 3; axis++)
      leaves->low[axis][k] = leaves->high[axis][k] = HUGE_VALF;
  for (size_t k = 0; k < n; k++) {
    leaves->first[k] = (uint32_t)(100 + CONIC_LEAF_SLOTS * k);
    for (int axis = 0; axis < 3; axis++) {
      float *place = leaves->place[axis] + k * CONIC_LEAF_ROOM, low = (float)(k >> axis & 3);
      leaves->low[axis][k] = low;
      leaves->high[axis][k] = low + 1.0f;
      for (size_t i = 0; i < CONIC_LEAF_ROOM; i++) /* of eighths, so that many are as near as others */
        place[i] = i < CONIC_LEAF_SLOTS - k % 4 ? low + 0.125f * (float)(int)(8.9 * fixture_random(&state)) : NAN;
    }
  }
  for (size_t i = 0; i < MOST_KEYS; i++)
    keys[i] = (float)(int)(40.0 * fixture_random(&state));
}

static leaves_desk *open_leaves(size_t n, uint64_t seed) {
  leaves_desk *d = cross_calloc(sizeof *d);
  size_t room = (size_t)N_QUERIES * n * CONIC_LEAF_SLOTS + 16;
  d->leaves = cross_room(&d->memory, "leaves", sizeof *d->leaves);
  d->keys = cross_room(&d->memory, "keys", (MOST_KEYS + CONIC_KEYS_AT_ONCE) * sizeof(float));
  d->n_found = cross_room(&d->memory, "counts", N_QUERIES * sizeof(uint32_t));
  d->slots = cross_room(&d->memory, "slots", room * sizeof(uint32_t));
  d->distances2 = cross_room(&d->memory, "distances", room * sizeof(double));
  d->places = cross_room(&d->memory, "places", (MOST_KEYS + CONIC_KEYS_AT_ONCE) * sizeof(uint32_t));
  fill_leaves(d->leaves, n, d->keys, seed);
  return d;
}

/* What lies behind the last may be anything. */
static void run_find(const cross_tables *tables, cross_desk *desk) {
  leaves_desk *d = (leaves_desk *)(void *)desk;
  size_t n = 0;
  for (int i = 0; i < N_QUERIES; i++) {
    const double query[3] = {0.25 * (i % 5), 0.5 + 0.125 * (i % 7), 0.7 + 0.05 * i};
    d->n_found[i] = (uint32_t)tables->neighbours.find(d->leaves, query, 0.03 * i, (uint32_t)(100 + 5 * i), d->slots + n,
                                                      d->distances2 + n);
    n += d->n_found[i];
  }
  for (size_t i = n; i < n + 16; i++) {
    d->slots[i] = 0;
    d->distances2[i] = 0.0;
  }
}

static void run_rank(const cross_tables *tables, cross_desk *desk) {
  leaves_desk *d = (leaves_desk *)(void *)desk;
  for (size_t n = 1; n <= MOST_KEYS; n += 11) {
    tables->neighbours.rank(d->keys, n, d->places);
    memset(d->places + n, 0, CONIC_KEYS_AT_ONCE * sizeof(uint32_t));
  }
}

static void check_found(const leaves_desk *d) {
  size_t n = 0, n_all = d->leaves->n * CONIC_LEAF_SLOTS;
  for (int i = 0; i < N_QUERIES; n += d->n_found[i++])
    for (size_t k = n; k < n + d->n_found[i]; k++)
      CHECK(d->distances2[k] <= 0.03 * i && d->slots[k] != (uint32_t)(100 + 5 * i) && d->slots[k] >= 100 &&
            d->slots[k] < 100 + n_all);
  CHECK(n > 0 && n < N_QUERIES * n_all);
}

int cli_cross_neighbours(cross *c) {
  static const size_t counts[] = {64, 1, 3, 21, CONIC_MOST_NEAR_LEAVES};
  for (size_t i = 0; i < (c->is_bench ? 1 : sizeof counts / sizeof counts[0]); i++) {
    static const cross_slot slots[] = {{"find", "neighbours", run_find, "query", N_QUERIES},
                                       {"rank", "neighbours", run_rank, "list", (MOST_KEYS + 10) / 11}};
    leaves_desk *desks[CONIC_N_ISAS];
    for (int k = 0; k < c->n_tables; k++)
      desks[k] = open_leaves(counts[i], c->seed + i);
    cross_try(c, &slots[0], (cross_desk **)(void *)desks);
    cross_try(c, &slots[1], (cross_desk **)(void *)desks);
    for (int k = 0; k < c->n_tables; k++) {
      check_found(desks[k]);
      cross_close(&desks[k]->memory);
    }
  }
  return check_failures;
}
