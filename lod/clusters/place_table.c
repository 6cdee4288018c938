/* Places of a cluster, found by where they are. Each has the nearest of the sites that were put so far. */
#include "lod/clusters/cluster_sites.h"

/* The side of a depth's cells, in spacings. */
static const double cell_side = 1.4;

static double spacing_of(const conic_place_table *t, int depth) {
  return t->places.spacing / (double)(1 << depth);
}

/* Which cell a place lies in along an axis: never less for a larger `way` from the first place. */
static int64_t cell_along(double way, double cells_a_length) {
  return (int64_t)(way * cells_a_length);
}

/* Cells that follow each other along x lie in buckets that do so, too, but for the last of a depth's and its first. */
static uint64_t row_hash(int64_t y, int64_t z) {
  uint64_t hash = (uint64_t)y * UINT64_C(0xc2b2ae3d27d4eb4f) + (uint64_t)z * UINT64_C(0x165667b19e3779f9);
  return hash ^ hash >> 29;
}

static size_t bucket_of(const conic_place_table *t, int depth, uint64_t row, int64_t x) {
  return (size_t)(depth - t->places.coarsest) * (t->mask + 1) + (size_t)((row + (uint64_t)x) & t->mask);
}

static conic_status make_room_for_places(conic_context *context, conic_place_table *t, size_t n_places,
                                         size_t n_starts) {
  if (n_starts > t->starts_room) {
    conic_memory_release(context, t->starts);
    t->starts = conic_memory_allocate(context, n_starts, sizeof *t->starts);
    t->starts_room = t->starts ? n_starts : 0;
  }
  if (n_places > t->room) {
    size_t room = n_places + n_places / 2;
    conic_memory_release_these(context, t->place, t->at[0]);
    t->place = conic_memory_allocate(context, room, sizeof *t->place);
    t->at[0] = conic_memory_allocate(context, room, 4 * sizeof *t->at[0]);
    t->room = t->place && t->at[0] ? room : 0;
    for (int axis = 1; axis < 3 && t->room; axis++)
      t->at[axis] = t->at[0] + (size_t)axis * room;
    t->nearest2 = t->room ? t->at[0] + 3 * room : NULL;
  }
  return t->starts_room && t->room >= n_places ? CONIC_OK : CONIC_ERROR_MEMORY;
}

static size_t bucket_of_place(const conic_place_table *t, size_t place, int depth) {
  double cells_a_length = 1.0 / (cell_side * spacing_of(t, depth));
  int64_t cell[3];
  for (int axis = 0; axis < 3; axis++)
    cell[axis] = cell_along(t->places.at[place][axis] - t->places.at[0][axis], cells_a_length);
  return bucket_of(t, depth, row_hash(cell[1], cell[2]), cell[0]);
}

/* Sorts by counting: the buckets wait where owners will be. */
conic_status conic_place_table_fill(conic_context *context, conic_place_table *t, const conic_places *places,
                                    uint32_t *owner) {
  size_t side = (size_t)1 << conic_bits_below(places->n / 4 + 16);
  size_t n_buckets = (size_t)(places->finest - places->coarsest + 1) * side;
  conic_status status = make_room_for_places(context, t, places->n, n_buckets + 2);
  if (status != CONIC_OK)
    return status;
  t->places = *places;
  t->owner = owner;
  t->mask = side - 1;
  memset(t->starts, 0, (n_buckets + 2) * sizeof *t->starts);
  for (size_t i = 0; i < places->n; i++) {
    owner[i] = (uint32_t)bucket_of_place(t, i, places->depth[places->group[i]]);
    t->starts[owner[i] + 2]++;
  }
  for (size_t i = 2; i < n_buckets + 2; i++)
    t->starts[i] += t->starts[i - 1];
  for (size_t i = 0; i < places->n; i++) {
    size_t slot = t->starts[owner[i] + 1]++;
    double spacing = spacing_of(t, places->depth[places->group[i]]);
    t->place[slot] = (uint32_t)i;
    t->nearest2[slot] = spacing * spacing;
    for (int axis = 0; axis < 3; axis++)
      t->at[axis][slot] = places->at[i][axis];
    owner[i] = CONIC_NO_SITE;
  }
  return CONIC_OK;
}

