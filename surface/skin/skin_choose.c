/* Of the triangles that corners would have, those that fit each other. */
#include <string.h>

#include "core/base/memory.h"
#include "core/base/radix.h"
#include "core/base/vectors.h"
#include "core/splats/ellipse.h"
#include "surface/skin/skin_search.h"

#define CONIC_NO_TRIANGLE UINT32_MAX

/* Pieces of fewer vertices stay splats. */
enum { LEAST_PIECE = 32 };

typedef struct skin_choosing {
  conic_skin_search *search;
  uint32_t *heads;    /* of each slot: the last triangle that was taken there, 3 · triangle + its corner */
  uint32_t (*next)[3]; /* of each triangle's corners: the one that was taken there before */
  uint32_t *parent;   /* of each slot: one of its piece */
  uint32_t *count;    /* of each slot that stands for a piece: its slots */
} skin_choosing;

/* --- sectors --- */

/* What a triangle takes of a corner's plane: from the first direction on to the second, less than half of it. */
typedef struct sector {
  uint32_t ends[2];
  double ways[2][2];
} sector;

static double turn(const double a[2], const double b[2]) {
  return a[0] * b[1] - a[1] * b[0];
}

static void sector_of(const conic_skin_search *search, const conic_skin_triangle *triangle, int corner,
                      sector *found) {
  double at[3], normal[3], u[3], v[3], end[3], way[3];
  conic_skin_place(search, triangle->slots[corner], at);
  conic_skin_normal(search, triangle->slots[corner], normal);
  conic_tangent_basis(normal, u, v);
  for (int k = 0; k < 2; k++) {
    found->ends[k] = triangle->slots[(corner + 1 + k) % 3];
    conic_skin_place(search, found->ends[k], end);
    conic_subtract(end, at, way);
    found->ways[k][0] = conic_dot(way, u);
    found->ways[k][1] = conic_dot(way, v);
  }
}

static int is_within(const sector *s, const double way[2]) {
  return turn(s->ways[0], way) > 0.0 && turn(way, s->ways[1]) > 0.0;
}

static int do_overlap(const sector *a, const sector *b) {
  return a->ends[0] == b->ends[0] || a->ends[1] == b->ends[1] || is_within(a, b->ways[0]) ||
         is_within(a, b->ways[1]) || is_within(b, a->ways[0]) || is_within(b, a->ways[1]);
}

static int has_room(const skin_choosing *c, uint32_t i) {
  const conic_skin_triangle *triangle = &c->search->triangles[i];
  for (int corner = 0; corner < 3; corner++) {
    sector own, other;
    sector_of(c->search, triangle, corner, &own);
    if (!(turn(own.ways[0], own.ways[1]) > 0.0))
      return 0;
    for (uint32_t at = c->heads[triangle->slots[corner]]; at != CONIC_NO_TRIANGLE; at = c->next[at / 3][at % 3]) {
      sector_of(c->search, &c->search->triangles[at / 3], (int)(at % 3), &other);
      if (do_overlap(&own, &other))
        return 0;
    }
  }
  return 1;
}

/* --- pieces --- */

static uint32_t piece_of(skin_choosing *c, uint32_t slot) {
  while (c->parent[slot] != slot)
    slot = c->parent[slot] = c->parent[c->parent[slot]];
  return slot;
}

static void join_pieces(skin_choosing *c, uint32_t a, uint32_t b) {
  uint32_t first = piece_of(c, a), second = piece_of(c, b);
  if (first == second)
    return;
  uint32_t kept = first < second ? first : second, gone = first < second ? second : first;
  c->parent[gone] = kept;
  c->count[kept] += c->count[gone];
}

static void take_triangle(skin_choosing *c, uint32_t i) {
  const uint32_t *slots = c->search->triangles[i].slots;
  for (uint32_t corner = 0; corner < 3; corner++) {
    c->next[i][corner] = c->heads[slots[corner]];
    c->heads[slots[corner]] = 3 * i + corner;
    join_pieces(c, slots[0], slots[corner]);
  }
}

