/* Levels of what simplifying has left: each patch's triangles, their distance from the mesh, and their borders. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "lod/distance.h"
#include "lod/patch_simplifier.h"

typedef conic_simplifier_triangle triangle;

/* --- errors --- */

/* What a vertex has become, at the end of a way that is made shorter on it. */
static uint32_t now_at(conic_simplifier *s, uint32_t v) {
  while (s->vertices[v].is_gone) {
    uint32_t next = s->vertices[v].target;
    if (s->vertices[next].is_gone)
      s->vertices[v].target = s->vertices[next].target;
    v = next;
  }
  return v;
}

static double distance2_to(const conic_simplifier *s, const double at[3], const triangle *t) {
  return conic_distance2_to_triangle(at, s->vertices[t->corners[0]].at, s->vertices[t->corners[1]].at,
                                     s->vertices[t->corners[2]].at);
}

/* The nearest of the triangles about a vertex, if it is nearer than *least2. */
static const triangle *nearest_about(const conic_simplifier *s, uint32_t v, const double at[3], double *least2) {
  const triangle *nearest = NULL;
  for (uint32_t slot = conic_simplifier_living(s, s->vertices[v].ring); slot != CONIC_NONE;
       slot = conic_simplifier_after(s, slot)) {
    double distance2 = distance2_to(s, at, &s->triangles[slot / 3]);
    if (!(distance2 < *least2))
      continue;
    *least2 = distance2;
    nearest = &s->triangles[slot / 3];
  }
  return nearest;
}

/* From the triangles about the vertex that a point is near to on to those that touch the nearest, as long as that comes
 * nearer: no nearer than the nearest of all, and where it is `enough2` it is not looked for. */
static double distance2_of(conic_simplifier *s, const conic_simplifier_point *point, double enough2) {
  double least2 = HUGE_VAL;
  const triangle *from = nearest_about(s, now_at(s, point->vertex), point->at, &least2);
  while (from && least2 > enough2) {
    const triangle *nearest = NULL;
    for (int corner = 0; corner < 3; corner++) {
      const triangle *found = nearest_about(s, from->corners[corner], point->at, &least2);
      nearest = found ? found : nearest;
    }
    from = nearest;
  }
  return least2;
}

/* The greater of `most` and how far the middle of some places is from the mesh. */
static double farther(const conic_simplifier *s, const double *const places[3], int n, double most) {
  double at[3];
  for (int axis = 0; axis < 3; axis++) {
    double sum = places[0][axis] + places[1][axis];
    at[axis] = n == 3 ? (sum + places[2][axis]) / 3.0 : 0.5 * sum;
  }
  return conic_face_tree_farther(s->tree, at, most);
}

/* Whether a patch has become so much simpler that this stage is a level of it. */
static int is_worth_a_level(const conic_simplifier *s, uint32_t patch) {
  return 4 * (size_t)s->alive[patch] <= 3 * (size_t)s->taken[patch];
}

/* How far the triangles are from the mesh: their middles, and those of their edges. */
static void measure_back(conic_simplifier *s) {
  for (size_t i = 0; i < s->n_triangles; i++) {
    const triangle *t = &s->triangles[i];
    if (!t->is_alive || !is_worth_a_level(s, t->patch))
      continue;
    const double *const corners[4] = {s->vertices[t->corners[0]].at, s->vertices[t->corners[1]].at,
                                      s->vertices[t->corners[2]].at, s->vertices[t->corners[0]].at};
    double most = farther(s, corners, 3, sqrt(s->errors2[t->patch]));
    for (int k = 0; k < 3; k++)
      most = farther(s, corners + k, 2, most);
    s->errors2[t->patch] = most * most;
  }
}

/* How far the mesh is from the triangles, and they from it. */
static void measure(conic_simplifier *s) {
  for (size_t i = 0; i < s->n_points; i++) {
    double *most2 = &s->errors2[s->points[i].patch];
    double distance2 = distance2_of(s, &s->points[i], *most2);
    *most2 = distance2 > *most2 ? distance2 : *most2;
  }
  measure_back(s);
}

/* --- borders --- */

typedef struct border {
  conic_hybrid_border of; /* the triangle's number is that in the region */
  uint32_t patch;         /* from the region's first */
} border;

