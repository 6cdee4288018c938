#include "surface/skin/skin.h"

#include "core/base/radix.h"
#include "core/base/vectors.h"
#include "surface/skin/skin_search.h"

int conic_skin_ellipse(const conic_skin_search *search, uint32_t slot, double u[3], double v[3]) {
  const conic_splats *splats = search->splats;
  uint32_t splat = search->tree.point_of_slot[slot];
  conic_vector_at(splats->tangent_u, splat, u);
  conic_vector_at(splats->tangent_v, splat, v);
  double uu = search->cutoff * conic_dot(u, u), vv = search->cutoff * conic_dot(v, v);
  int is_ellipse = uu > 0.0 && vv > 0.0 && uu < 1e300 && vv < 1e300;
  for (int axis = 0; axis < 3 && is_ellipse; axis++) {
    u[axis] /= uu;
    v[axis] /= vv;
  }
  return is_ellipse;
}

/* The unit normal of a splat that can be part of a surface; returns 0 for a dot, or a splat that spans no plane. */
static int find_splat_plane(const conic_splats *splats, size_t splat, double normal[3]) {
  double u[3], v[3];
  conic_vector_at(splats->tangent_u, splat, u);
  conic_vector_at(splats->tangent_v, splat, v);
  conic_cross(u, v, normal);
  return conic_normalize(normal) && !(splats->dot && splats->dot[splat] != 0.0f);
}

/* Builds the tree of splats that can be part of a surface; for the tree, the others have no position. */
static conic_status build_tree(conic_skin_search *search) {
  const conic_splats *splats = search->splats;
  size_t n = splats->count;
  float *places = conic_memory_allocate(search->context, n, 3 * sizeof *places);
  if (!places)
    return CONIC_ERROR_MEMORY;
  const float *const positions[3] = {places, places + n, places + 2 * n};
  for (size_t i = 0; i < n; i++) {
    double normal[3];
    int is_of_use = find_splat_plane(splats, i, normal);
    for (size_t axis = 0; axis < 3; axis++)
      places[axis * n + i] = is_of_use ? splats->position[axis][i] : NAN;
  }
  conic_status status = conic_neighbours_build(search->context, positions, n, &search->tree);
  conic_memory_release(search->context, places);
  return status;
}

static conic_status find_own_normals(conic_skin_search *search) {
  for (int axis = 0; axis < 3; axis++) {
    search->normal[axis] = conic_memory_allocate(search->context, search->tree.n_slots, sizeof *search->normal[axis]);
    if (!search->normal[axis])
      return CONIC_ERROR_MEMORY;
  }
  for (size_t slot = 0; slot < search->tree.n_slots; slot++) {
    double normal[3];
    find_splat_plane(search->splats, search->tree.point_of_slot[slot], normal);
    for (int axis = 0; axis < 3; axis++)
      search->normal[axis][slot] = (float)normal[axis];
  }
  return CONIC_OK;
}

/* Finds normals, colours and lifts; all later steps use these normals. */
static conic_status look_all_over(conic_skin_search *search, conic_skin *skin) {
  size_t n = search->splats->count;
  if (conic_memory_allocate_these(search->context, CONIC_ZEROED(skin->normal, n), CONIC_ZEROED(skin->color, n),
                                  CONIC_ZEROED(skin->lift, n)) != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  conic_skin_look(search, skin);
  for (size_t slot = 0; slot < search->tree.n_slots; slot++)
    for (int axis = 0; axis < 3; axis++)
      search->normal[axis][slot] = skin->normal[search->tree.point_of_slot[slot]][axis];
  return CONIC_OK;
}

/* --- gaps: where the triangles about a slot end at one neighbour and continue at another, one more fits between --- */

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

/* Adds triangles between two neighbours of a slot where the existing ones leave a gap. */
static conic_status close_gaps(conic_skin_search *search) {
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

/* --- small pieces, and what triangles surround --- */

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

/* Drops small pieces, and marks closed slots. */
static conic_status drop_small_pieces(conic_skin_search *search) {
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

/* --- all --- */

static conic_status fill_skin(const conic_skin_search *search, conic_skin *skin) {
  conic_context *context = search->context;
  size_t n = search->splats->count;
  skin->n_triangles = search->n_triangles;
  if (conic_memory_allocate_these(context, CONIC_ROOM(skin->corners, search->n_triangles),
                                  CONIC_ZEROED(skin->is_inner, n)) != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < search->n_triangles; i++)
    for (int k = 0; k < 3; k++)
      skin->corners[i][k] = search->tree.point_of_slot[search->triangles[i].slots[k]];
  for (size_t i = 0; i < n; i++) {
    uint32_t slot = search->tree.slot_of_point[i];
    skin->is_inner[i] = slot != CONIC_NO_SLOT && search->is_closed[slot];
  }
  return CONIC_OK;
}

static void release_search(conic_skin_search *search) {
  conic_context *context = search->context;
  conic_memory_release_these(context, search->is_closed, search->heads, search->next, search->triangles);
  for (int axis = 0; axis < 3; axis++)
    conic_memory_release(context, search->normal[axis]);
  conic_neighbours_release(context, &search->tree);
}

conic_status conic_skin_find(conic_context *context, const conic_splats *splats, double cutoff, conic_skin *skin) {
  conic_skin_search search = {.context = context, .splats = splats, .cutoff = cutoff};
  memset(skin, 0, sizeof *skin);
  conic_status status = build_tree(&search);
  if (status == CONIC_OK)
    status = find_own_normals(&search);
  if (status == CONIC_OK)
    status = look_all_over(&search, skin);
  if (status == CONIC_OK)
    status = conic_skin_candidates(&search);
  if (status == CONIC_OK)
    status = conic_skin_choose(&search);
  if (status == CONIC_OK)
    status = close_gaps(&search);
  if (status == CONIC_OK)
    status = drop_small_pieces(&search);
  if (status == CONIC_OK)
    status = fill_skin(&search, skin);
  release_search(&search);
  if (status != CONIC_OK)
    conic_skin_release(context, skin);
  return status;
}

void conic_skin_release(conic_context *context, conic_skin *skin) {
  conic_memory_release_these(context, skin->corners, skin->is_inner, skin->normal, skin->color, skin->lift);
  memset(skin, 0, sizeof *skin);
}
