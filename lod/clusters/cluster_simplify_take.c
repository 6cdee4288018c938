/* Levels of what simplifying has left: each cluster's triangles and their borders. */

#include "core/base/real.h"
#include "lod/clusters/cluster_simplifier.h"

/* --- borders --- */

CONIC_DEFINE_ORDER(compare_borders, conic_simplifier_border, of.edge)

/* The border of a cluster between two vertices next to each other on a chain. Returns how many there are: one. */
static int add_border(conic_simplifier *s, const conic_chain *chain, int side, const uint32_t slots[2]) {
  uint32_t ends[2], cluster = chain->clusters[side] - s->begin;
  int n = 0;
  for (int k = 0; k < 2; k++)
    ends[k] = s->number[s->mesh->adjacency->place[s->chains->slots[slots[k]].vertices[side]]];
  for (uint32_t slot = conic_simplifier_living(s, s->vertices[ends[0]].ring); slot != CONIC_NONE;
       slot = conic_simplifier_after(s, slot)) {
    const conic_simplifier_triangle *t = &s->triangles[slot / 3];
    uint32_t corner = slot % 3;
    int is_ahead = t->corners[(corner + 1) % 3] == ends[1], is_back = t->corners[(corner + 2) % 3] == ends[1];
    if (t->cluster != cluster || (!is_ahead && !is_back))
      continue;
    n++;
    conic_simplifier_border *found = &s->borders[s->n_borders++];
    found->cluster = cluster;
    found->of.edge = 4 * (slot / 3) + (is_ahead ? corner : (corner + 2) % 3);
    found->of.from = slots[!is_ahead];
    found->of.to = slots[is_ahead];
    found->of.across = chain->clusters[!side];
  }
  return n;
}

/* Both sides of a chain, where something was left out. Whether each has just one triangle there. */
static int add_chain(conic_simplifier *s, const conic_chain *chain) {
  const conic_cluster_slot *slots = s->chains->slots;
  uint32_t last = chain->first;
  int is_sound = 1;
  for (uint32_t i = last + 1; i < chain->first + chain->n; i++) {
    if (slots[i].stage != CONIC_CLUSTER_ALWAYS)
      continue; /* it is gone */
    const uint32_t ends[2] = {last, i};
    for (int side = 0; side < 2 && i > last + 1; side++)
      is_sound &= add_border(s, chain, side, ends) == 1;
    last = i;
  }
  return is_sound;
}

static int is_of_region(const conic_simplifier *s, const conic_chain *chain) {
  return chain->clusters[0] >= s->begin && chain->clusters[0] < s->end;
}

/* All borders of the region, by their triangles. `is_sound` is 0 where a cluster has not one edge along a chain: then
 * it could not be fitted to its neighbour. */
static conic_status list_borders(conic_simplifier *s, int *is_sound) {
  const conic_chain *chains = s->chains->chains;
  size_t room = 0;
  *is_sound = 1;
  for (size_t i = 0; i < s->chains->n_chains; i++)
    room += is_of_region(s, &chains[i]) ? 4 * (size_t)chains[i].n : 0;
  conic_memory_release(s->context, s->borders);
  s->n_borders = 0;
  s->borders = conic_memory_allocate(s->context, room, sizeof *s->borders);
  if (!s->borders)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < s->chains->n_chains && *is_sound; i++)
    if (is_of_region(s, &chains[i]))
      *is_sound = add_chain(s, &chains[i]);
  if (s->n_borders > 0)
    qsort(s->borders, s->n_borders, sizeof *s->borders, compare_borders);
  return CONIC_OK;
}

/* Those of a cluster lie together, as its triangles do. */
static void part_borders(conic_simplifier *s) {
  size_t i = 0;
  for (uint32_t cluster = 0; cluster < s->end - s->begin; cluster++) {
    s->border_starts[cluster] = i;
    while (i < s->n_borders && s->borders[i].cluster == cluster)
      i++;
  }
  s->border_starts[s->end - s->begin] = i;
}

conic_status conic_simplifier_begin_stage(conic_simplifier *s) {
  int is_sound;
  conic_status status = list_borders(s, &is_sound);
  s->is_over = status != CONIC_OK || !is_sound; /* what comes after would not fit either */
  if (s->is_over)
    return status;
  part_borders(s);
  conic_simplifier_shorten_ways(s);
  s->stage++;
  s->is_to_take = 1;
  return CONIC_OK;
}

/* --- levels --- */

/* The vertices of a stage of what is one. */
typedef struct taking {
  const conic_simplifier *s;
  conic_cluster_levels *levels;
  conic_simplifier_normals normals;
} taking;

static conic_status add_moved(const taking *t, uint32_t vertex, uint32_t original, uint32_t normal) {
  conic_cluster_levels *levels = t->levels;
  conic_simplifier_vertex *v = &t->s->vertices[vertex];
  conic_moved_vertex *moved =
      conic_memory_add(t->s->context, &levels->moved, &levels->n_moved, &levels->moved_room, sizeof *moved);
  if (!moved)
    return CONIC_ERROR_MEMORY;
  for (int axis = 0; axis < 3; axis++) {
    moved->at[axis] = (float)v->at[axis];
    if (t->normals.normals)
      moved->normal[axis] = (float)t->normals.normals[normal][axis];
  }
  moved->original = original;
  moved->of_normal = normal;
  moved->next = v->moved;
  v->moved = (uint32_t)(levels->n_moved - 1);
  return CONIC_OK;
}