/* A site that is put. */
typedef struct newcomer {
  uint32_t site;
  const double *at, *facing;
  size_t first;
} newcomer;

/* Gives a place to the newcomer where that faces alike and is nearer than the owner. Where both are as near, the owner
 * stays. */
static void claim(conic_place_table *t, const newcomer *n, size_t slot, double distance2) {
  uint32_t place = t->place[slot];
  const double *facing = t->places.facing[t->places.group[place]];
  int is_nearer = distance2 < t->nearest2[slot] || t->owner[place] == CONIC_NO_SITE;
  double cosine = (facing[0] * n->facing[0] + facing[1] * n->facing[1]) + facing[2] * n->facing[2];
  if (is_nearer && place >= n->first && cosine >= CONIC_SITES_ALIKE) {
    t->nearest2[slot] = distance2;
    t->owner[place] = n->site;
  }
}

/* So many places are looked at together. Those that are near enough are found without branches, and then claimed. */
enum { AT_A_TIME = 32 };

static void claim_among(conic_place_table *t, const newcomer *n, size_t begin, size_t end) {
  const double *at_x = t->at[0], *at_y = t->at[1], *at_z = t->at[2], *nearest2 = t->nearest2;
  const double to_x = n->at[0], to_y = n->at[1], to_z = n->at[2];
  uint32_t near[AT_A_TIME + 1] = {0};
  double distances2[AT_A_TIME + 1] = {0.0};
  for (size_t first = begin; first < end; first += AT_A_TIME) {
    size_t last = end - first < AT_A_TIME ? end : first + AT_A_TIME, n_near = 0;
    for (size_t i = first; i < last; i++) {
      double x = at_x[i] - to_x, y = at_y[i] - to_y, z = at_z[i] - to_z, distance2 = (x * x + y * y) + z * z;
      near[n_near] = (uint32_t)i;
      distances2[n_near] = distance2;
      n_near += distance2 <= nearest2[i];
    }
    for (size_t k = 0; k < n_near; k++)
      claim(t, n, near[k], distances2[k]);
  }
}

/* In the cells of a row, from one to another. */
static void claim_in_row(conic_place_table *t, const newcomer *n, int depth, uint64_t row, int64_t low, int64_t high) {
  for (int64_t x = low, last; x <= high; x = last + 1) {
    size_t first = bucket_of(t, depth, row, x), bucket = first;
    for (last = x; last < high && bucket_of(t, depth, row, last + 1) == bucket + 1; last++)
      bucket++;
    claim_among(t, n, t->starts[first], t->starts[bucket + 1]);
  }
}

static void claim_at_depth(conic_place_table *t, const newcomer *n, int depth) {
  double spacing = spacing_of(t, depth), cells_a_length = 1.0 / (cell_side * spacing);
  double reach = spacing * (1.0 + 1e-6); /* more than rounding takes */
  int64_t low[3], high[3];
  for (int axis = 0; axis < 3; axis++) {
    double way = n->at[axis] - t->places.at[0][axis];
    low[axis] = cell_along(way - reach, cells_a_length);
    high[axis] = cell_along(way + reach, cells_a_length);
  }
  for (int64_t z = low[2]; z <= high[2]; z++)
    for (int64_t y = low[1]; y <= high[1]; y++)
      claim_in_row(t, n, depth, row_hash(y, z), low[0], high[0]);
}

void conic_place_table_put(conic_place_table *table, uint32_t site, const double at[3], const double facing[3],
                           size_t first) {
  newcomer n = {.site = site, .at = at, .facing = facing, .first = first};
  for (int depth = table->places.coarsest; depth <= table->places.finest; depth++)
    claim_at_depth(table, &n, depth);
}

void conic_place_table_release(conic_context *context, conic_place_table *table) {
  conic_memory_release_these(context, table->starts, table->place, table->at[0]);
  memset(table, 0, sizeof *table);
}
