#include "lod/clusters/cluster_simplify.h"

#include "lod/clusters/cluster_simplifier.h"

conic_status conic_simplifier_create(conic_context *context, const conic_clustered_mesh *mesh,
                                     const conic_face_tree *tree, conic_simplifier **simplifier) {
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
  conic_simplifier_release_region(s);
  conic_memory_release_these(s->context, s->number, s);
}

/* --- drawing together --- */

/* Keeps only what is alive of a ring, so that walks stay short. */
static void prune_ring(conic_simplifier *s, uint32_t v) {
  uint32_t *link = &s->vertices[v].ring;
  for (uint32_t slot = conic_simplifier_living(s, *link); slot != CONIC_NONE; slot = conic_simplifier_after(s, slot)) {
    *link = slot;
    link = &s->triangles[slot / 3].next[slot % 3];
  }
  *link = CONIC_NONE;
}

/* Makes a ring begin with two living triangles: walks of its beginning stay short, however long it is. */
static void trim_ring(conic_simplifier *s, uint32_t v) {
  uint32_t first = conic_simplifier_living(s, s->vertices[v].ring);
  s->vertices[v].ring = first;
  if (first != CONIC_NONE)
    s->triangles[first / 3].next[first % 3] = conic_simplifier_after(s, first);
}

/* While the triangles beside the edge are still there. */
static void give_wedges(conic_simplifier *s, uint32_t u, uint32_t v) {
  int is_seam = s->vertices[u].is_seam || s->vertices[v].is_seam;
  for (uint32_t slot = conic_simplifier_living(s, s->vertices[u].ring); slot != CONIC_NONE;
       slot = conic_simplifier_after(s, slot))
    if (!conic_simplifier_has(&s->triangles[slot / 3], v))
      s->wedges[slot / 3] = is_seam ? conic_simplifier_wedge(s, u, v, slot) : s->vertices[v].original;
}

static void draw_together(conic_simplifier *s, uint32_t u, uint32_t v) {
  give_wedges(s, u, v);
  for (uint32_t slot = conic_simplifier_living(s, s->vertices[u].ring); slot != CONIC_NONE;) {
    conic_simplifier_triangle *t = &s->triangles[slot / 3];
    uint32_t following = conic_simplifier_after(s, slot);
    if (conic_simplifier_has(t, v)) {
      t->is_alive = 0;
      for (int corner = 0; corner < 3; corner++)
        if (t->corners[corner] != u)
          trim_ring(s, t->corners[corner]);
      s->alive[t->cluster]--;
      s->n_alive--;
    } else {
      t->corners[slot % 3] = v;
      s->originals[slot / 3][slot % 3] = s->wedges[slot / 3];
      t->next[slot % 3] = s->vertices[v].ring;
      s->vertices[v].ring = slot;
    }
    slot = following;
  }
  prune_ring(s, v);
  /* A vertex between two clusters is there up to the last stage that was taken. */
  uint32_t chain = s->chains->of_vertex[s->mesh->adjacency->place[s->vertices[u].original]];
  if (chain != CONIC_NO_SLOT)
    s->chains->slots[chain].stage = s->stage;
  memcpy(s->vertices[v].at, s->vertices[u].to, sizeof s->vertices[v].at);
  s->vertices[u].is_gone = 1;
  conic_quadric_add(&s->vertices[v].quadric, &s->vertices[u].quadric);
  s->vertices[v].faded += s->vertices[u].faded + s->vertices[u].fading;
  for (uint32_t slot = s->vertices[v].ring; slot != CONIC_NONE; slot = conic_simplifier_after(s, slot))
    for (int corner = 0; corner < 3; corner++)
      s->vertices[s->triangles[slot / 3].corners[corner]].is_old = 1;
}

/* --- stages --- */

static void fill_queue(conic_simplifier *s) {
  for (uint32_t u = 0; u < s->n_vertices; u++)
    if (s->vertices[u].kind != CONIC_VERTEX_LOCKED) {
      conic_simplifier_find_target(s, u);
      if (s->queue.keys[u] < HUGE_VAL)
        conic_heap_push(&s->queue, u);
    }
}

/* A region that is one has levels close together, so that one of them is about as large as is asked for. */
static size_t wanted_after(const conic_simplifier *s) {
  if (s->is_one && !(s->most_error > 0.0))
    return s->n_last - (s->n_last + 5) / 6;
  return s->mesh->kept ? s->n_last - s->n_last / 3 : s->n_last / 2;
}

conic_status conic_region_begin(conic_simplifier *s, conic_cluster_chains *chains, uint32_t begin, uint32_t end,
                                conic_region_as_one as_one, conic_cluster_levels *levels) {
  s->chains = chains;
  s->begin = begin;
  s->end = end;
  s->levels = levels;
  s->is_to_take = s->is_to_fit = s->is_over = 0;
  s->is_one = as_one.most_at_first > 0;
  s->most_error = as_one.most_error;
  memset(levels, 0, (s->is_one ? 1 : end - begin) * sizeof *levels);
  conic_status status = conic_simplifier_load(s);
  if (status != CONIC_OK)
    return status;
  s->n_last = s->n_triangles;
  s->n_wanted = wanted_after(s);
  s->n_wanted = s->is_one && as_one.most_at_first < s->n_wanted ? as_one.most_at_first : s->n_wanted;
  fill_queue(s);
  return CONIC_OK;
}

/* Draws edges together until the next stage is there. */
static conic_status simplify(conic_simplifier *s) {
  while (s->queue.n > 0 && s->stage < CONIC_MOST_TRIANGLE_LEVELS) {
    uint32_t u = conic_heap_pop(&s->queue);
    if (s->vertices[u].is_old) {
      conic_simplifier_find_target(s, u);
      if (s->queue.keys[u] < HUGE_VAL)
        conic_heap_push(&s->queue, u);
      continue;
    }
    draw_together(s, u, s->vertices[u].target);
    if (s->n_alive <= s->n_wanted)
      return conic_simplifier_begin_stage(s);
  }
  int is_worth_it = !s->is_one && 4 * s->n_alive <= 3 * s->n_last && s->stage < CONIC_MOST_TRIANGLE_LEVELS;
  s->is_over = !is_worth_it;
  return is_worth_it ? conic_simplifier_begin_stage(s) : CONIC_OK;
}

conic_status conic_region_advance(conic_simplifier *s, uint32_t *n_clusters) {
  conic_status status = CONIC_OK;
  if (s->is_to_fit) {
    s->is_to_fit = 0;
    status = conic_simplifier_fit_places(s);
  } else {
    if (s->is_to_take) {
      status = conic_simplifier_take(s);
      s->n_last = s->n_alive;
      s->n_wanted = wanted_after(s);
      s->is_over |= s->most_error > 0.0 && s->levels->levels[s->levels->n - 1].error > s->most_error;
    }
    if (status == CONIC_OK && !s->is_over)
      status = simplify(s);
    s->is_to_fit = s->is_one && s->is_to_take;
  }
  *n_clusters = status == CONIC_OK && s->is_to_take ? s->end - s->begin : 0;
  return status;
}