typedef struct border_list {
  border *items;
  size_t n;
} border_list;

static int compare_borders(const void *a, const void *b) {
  const border *first = a, *second = b;
  return (first->of.edge > second->of.edge) - (first->of.edge < second->of.edge);
}

/* The border of a patch between two vertices next to each other on a chain. Returns how many there are: one. */
static int add_border(const conic_simplifier *s, const conic_chain *chain, int side, const uint32_t slots[2],
                      border_list *list) {
  uint32_t ends[2], patch = chain->patches[side] - s->begin;
  int n = 0;
  for (int k = 0; k < 2; k++)
    ends[k] = s->number[s->mesh->adjacency->place[s->chains->slots[slots[k]].vertex]];
  for (uint32_t slot = conic_simplifier_living(s, s->vertices[ends[0]].ring); slot != CONIC_NONE;
       slot = conic_simplifier_after(s, slot)) {
    const triangle *t = &s->triangles[slot / 3];
    uint32_t corner = slot % 3;
    int is_ahead = t->corners[(corner + 1) % 3] == ends[1], is_back = t->corners[(corner + 2) % 3] == ends[1];
    if (t->patch != patch || (!is_ahead && !is_back))
      continue;
    n++;
    border *found = &list->items[list->n++];
    found->patch = patch;
    found->of.edge = 4 * (slot / 3) + (is_ahead ? corner : (corner + 2) % 3);
    found->of.from = slots[!is_ahead];
    found->of.to = slots[is_ahead];
    found->of.across = chain->patches[!side];
  }
  return n;
}

/* Both sides of a chain, where something was left out. Whether each has just one triangle there. */
static int add_chain(const conic_simplifier *s, const conic_chain *chain, border_list *list) {
  const conic_hybrid_slot *slots = s->chains->slots;
  uint32_t last = chain->first;
  int is_sound = 1;
  for (uint32_t i = last + 1; i < chain->first + chain->n; i++) {
    if (slots[i].stage != CONIC_HYBRID_ALWAYS)
      continue; /* it is gone */
    const uint32_t ends[2] = {last, i};
    for (int side = 0; side < 2 && i > last + 1; side++)
      is_sound &= add_border(s, chain, side, ends, list) == 1;
    last = i;
  }
  return is_sound;
}

/* All borders of the region, by their triangles. `is_sound` is 0 where a patch has not one edge along a chain: then it
 * could not be fitted to its neighbour. */
static conic_status list_borders(conic_simplifier *s, border_list *list, int *is_sound) {
  size_t room = 0;
  list->n = 0;
  *is_sound = 1;
  for (size_t i = 0; i < s->chains->n_chains; i++)
    if (s->chains->chains[i].patches[0] >= s->begin && s->chains->chains[i].patches[0] < s->end)
      room += 4 * (size_t)s->chains->chains[i].n;
  list->items = conic_memory_allocate(s->context, room, sizeof *list->items);
  if (!list->items)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < s->chains->n_chains && *is_sound; i++)
    if (s->chains->chains[i].patches[0] >= s->begin && s->chains->chains[i].patches[0] < s->end)
      *is_sound = add_chain(s, &s->chains->chains[i], list);
  if (list->n > 0)
    qsort(list->items, list->n, sizeof *list->items, compare_borders);
  return CONIC_OK;
}

static const double *slot_at(const conic_simplifier *s, uint32_t slot) {
  return s->vertices[s->number[s->mesh->adjacency->place[s->chains->slots[slot].vertex]]].at;
}

/* Whether something between a border's ends is there at the stage before this one, and no more at this one. */
static int loses_some(const conic_simplifier *s, const border *found, uint32_t stage) {
  uint32_t low = found->of.from < found->of.to ? found->of.from : found->of.to,
           high = low ^ found->of.from ^ found->of.to;
  for (uint32_t slot = low + 1; slot < high; slot++)
    if (s->chains->slots[slot].stage + 1 == stage)
      return 1;
  return 0;
}

/* The fan that a border's triangle becomes beside a patch of an earlier stage: the middles of its triangles and of the
 * edges between them. */
