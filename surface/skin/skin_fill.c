/* Closes gaps between triangles: where the triangles about a slot end at one neighbour and continue at another, one
 * more fits between. */
#include <string.h>

#include "core/base/memory.h"
#include "core/base/radix.h"
#include "surface/skin/skin_search.h"

/* Rounds, each of which makes the gaps smaller; loops of more edges than these rounds close stay open. */
enum { ROUNDS = 16 };

/* The least cosine to the corners' normals, and how much the splats that meet in its middle may be enlarged: less
 * strict than for candidates, as there is nothing else. */
static const double LEAST_COSINE = 0.0, COVERED = 1.1;

typedef struct skin_filling {
  conic_skin_search *search;
  size_t n_first; /* the number of triangles before this round */
  size_t room;
} skin_filling;

/* Whether a triangle fits the existing ones: its edges have none on the same side. */
static int has_free_edges(const conic_skin_search *search, const uint32_t slots[3]) {
  for (int k = 0; k < 3; k++)
    if (conic_skin_about(search, slots[k], 0, slots[(k + 1) % 3]) != CONIC_NO_TRIANGLE)
      return 0;
  return slots[0] != slots[1] && slots[1] != slots[2] && slots[2] != slots[0];
}

static conic_status offer_triangle(skin_filling *f, uint32_t slot, uint32_t from, uint32_t to) {
  conic_skin_search *search = f->search;
  conic_skin_triangle triangle = {.slots = {slot, from, to}, .n_votes = 0};
  if (!has_free_edges(search, triangle.slots) || !conic_skin_is_covered(search, LEAST_COSINE, COVERED, &triangle))
    return CONIC_OK;
  size_t room = f->room;
  conic_status status = conic_memory_reserve(search->context, &search->triangles, search->n_triangles,
                                             search->n_triangles + 1, &room, sizeof *search->triangles);
  if (status == CONIC_OK)
    status = conic_memory_reserve(search->context, &search->next, search->n_triangles, search->n_triangles + 1,
                                  &f->room, sizeof *search->next);
  if (status == CONIC_OK)
    search->triangles[search->n_triangles++] = triangle;
  return status;
}

/* Offers a triangle for each pair of open edges about a slot, from where one triangle ends to where another begins. */
static conic_status offer_about(skin_filling *f, uint32_t slot) {
  const conic_skin_search *search = f->search;
  conic_status status = CONIC_OK;
  for (uint32_t at = search->heads[slot]; at != CONIC_NO_TRIANGLE && status == CONIC_OK;
       at = search->next[at / 3][at % 3]) {
    uint32_t from = conic_skin_end(search, at, 1);
    if (conic_skin_about(search, slot, 0, from) != CONIC_NO_TRIANGLE)
      continue;
    for (uint32_t other = search->heads[slot]; other != CONIC_NO_TRIANGLE && status == CONIC_OK;
         other = search->next[other / 3][other % 3]) {
      uint32_t to = conic_skin_end(search, other, 0);
      if (conic_skin_about(search, slot, 1, to) == CONIC_NO_TRIANGLE)
        status = offer_triangle(f, slot, from, to);
    }
  }
  return status;
}

/* Takes the offered triangles that fit, the smallest first. *n_taken says how many. */
static conic_status take_round(skin_filling *f, size_t *n_taken) {
  conic_skin_search *search = f->search;
  size_t n = search->n_triangles - f->n_first, at = f->n_first;
  conic_radix_item *items = conic_memory_allocate(search->context, n, sizeof *items);
  conic_skin_triangle *sorted = conic_memory_allocate(search->context, n, sizeof *sorted);
  conic_status status = items && sorted ? CONIC_OK : CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < n && status == CONIC_OK; i++) {
    uint32_t bits;
    memcpy(&bits, &search->triangles[f->n_first + i].reach, sizeof bits);
    items[i] = (conic_radix_item){bits, (uint32_t)i};
    sorted[i] = search->triangles[f->n_first + i];
  }
  if (status == CONIC_OK)
    status = conic_radix_sort(search->context, items, n, 32);
  for (size_t i = 0; i < n && status == CONIC_OK; i++)
    if (has_free_edges(search, sorted[items[i].value].slots)) {
      search->triangles[at] = sorted[items[i].value];
      search->triangles[at].n_votes = 1;
      conic_skin_take(search, (uint32_t)at++);
    }
  *n_taken = at - f->n_first;
  search->n_triangles = at;
  conic_memory_release_these(search->context, sorted, items);
  return status;
}

conic_status conic_skin_fill(conic_skin_search *search) {
  skin_filling f = {.search = search, .room = search->n_triangles};
  conic_status status = CONIC_OK;
  size_t n_taken = 1;
  for (int round = 0; round < ROUNDS && n_taken > 0 && status == CONIC_OK; round++) {
    f.n_first = search->n_triangles;
    for (size_t slot = 0; slot < search->tree.n_slots && status == CONIC_OK; slot++)
      status = offer_about(&f, (uint32_t)slot);
    if (status == CONIC_OK)
      status = take_round(&f, &n_taken);
  }
  return status;
}
