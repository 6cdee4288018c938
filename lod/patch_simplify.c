#include "lod/patch_simplify.h"

#include <math.h>
#include <string.h>

#include "core/memory.h"
#include "lod/patch_simplifier.h"

typedef conic_simplifier_vertex vertex;
typedef conic_simplifier_triangle triangle;

/* The least cosine by which a face may turn. */
static const double least_turn = 0.2;

conic_status conic_simplifier_create(conic_context *context, const conic_patch_mesh *mesh, const conic_face_tree *tree,
                                     conic_simplifier **simplifier) {
  conic_simplifier *s = conic_memory_allocate_zeroed(context, 1, sizeof *s);
  *simplifier = s;
  if (!s)
    return CONIC_ERROR_MEMORY;
  s->context = context;
  s->mesh = mesh;
  s->tree = tree;
  s->number = conic_memory_allocate(context, mesh->mesh.n_vertices, sizeof *s->number);
  if (!s->number) {
    conic_simplifier_destroy(s);
    *simplifier = NULL;
    return CONIC_ERROR_MEMORY;
  }
  memset(s->number, 0xFF, mesh->mesh.n_vertices * sizeof *s->number);
  return CONIC_OK;
}

void conic_simplifier_destroy(conic_simplifier *s) {
  if (!s)
    return;
  for (size_t i = 0; i < sizeof s->memory / sizeof *s->memory; i++)
    conic_memory_release(s->context, s->memory[i]);
  conic_memory_release(s->context, s->borders);
  conic_memory_release(s->context, s->number);
  conic_memory_release(s->context, s);
}

static double area2_of(const conic_simplifier *s, const uint32_t corners[3], double cross[3]) {
  double sides[2][3];
  for (int k = 0; k < 2; k++)
    for (int axis = 0; axis < 3; axis++)
      sides[k][axis] = s->vertices[corners[k + 1]].at[axis] - s->vertices[corners[0]].at[axis];
  conic_cross(sides[0], sides[1], cross);
  return sqrt(conic_dot(cross, cross));
}

/* --- what may be done --- */

static int is_neighbour(const conic_simplifier *s, uint32_t a, uint32_t b) {
  for (uint32_t slot = conic_simplifier_living(s, s->vertices[a].ring); slot != CONIC_NONE;
       slot = conic_simplifier_after(s, slot))
    if (conic_simplifier_has(&s->triangles[slot / 3], b))
      return 1;
  return 0;
}

/* How many of u's triangles have v, and how many corners of u's triangles neighbour v: where the surface is to stay
 * one, each of the former has one of the latter, opposite, and there are no others; and some of u's triangles stay. */
static int keeps_surface(const conic_simplifier *s, uint32_t u, uint32_t v) {
  int n_between = 0, n_common = 0, n_open = 0, n = 0;
  for (uint32_t slot = conic_simplifier_living(s, s->vertices[u].ring); slot != CONIC_NONE;
       slot = conic_simplifier_after(s, slot)) {
    const triangle *t = &s->triangles[slot / 3];
    n++;
    n_between += conic_simplifier_has(t, v);
    /* Each neighbour once: as the corner after u; on a border, the last one comes as the corner before. */
    uint32_t next = t->corners[(slot % 3 + 1) % 3], last = t->corners[(slot % 3 + 2) % 3];
    n_common += next != v && is_neighbour(s, next, v);
    int is_last = 1;
    for (uint32_t other = conic_simplifier_living(s, s->vertices[u].ring); other != CONIC_NONE;
         other = conic_simplifier_after(s, other))
      is_last = is_last && s->triangles[other / 3].corners[(other % 3 + 1) % 3] != last;
    n_common += is_last && last != v && is_neighbour(s, last, v);
    n_open += is_last;
  }
  int is_border = s->vertices[u].kind == CONIC_VERTEX_BORDER;
  return n > n_between && n_between == (is_border ? 1 : 2) && n_common == n_between && n_open == is_border;
}