/* --- all --- */

/* Those that most corners have come first, of these the smallest circles. */
static conic_status order_candidates(const conic_skin_search *search, conic_radix_item *items) {
  for (size_t i = 0; i < search->n_triangles; i++) {
    uint32_t bits;
    memcpy(&bits, &search->triangles[i].reach, sizeof bits);
    items[i] = (conic_radix_item){(uint64_t)(3 - search->triangles[i].n_votes) << 32 | bits, (uint32_t)i};
  }
  return conic_radix_sort(search->context, items, search->n_triangles, 34);
}

/* Which slot the triangle at a corner, 3 · triangle + corner, begins at (0) or ends at (1), seen from the corner's. */
static uint32_t end_of(const skin_choosing *c, uint32_t at, uint32_t end) {
  return c->search->triangles[at / 3].slots[(at % 3 + 1 + end) % 3];
}

/* Whether each of a slot's triangles begins where another one ends: as none overlap, they then close all around it. */
static int is_closed_about(skin_choosing *c, uint32_t slot) {
  for (uint32_t at = c->heads[slot]; at != CONIC_NO_TRIANGLE; at = c->next[at / 3][at % 3]) {
    uint32_t other = c->heads[slot];
    while (other != CONIC_NO_TRIANGLE && end_of(c, other, 1) != end_of(c, at, 0))
      other = c->next[other / 3][other % 3];
    if (other == CONIC_NO_TRIANGLE)
      return 0;
  }
  return c->heads[slot] != CONIC_NO_TRIANGLE && c->count[piece_of(c, slot)] >= LEAST_PIECE;
}

static void choose_in_order(skin_choosing *c, const conic_radix_item *items) {
  conic_skin_search *search = c->search;
  size_t n = 0;
  for (size_t slot = 0; slot < search->tree.n_slots; slot++) {
    c->heads[slot] = CONIC_NO_TRIANGLE;
    c->parent[slot] = (uint32_t)slot;
    c->count[slot] = 1;
  }
  for (size_t i = 0; i < search->n_triangles; i++) {
    int is_taken = has_room(c, items[i].value);
    if (is_taken)
      take_triangle(c, items[i].value);
    else
      search->triangles[items[i].value].n_votes = 0;
  }
  for (size_t slot = 0; slot < search->tree.n_slots; slot++)
    search->is_closed[slot] = (uint8_t)is_closed_about(c, (uint32_t)slot);
  for (size_t i = 0; i < search->n_triangles; i++)
    if (search->triangles[i].n_votes > 0 && c->count[piece_of(c, search->triangles[i].slots[0])] >= LEAST_PIECE)
      search->triangles[n++] = search->triangles[i];
  search->n_triangles = n;
}

conic_status conic_skin_choose(conic_skin_search *search) {
  conic_context *context = search->context;
  size_t n_slots = search->tree.n_slots;
  skin_choosing c = {search, conic_memory_allocate(context, n_slots, sizeof *c.heads),
                      conic_memory_allocate(context, search->n_triangles, sizeof *c.next),
                      conic_memory_allocate(context, n_slots, sizeof *c.parent),
                      conic_memory_allocate(context, n_slots, sizeof *c.count)};
  conic_radix_item *items = conic_memory_allocate(context, search->n_triangles, sizeof *items);
  search->is_closed = conic_memory_allocate(context, n_slots, 1);
  conic_status status = search->is_closed && c.heads && c.next && c.parent && c.count && items ? CONIC_OK : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK)
    status = order_candidates(search, items);
  if (status == CONIC_OK)
    choose_in_order(&c, items);
  conic_memory_release(context, items);
  conic_memory_release(context, c.count);
  conic_memory_release(context, c.parent);
  conic_memory_release(context, c.next);
  conic_memory_release(context, c.heads);
  return status;
}
