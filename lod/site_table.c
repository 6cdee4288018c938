#include "lod/site_table.h"

#include <math.h>
#include <string.h>

#include "core/memory.h"
#include "lod/radix.h"

static double cell_size(const conic_site_table *t, int depth) {
  return 2.0 * t->spacing / (double)(1 << depth);
}

/* A cell's hash is the sum of those of its places along the axes. */
static uint64_t hash_along(int axis, int64_t cell) {
  static const uint64_t factors[3] = {UINT64_C(0x9e3779b97f4a7c15), UINT64_C(0xc2b2ae3d27d4eb4f),
                                      UINT64_C(0x165667b19e3779f9)};
  return (uint64_t)cell * factors[axis];
}

/* Of the cells that hold the sites of a depth, or those that are deeper. */
static uint32_t *bucket_of(const conic_site_table *t, int depth, int is_deeper, uint64_t hash) {
  int kind = 2 * (depth - t->coarsest) + is_deeper;
  return &t->buckets[(size_t)kind * (t->mask + 1) + ((hash ^ hash >> 29) & t->mask)];
}

conic_status conic_site_table_clear(conic_context *context, conic_site_table *table, const double low[3],
                                    double spacing, int coarsest, int finest, size_t n_expected) {
  size_t side = (size_t)1 << (conic_bits_below(n_expected + 16) + 1);
  size_t wanted = (size_t)(2 * (finest - coarsest) + 1) * side; /* nothing is deeper than the finest */
  if (wanted > table->buckets_room) {
    conic_memory_release(context, table->buckets);
    table->buckets = conic_memory_allocate(context, wanted, sizeof *table->buckets);
    table->buckets_room = table->buckets ? wanted : 0;
    if (!table->buckets)
      return CONIC_ERROR_MEMORY;
  }
  memset(table->buckets, 0xFF, wanted * sizeof *table->buckets);
  memcpy(table->low, low, sizeof table->low);
  table->spacing = spacing;
  table->coarsest = coarsest;
  table->finest = finest;
  table->mask = side - 1;
  table->n_places = 0;
  return CONIC_OK;
}

conic_status conic_site_table_add(conic_context *context, conic_site_table *table, const double at[3],
                                  const double facing[3], int depth) {
  if (table->n_places == table->places_room) {
    size_t room = 2 * table->places_room + 64;
    void *places = table->places;
    conic_status status = conic_memory_grow(context, &places, table->n_places, room, sizeof *table->places);
    table->places = places;
    if (status != CONIC_OK)
      return status;
    table->places_room = room;
  }
  conic_site_place *place = &table->places[table->n_places];
  memcpy(place->at, at, sizeof place->at);
  memcpy(place->facing, facing, sizeof place->facing);
  for (int d = table->coarsest; d <= depth; d++) {
    uint64_t hash = 0;
    for (int axis = 0; axis < 3; axis++)
      hash += hash_along(axis, (int64_t)floor((at[axis] - table->low[axis]) / cell_size(table, d)));
    uint32_t *bucket = bucket_of(table, d, d < depth, hash);
    place->next[d] = *bucket;
    *bucket = (uint32_t)table->n_places;
  }
  table->n_places++;
  return CONIC_OK;
}

typedef struct nearness {
  double distance2;
  uint32_t site;
} nearness;

/* Notes the site where it faces alike and is nearer, or as near and an earlier one. */
static void look_at_site(const conic_site_table *t, uint32_t i, const double at[3], const double facing[3],
                         nearness *found) {
  const conic_site_place *place = &t->places[i];
  double x = at[0] - place->at[0], y = at[1] - place->at[1], z = at[2] - place->at[2];
  double distance2 = (x * x + y * y) + z * z;
  if (!(distance2 < found->distance2 || (distance2 == found->distance2 && i < found->site)))
    return;
  double cosine = (facing[0] * place->facing[0] + facing[1] * place->facing[1]) + facing[2] * place->facing[2];
  if (cosine >= CONIC_SITES_ALIKE)
    *found = (nearness){distance2, i};
}

static void look_in_cell(const conic_site_table *t, const uint32_t *bucket, const double at[3], const double facing[3],
                         int depth, nearness *found) {
  for (uint32_t i = *bucket; i != CONIC_NO_SITE; i = t->places[i].next[depth])
    look_at_site(t, i, at, facing, found);
}

/* The cell that the place lies in, then those beside it that are no farther than what is found. With `is_any` the
 * first that is near enough will do. Without branches where chance would decide them. */
static void look_in_cells(const conic_site_table *t, const double at[3], const double facing[3], int depth,
                          int is_deeper, int is_any, nearness *found) {
  double size = cell_size(t, depth), gaps2[3][2];
  uint64_t hashes[3][2], near[8];
  size_t n_near = 0;
  for (int axis = 0; axis < 3; axis++) {
    double cells = (at[axis] - t->low[axis]) / size, own = floor(cells), below = cells - own, above = 1.0 - below;
    double gap = (below < above ? below : above) * size;
    gaps2[axis][0] = 0.0;
    gaps2[axis][1] = gap * gap * (1.0 - 1e-9); /* more than rounding takes */
    hashes[axis][0] = hash_along(axis, (int64_t)own);
    hashes[axis][1] = hash_along(axis, (int64_t)own + 1 - 2 * (int64_t)(below < above));
  }
  look_in_cell(t, bucket_of(t, depth, is_deeper, hashes[0][0] + hashes[1][0] + hashes[2][0]), at, facing, depth, found);
  for (int k = 1; k < 8; k++) {
    int x = k & 1, y = k >> 1 & 1, z = k >> 2;
    near[n_near] = hashes[0][x] + hashes[1][y] + hashes[2][z];
    n_near += (size_t)((gaps2[0][x] + gaps2[1][y]) + gaps2[2][z] <= found->distance2);
  }
  for (size_t i = 0; i < n_near && !(is_any && found->site != CONIC_NO_SITE); i++)
    look_in_cell(t, bucket_of(t, depth, is_deeper, near[i]), at, facing, depth, found);
}

static uint32_t look(const conic_site_table *table, const double at[3], const double facing[3], int depth,
                     uint32_t guess, int is_any) {
  double spacing = 0.5 * cell_size(table, depth);
  nearness found = {spacing * spacing, CONIC_NO_SITE};
  if (guess != CONIC_NO_SITE)
    look_at_site(table, guess, at, facing, &found);
  for (int d = depth; d >= table->coarsest; d--)
    look_in_cells(table, at, facing, d, 0, is_any, &found);
  if (depth < table->finest)
    look_in_cells(table, at, facing, depth, 1, is_any, &found);
  return found.site;
}

uint32_t conic_site_table_nearest(const conic_site_table *table, const double at[3], const double facing[3], int depth,
                                  uint32_t guess) {
  return look(table, at, facing, depth, guess, 0);
}

int conic_site_table_has(const conic_site_table *table, const double at[3], const double facing[3], int depth) {
  return look(table, at, facing, depth, CONIC_NO_SITE, 1) != CONIC_NO_SITE;
}

void conic_site_table_release(conic_context *context, conic_site_table *table) {
  conic_memory_release(context, table->buckets);
  conic_memory_release(context, table->places);
  memset(table, 0, sizeof *table);
}