/* Whether no triangle that stays turns over or loses its area when u goes to v. */
static int keeps_facing(const conic_simplifier *s, uint32_t u, uint32_t v) {
  for (uint32_t slot = conic_simplifier_living(s, s->vertices[u].ring); slot != CONIC_NONE;
       slot = conic_simplifier_after(s, slot)) {
    const triangle *t = &s->triangles[slot / 3];
    uint32_t corners[3] = {t->corners[0], t->corners[1], t->corners[2]};
    double cross[3];
    if (conic_simplifier_has(t, v))
      continue;
    corners[slot % 3] = v;
    double area2 = area2_of(s, corners, cross), along = conic_dot(cross, t->normal);
    along *= (double)s->mesh->adjacency->side[t->face];
    if (!(area2 > 0.0) || !(along > least_turn * area2))
      return 0;
  }
  return 1;
}

/* What an edge is between: how many triangles, of two patches or of one. */
static int count_beside(const conic_simplifier *s, uint32_t u, uint32_t v, int *is_between_patches) {
  uint32_t patch = CONIC_NONE;
  int n = 0;
  *is_between_patches = 0;
  for (uint32_t slot = conic_simplifier_living(s, s->vertices[u].ring); slot != CONIC_NONE;
       slot = conic_simplifier_after(s, slot)) {
    const triangle *t = &s->triangles[slot / 3];
    if (!conic_simplifier_has(t, v))
      continue;
    n++;
    *is_between_patches |= patch != CONIC_NONE && t->patch != patch;
    patch = t->patch;
  }
  return n;
}

/* Along a border or a chain, and back from none. */
static int keeps_border(const conic_simplifier *s, uint32_t u, uint32_t v) {
  int is_between_patches, n = count_beside(s, u, v, &is_between_patches);
  switch (s->vertices[u].kind) {
  case CONIC_VERTEX_BORDER:
    return n == 1;
  case CONIC_VERTEX_CHAIN:
    return n == 2 && is_between_patches;
  default:
    return 1;
  }
}

/* Whether a triangle is left of each patch, and to each corner of what goes. */
static int leaves_some(const conic_simplifier *s, uint32_t u, uint32_t v) {
  uint32_t last_patch = CONIC_NONE;
  for (uint32_t slot = conic_simplifier_living(s, s->vertices[u].ring); slot != CONIC_NONE;
       slot = conic_simplifier_after(s, slot)) {
    const triangle *t = &s->triangles[slot / 3];
    if (!conic_simplifier_has(t, v))
      continue;
    if (s->alive[t->patch] <= 1u + (t->patch == last_patch))
      return 0;
    last_patch = t->patch;
    for (int corner = 0; corner < 3; corner++) {
      uint32_t ring = conic_simplifier_living(s, s->vertices[t->corners[corner]].ring);
      if (conic_simplifier_after(s, ring) == CONIC_NONE)
        return 0;
    }
  }
  return 1;
}

static int may_go(const conic_simplifier *s, uint32_t u, uint32_t v) {
  return !s->vertices[v].is_seam && keeps_border(s, u, v) && keeps_surface(s, u, v) && leaves_some(s, u, v) &&
         keeps_facing(s, u, v);
}

/* The neighbour that u is best drawn onto, and what that costs. */
static void find_target(conic_simplifier *s, uint32_t u) {
  vertex *own = &s->vertices[u];
  s->queue.keys[u] = HUGE_VAL;
  own->target = CONIC_NONE;
  own->is_old = 0;
  for (uint32_t slot = conic_simplifier_living(s, own->ring); slot != CONIC_NONE;
       slot = conic_simplifier_after(s, slot))
    for (uint32_t k = 1; k < 3; k++) {
      uint32_t v = s->triangles[slot / 3].corners[(slot % 3 + k) % 3];
      conic_quadric both = own->quadric;
      conic_quadric_add(&both, &s->vertices[v].quadric);
      double cost = conic_quadric_at(&both, s->vertices[v].at);
      if ((cost < s->queue.keys[u] || (cost == s->queue.keys[u] && v < own->target)) && may_go(s, u, v)) {
        s->queue.keys[u] = cost;
        own->target = v;
      }
    }
}

/* --- drawing together --- */

/* Of a ring only what is alive is kept, so that walks stay short. */
static void prune_ring(conic_simplifier *s, uint32_t v) {
  uint32_t *link = &s->vertices[v].ring;
  for (uint32_t slot = conic_simplifier_living(s, *link); slot != CONIC_NONE; slot = conic_simplifier_after(s, slot)) {
    *link = slot;
    link = &s->triangles[slot / 3].next[slot % 3];
  }
  *link = CONIC_NONE;
}

