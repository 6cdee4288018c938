/* Chooses, among the candidate triangles, those that fit each other. */

#include "core/base/radix.h"
#include "core/base/vectors.h"
#include "core/splats/ellipse.h"
#include "surface/skin/skin_search.h"

/* --- sectors --- */

/* The part of a corner's plane that a triangle takes: from the first direction to the second, less than half of the
 * plane. */
typedef struct sector {
  uint32_t ends[2];
  double ways[2][2];
} sector;

static double turn_between(const double a[2], const double b[2]) {
  return a[0] * b[1] - a[1] * b[0];
}

static void sector_of(const conic_skin_search *search, const conic_skin_triangle *triangle, int corner, sector *found) {
  double at[3], normal[3], u[3], v[3], end[3], way[3];
  conic_vector_at(search->tree.position, triangle->slots[corner], at);
  conic_vector_at(search->normal, triangle->slots[corner], normal);
  conic_tangent_basis(normal, u, v);
  for (int k = 0; k < 2; k++) {
    found->ends[k] = triangle->slots[(corner + 1 + k) % 3];
    conic_vector_at(search->tree.position, found->ends[k], end);
    conic_subtract(end, at, way);
    found->ways[k][0] = conic_dot(way, u);
    found->ways[k][1] = conic_dot(way, v);
  }
}

static int is_in_sector(const sector *s, const double way[2]) {
  return turn_between(s->ways[0], way) > 0.0 && turn_between(way, s->ways[1]) > 0.0;
}

static int do_overlap(const sector *a, const sector *b) {
  return a->ends[0] == b->ends[0] || a->ends[1] == b->ends[1] || is_in_sector(a, b->ways[0]) ||
         is_in_sector(a, b->ways[1]) || is_in_sector(b, a->ways[0]) || is_in_sector(b, a->ways[1]);
}

static int has_room(const conic_skin_search *search, uint32_t i) {
  const conic_skin_triangle *triangle = &search->triangles[i];
  for (int corner = 0; corner < 3; corner++) {
    sector own, other;
    sector_of(search, triangle, corner, &own);
    if (!(turn_between(own.ways[0], own.ways[1]) > 0.0))
      return 0;
    for (uint32_t at = search->heads[triangle->slots[corner]]; at != CONIC_NO_TRIANGLE;
         at = search->next[at / 3][at % 3]) {
      sector_of(search, &search->triangles[at / 3], (int)(at % 3), &other);
      if (do_overlap(&own, &other))
        return 0;
    }
  }
  return 1;
}

/* --- all --- */

uint32_t conic_skin_about(const conic_skin_search *search, uint32_t slot, uint32_t end, uint32_t other) {
  uint32_t at = search->heads[slot];
  while (at != CONIC_NO_TRIANGLE && conic_skin_end(search, at, end) != other)
    at = search->next[at / 3][at % 3];
  return at;
}

void conic_skin_take(conic_skin_search *search, uint32_t i) {
  const uint32_t *slots = search->triangles[i].slots;
  for (uint32_t corner = 0; corner < 3; corner++) {
    search->next[i][corner] = search->heads[slots[corner]];
    search->heads[slots[corner]] = 3 * i + corner;
  }
}

/* Orders the candidates: those wanted by most corners first, among these the smallest circles. */
static conic_status order_candidates(const conic_skin_search *search, conic_radix_item *items) {
  for (size_t i = 0; i < search->n_triangles; i++) {
    uint32_t bits;
    memcpy(&bits, &search->triangles[i].reach, sizeof bits);
    items[i] = (conic_radix_item){(uint64_t)(3 - search->triangles[i].n_votes) << 32 | bits, (uint32_t)i};
  }
  return conic_radix_sort(search->context, items, search->n_triangles, 34);
}

/* Candidates that are not taken stay, outside of all lists. */
conic_status conic_skin_choose(conic_skin_search *search) {
  conic_context *context = search->context;
  search->heads = conic_memory_allocate(context, search->tree.n_slots, sizeof *search->heads);
  search->next = conic_memory_allocate(context, search->n_triangles, sizeof *search->next);
  conic_radix_item *items = conic_memory_allocate(context, search->n_triangles, sizeof *items);
  conic_status status = search->heads && search->next && items ? CONIC_OK : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK) {
    memset(search->heads, 0xFF, search->tree.n_slots * sizeof *search->heads);
    status = order_candidates(search, items);
  }
  for (size_t i = 0; i < search->n_triangles && status == CONIC_OK; i++)
    if (has_room(search, items[i].value))
      conic_skin_take(search, items[i].value);
    else
      search->triangles[items[i].value].n_votes = 0;
  conic_memory_release(context, items);
  return status;
}
