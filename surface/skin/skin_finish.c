/* Drops small pieces of the skin, and finds the splats that its triangles surround. */
#include "core/base/memory.h"
#include "surface/skin/skin_search.h"

/* Pieces of fewer vertices stay splats. */
enum { LEAST_PIECE = 256 };

typedef struct skin_pieces {
  conic_skin_search *search;
  uint32_t *parent; /* of each slot: another slot of its piece */
  uint32_t *count;  /* of each slot that stands for a piece: the piece's slots */
} skin_pieces;

static uint32_t piece_of(skin_pieces *p, uint32_t slot) {
  while (p->parent[slot] != slot)
    slot = p->parent[slot] = p->parent[p->parent[slot]];
  return slot;
}

static void join_pieces(skin_pieces *p, uint32_t a, uint32_t b) {
  uint32_t first = piece_of(p, a), second = piece_of(p, b);
  if (first == second)
    return;
  uint32_t kept = first < second ? first : second, gone = first < second ? second : first;
  p->parent[gone] = kept;
  p->count[kept] += p->count[gone];
}

static int is_large(skin_pieces *p, uint32_t slot) {
  return p->count[piece_of(p, slot)] >= LEAST_PIECE;
}

/* Whether each of a slot's triangles begins where another one ends. */
static int is_closed_about(skin_pieces *p, uint32_t slot) {
  const conic_skin_search *search = p->search;
  for (uint32_t at = search->heads[slot]; at != CONIC_NO_TRIANGLE; at = search->next[at / 3][at % 3])
    if (conic_skin_about(search, slot, 1, conic_skin_end(search, at, 0)) == CONIC_NO_TRIANGLE)
      return 0;
  return search->heads[slot] != CONIC_NO_TRIANGLE && is_large(p, slot);
}

static void finish_pieces(skin_pieces *p) {
  conic_skin_search *search = p->search;
  size_t n = 0;
  for (size_t slot = 0; slot < search->tree.n_slots; slot++) {
    p->parent[slot] = (uint32_t)slot;
    p->count[slot] = 1;
  }
  for (size_t i = 0; i < search->n_triangles; i++)
    for (int corner = 1; corner < 3 && search->triangles[i].n_votes > 0; corner++)
      join_pieces(p, search->triangles[i].slots[0], search->triangles[i].slots[corner]);
  for (size_t slot = 0; slot < search->tree.n_slots; slot++)
    search->is_closed[slot] = (uint8_t)is_closed_about(p, (uint32_t)slot);
  for (size_t i = 0; i < search->n_triangles; i++)
    if (search->triangles[i].n_votes > 0 && is_large(p, search->triangles[i].slots[0]))
      search->triangles[n++] = search->triangles[i];
  search->n_triangles = n;
}

conic_status conic_skin_finish(conic_skin_search *search) {
  conic_context *context = search->context;
  size_t n_slots = search->tree.n_slots;
  skin_pieces p = {search, conic_memory_allocate(context, n_slots, sizeof *p.parent),
                   conic_memory_allocate(context, n_slots, sizeof *p.count)};
  search->is_closed = conic_memory_allocate(context, n_slots, 1);
  int is_there = p.parent && p.count && search->is_closed;
  if (is_there)
    finish_pieces(&p);
  conic_memory_release_these(context, p.count, p.parent);
  return is_there ? CONIC_OK : CONIC_ERROR_MEMORY;
}