static void measure_fan(conic_simplifier *s, const border *found, uint32_t stage) {
  const triangle *t = &s->triangles[found->of.edge / 4];
  const double *opposite = s->vertices[t->corners[(found->of.edge % 4 + 2) % 3]].at;
  uint32_t step = found->of.from < found->of.to ? 1u : UINT32_MAX; /* backwards */
  const double *corners[3] = {opposite, slot_at(s, found->of.from), NULL};
  double most = sqrt(s->errors2[found->patch]);
  for (uint32_t slot = found->of.from + step;; slot += step) {
    if (slot != found->of.to && s->chains->slots[slot].stage < stage)
      continue;
    corners[2] = slot_at(s, slot);
    most = farther(s, corners, 3, most);
    if (slot == found->of.to)
      break;
    corners[1] = corners[2];
    most = farther(s, corners, 2, most);
  }
  s->errors2[found->patch] = most * most;
}

static void measure_fans(conic_simplifier *s, const border_list *list) {
  for (size_t i = 0; i < list->n; i++)
    for (uint32_t stage = 0; stage < s->stage && is_worth_a_level(s, list->items[i].patch); stage++)
      if (stage == 0 || loses_some(s, &list->items[i], stage))
        measure_fan(s, &list->items[i], stage);
}

/* --- levels --- */

typedef struct range {
  size_t begin, end;
} range;

/* The patch's triangles lie together, and so do its borders. */
static conic_status take_patch(conic_simplifier *s, range triangles, const border *borders, size_t n_borders,
                               conic_patch_levels *levels, double error) {
  conic_patch_level *level = &levels->levels[levels->n++];
  memset(level, 0, sizeof *level);
  level->corners = conic_memory_allocate(s->context, triangles.end - triangles.begin, sizeof *level->corners);
  level->face = conic_memory_allocate(s->context, triangles.end - triangles.begin, sizeof *level->face);
  level->borders = conic_memory_allocate(s->context, n_borders, sizeof *level->borders);
  if (!level->corners || !level->face || !level->borders)
    return CONIC_ERROR_MEMORY;
  for (size_t i = triangles.begin; i < triangles.end; i++) {
    const triangle *t = &s->triangles[i];
    if (!t->is_alive)
      continue;
    for (; level->n_borders < n_borders && borders[level->n_borders].of.edge / 4 == i; level->n_borders++) {
      level->borders[level->n_borders] = borders[level->n_borders].of;
      level->borders[level->n_borders].edge = 4 * (uint32_t)level->n + borders[level->n_borders].of.edge % 4;
    }
    memcpy(level->corners[level->n], t->originals, sizeof t->originals);
    level->face[level->n++] = t->face;
  }
  level->stage = s->stage;
  level->error = error;
  return CONIC_OK;
}

static conic_status take_patches(conic_simplifier *s, const border_list *list, conic_patch_levels *levels) {
  conic_status status = CONIC_OK;
  size_t at = 0;
  for (uint32_t patch = 0; patch < s->end - s->begin && status == CONIC_OK; patch++) {
    size_t first = s->mesh->starts[s->begin], n_borders = 0;
    const range triangles = {s->mesh->starts[s->begin + patch] - first, s->mesh->starts[s->begin + patch + 1] - first};
    while (at + n_borders < list->n && list->items[at + n_borders].patch == patch)
      n_borders++;
    if (is_worth_a_level(s, patch)) {
      status = take_patch(s, triangles, list->items + at, n_borders, &levels[patch], sqrt(s->errors2[patch]));
      s->taken[patch] = s->alive[patch];
    }
    at += n_borders;
  }
  return status;
}

conic_status conic_simplifier_take(conic_simplifier *s, conic_patch_levels *levels) {
  border_list list;
  int is_sound;
  conic_status status = list_borders(s, &list, &is_sound);
  if (status == CONIC_OK && is_sound) {
    s->stage++;
    measure(s);
    measure_fans(s, &list);
    status = take_patches(s, &list, levels);
  }
  conic_memory_release(s->context, list.items);
  return status;
}

void conic_patch_levels_release(conic_context *context, conic_patch_levels *levels) {
  for (int i = 0; i < levels->n; i++) {
    conic_memory_release(context, levels->levels[i].corners);
    conic_memory_release(context, levels->levels[i].face);
    conic_memory_release(context, levels->levels[i].borders);
  }
  memset(levels, 0, sizeof *levels);
}