/* The number of a corner's vertex. */
static conic_status take_moved(const taking *t, size_t triangle, int corner, uint32_t *to) {
  uint32_t vertex = t->s->triangles[triangle].corners[corner], original = t->s->originals[triangle][corner];
  uint32_t normal = t->normals.of_corner ? t->normals.of_corner[triangle][corner] : 0;
  uint32_t at = t->s->vertices[vertex].moved;
  conic_status status = CONIC_OK;
  int n = 0;
  while (at != CONIC_NONE && (t->levels->moved[at].original != original || t->levels->moved[at].of_normal != normal))
    at = ++n < CONIC_SIMPLIFIER_MANY ? t->levels->moved[at].next : CONIC_NONE; /* one twice does no harm */
  if (at == CONIC_NONE) {
    status = add_moved(t, vertex, original, normal);
    at = t->s->vertices[vertex].moved;
  }
  *to = (uint32_t)t->s->mesh->mesh.n_vertices + at;
  return status;
}

/* The last level has vertices of its own. */
static conic_status move_level(const conic_simplifier *s, conic_cluster_levels *levels) {
  conic_cluster_level *level = &levels->levels[levels->n - 1];
  taking t = {.s = s, .levels = levels};
  conic_status status = conic_simplifier_fit_normals(s, &t.normals);
  for (size_t i = 0; i < s->n_vertices; i++)
    s->vertices[i].moved = CONIC_NONE;
  for (size_t i = 0, n = 0; i < s->n_triangles && status == CONIC_OK; i++) {
    for (int corner = 0; corner < 3 && s->triangles[i].is_alive && status == CONIC_OK; corner++)
      status = take_moved(&t, i, corner, &level->corners[n][corner]);
    n += (size_t)s->triangles[i].is_alive;
  }
  conic_simplifier_normals_release(s, &t.normals);
  return status;
}

/* The cluster's triangles lie together. A region that is one has all of them, and the measures of its pieces are
 * joined. */
static conic_status take_cluster(const conic_simplifier *s, uint32_t cluster, conic_cluster_levels *levels) {
  const size_t *starts = s->mesh->starts + s->begin;
  const conic_simplifier_border *borders = s->borders + s->border_starts[cluster];
  size_t n_borders = s->border_starts[cluster + 1] - s->border_starts[cluster];
  uint32_t end = s->is_one ? s->end - s->begin : cluster + 1;
  conic_seen_sums change = {0.0, 0.0, 0.0};
  conic_cluster_level *level = &levels->levels[levels->n++];
  memset(level, 0, sizeof *level);
  if (levels->n > 1)
    level->change = level[-1].change;
  if (conic_memory_allocate_these(s->context, CONIC_ROOM(level->corners, s->alive[cluster]),
                                  CONIC_ROOM(level->face, s->alive[cluster]),
                                  CONIC_ROOM(level->borders, n_borders)) != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  for (size_t i = starts[cluster] - starts[0]; i < starts[end] - starts[0]; i++) {
    const conic_simplifier_triangle *t = &s->triangles[i];
    if (!t->is_alive)
      continue;
    for (; level->n_borders < n_borders && borders[level->n_borders].of.edge / 4 == i; level->n_borders++) {
      level->borders[level->n_borders] = borders[level->n_borders].of;
      level->borders[level->n_borders].edge = 4 * (uint32_t)level->n + borders[level->n_borders].of.edge % 4;
    }
    memcpy(level->corners[level->n], s->originals[i], sizeof s->originals[i]);
    level->face[level->n++] = t->face;
  }
  level->stage = s->stage;
  for (uint32_t i = cluster; i < end; i++) {
    const conic_seen_sums *own = &s->changes[i];
    double error = sqrt(s->errors2[i]);
    level->error = error > level->error ? error : level->error;
    change.area += own->area;
    change.steps2 += own->steps2;
    change.smear2 += own->smear2;
  }
  level->change = conic_seen_sums_change(&change, level->change);
  for (uint32_t i = cluster; i < end && s->is_one; i++) /* no need to measure what is nearer */
    s->errors2[i] = level->error * level->error;
  return s->is_one ? move_level(s, levels) : CONIC_OK;
}

conic_status conic_simplifier_take(conic_simplifier *s) {
  conic_status status = CONIC_OK;
  for (uint32_t cluster = 0; cluster < (s->is_one ? 1 : s->end - s->begin) && status == CONIC_OK; cluster++)
    if (conic_simplifier_is_worth_a_level(s, cluster)) {
      status = take_cluster(s, cluster, &s->levels[cluster]);
      s->taken[cluster] = s->alive[cluster];
    }
  s->is_to_take = 0;
  return status;
}

void conic_cluster_levels_release(conic_context *context, conic_cluster_levels *levels) {
  for (int i = 0; i < levels->n; i++) {
    conic_memory_release_these(context, levels->levels[i].corners, levels->levels[i].face, levels->levels[i].borders);
  }
  conic_memory_release(context, levels->moved);
  memset(levels, 0, sizeof *levels);
}