/* Of a vertex between two patches: it is there up to the last stage that was taken. */
static void leave_slot(conic_simplifier *s, uint32_t u) {
  uint32_t slot = s->chains->of_vertex[s->mesh->adjacency->place[s->vertices[u].original]];
  if (slot != CONIC_NO_SLOT)
    s->chains->slots[slot].stage = s->stage;
}

static void draw_together(conic_simplifier *s, uint32_t u, uint32_t v) {
  for (uint32_t slot = conic_simplifier_living(s, s->vertices[u].ring); slot != CONIC_NONE;) {
    triangle *t = &s->triangles[slot / 3];
    uint32_t following = conic_simplifier_after(s, slot);
    if (conic_simplifier_has(t, v)) {
      t->is_alive = 0;
      s->alive[t->patch]--;
      s->n_alive--;
    } else {
      t->corners[slot % 3] = v;
      t->originals[slot % 3] = s->vertices[v].original;
      t->next[slot % 3] = s->vertices[v].ring;
      s->vertices[v].ring = slot;
    }
    slot = following;
  }
  prune_ring(s, v);
  leave_slot(s, u);
  s->vertices[u].is_gone = 1;
  conic_quadric_add(&s->vertices[v].quadric, &s->vertices[u].quadric);
  for (uint32_t slot = s->vertices[v].ring; slot != CONIC_NONE; slot = conic_simplifier_after(s, slot))
    for (int corner = 0; corner < 3; corner++)
      s->vertices[s->triangles[slot / 3].corners[corner]].is_old = 1;
}

/* --- stages --- */

static void fill_queue(conic_simplifier *s) {
  for (uint32_t u = 0; u < s->n_vertices; u++)
    if (s->vertices[u].kind != CONIC_VERTEX_LOCKED) {
      find_target(s, u);
      if (s->queue.keys[u] < HUGE_VAL)
        conic_heap_push(&s->queue, u);
    }
}

conic_status conic_region_begin(conic_simplifier *s, conic_patch_chains *chains, uint32_t begin, uint32_t end,
                                conic_patch_levels *levels) {
  s->chains = chains;
  s->begin = begin;
  s->end = end;
  s->levels = levels;
  s->is_to_take = s->is_over = 0;
  memset(levels, 0, (end - begin) * sizeof *levels);
  conic_status status = conic_simplifier_load(s);
  if (status != CONIC_OK)
    return status;
  s->n_wanted = s->n_triangles / 2;
  s->n_last = s->n_triangles;
  fill_queue(s);
  return CONIC_OK;
}

/* Draws edges together until the next stage is there. */
static conic_status simplify(conic_simplifier *s) {
  while (s->queue.n > 0 && s->stage < CONIC_MOST_TRIANGLE_LEVELS) {
    uint32_t u = conic_heap_pop(&s->queue);
    if (s->vertices[u].is_old) {
      find_target(s, u);
      if (s->queue.keys[u] < HUGE_VAL)
        conic_heap_push(&s->queue, u);
      continue;
    }
    draw_together(s, u, s->vertices[u].target);
    if (s->n_alive <= s->n_wanted)
      return conic_simplifier_begin_stage(s);
  }
  int is_worth_it = 4 * s->n_alive <= 3 * s->n_last && s->stage < CONIC_MOST_TRIANGLE_LEVELS;
  s->is_over = !is_worth_it;
  return is_worth_it ? conic_simplifier_begin_stage(s) : CONIC_OK;
}

conic_status conic_region_advance(conic_simplifier *s, uint32_t *n_patches) {
  conic_status status = CONIC_OK;
  if (s->is_to_take) {
    status = conic_simplifier_take(s);
    s->n_last = s->n_alive;
    s->n_wanted = s->n_alive / 2;
  }
  if (status == CONIC_OK && !s->is_over)
    status = simplify(s);
  *n_patches = status == CONIC_OK && s->is_to_take ? s->end - s->begin : 0;
  return status;
}

void conic_region_end(conic_simplifier *s) {
  conic_simplifier_unload(s);
}
