#include "lod/site_table.h"

#include <math.h>
#include <string.h>

#include "core/memory.h"
#include "lod/radix.h"

/* The least cosine between two faces that may have a surfel in common. */
static const double alike = 0.7;

static double cell_size(const conic_site_table *t, int depth) {
  return 2.0 * t->spacing / (double)(1 << depth);
}

/* Of the cells that hold the sites of a depth, or those that are deeper. */
static uint32_t *bucket_of(const conic_site_table *t, int depth, int is_deeper, const int64_t cell[3]) {
  size_t kind = (size_t)(2 * (depth - t->coarsest) + is_deeper);
  uint64_t hash = (uint64_t)cell[0] * UINT64_C(0x9e3779b97f4a7c15) ^ (uint64_t)cell[1] * UINT64_C(0xc2b2ae3d27d4eb4f) ^
                  (uint64_t)cell[2] * UINT64_C(0x165667b19e3779f9);
  return &t->buckets[kind * (t->mask + 1) + ((hash ^ hash >> 29) & t->mask)];
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
    int64_t cell[3];
    for (int axis = 0; axis < 3; axis++)
      cell[axis] = (int64_t)floor((at[axis] - table->low[axis]) / cell_size(table, d));
    uint32_t *bucket = bucket_of(table, d, d < depth, cell);
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

/* With `is_any` the first that is near enough will do. */
static void look_in_cells(const conic_site_table *t, const double at[3], const double facing[3], int depth,
                          int is_deeper, int is_any, nearness *found) {
  int64_t low[3], cell[3];
  for (int axis = 0; axis < 3; axis++)
    low[axis] = (int64_t)floor((at[axis] - t->low[axis]) / cell_size(t, depth) - 0.5);
  for (int k = 0; k < 8 && !(is_any && found->site != CONIC_NO_SITE); k++) {
    cell[0] = low[0] + (k & 1);
    cell[1] = low[1] + (k >> 1 & 1);
    cell[2] = low[2] + (k >> 2);
    for (uint32_t i = *bucket_of(t, depth, is_deeper, cell); i != CONIC_NO_SITE; i = t->places[i].next[depth]) {
      const conic_site_place *place = &t->places[i];
      double x = at[0] - place->at[0], y = at[1] - place->at[1], z = at[2] - place->at[2];
      double distance2 = (x * x + y * y) + z * z;
      double cosine = (facing[0] * place->facing[0] + facing[1] * place->facing[1]) + facing[2] * place->facing[2];
      int is_nearer = distance2 < found->distance2 || (distance2 == found->distance2 && i < found->site);
      if (is_nearer && cosine >= alike)
        *found = (nearness){distance2, i};
    }
  }
}

static uint32_t look(const conic_site_table *table, const double at[3], const double facing[3], int depth, int is_any) {
  double spacing = 0.5 * cell_size(table, depth);
  nearness found = {spacing * spacing, CONIC_NO_SITE};
  for (int d = depth; d >= table->coarsest; d--)
    look_in_cells(table, at, facing, d, 0, is_any, &found);
  if (depth < table->finest)
    look_in_cells(table, at, facing, depth, 1, is_any, &found);
  return found.site;
}

uint32_t conic_site_table_nearest(const conic_site_table *table, const double at[3], const double facing[3],
                                  int depth) {
  return look(table, at, facing, depth, 0);
}

int conic_site_table_has(const conic_site_table *table, const double at[3], const double facing[3], int depth) {
  return look(table, at, facing, depth, 1) != CONIC_NO_SITE;
}

void conic_site_table_release(conic_context *context, conic_site_table *table) {
  conic_memory_release(context, table->buckets);
  conic_memory_release(context, table->places);
  memset(table, 0, sizeof *table);
}
