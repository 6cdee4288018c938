/* How far a cluster and its simpler triangles are from each other. What is found depends on no other cluster's, so that
 * clusters may be measured at the same time. */
#include <math.h>

#include "lod/clusters/cluster_simplifier.h"
#include "lod/mesh/distance.h"

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

void conic_simplifier_shorten_ways(conic_simplifier *s) {
  for (uint32_t v = 0; v < s->n_vertices; v++)
    if (s->vertices[v].is_gone)
      s->vertices[v].target = now_at(s, v);
}

/* --- from the mesh to the triangles --- */

/* A place, how near the triangles come that were looked at, and how near is enough: then no more are. */
typedef struct approach {
  const double *at;
  double least2, enough2;
} approach;

/* The nearest of the triangles about a vertex, if it is nearer than all before. */
static const conic_simplifier_triangle *nearest_about(const conic_simplifier *s, uint32_t v, approach *a) {
  const conic_simplifier_triangle *nearest = NULL;
  for (uint32_t slot = conic_simplifier_living(s, s->vertices[v].ring); slot != CONIC_NONE && a->least2 > a->enough2;
       slot = conic_simplifier_after(s, slot)) {
    const conic_simplifier_triangle *t = &s->triangles[slot / 3];
    double distance2 = conic_distance2_to_triangle(a->at, s->vertices[t->corners[0]].at, s->vertices[t->corners[1]].at,
                                                   s->vertices[t->corners[2]].at);
    if (!(distance2 < a->least2))
      continue;
    a->least2 = distance2;
    nearest = t;
  }
  return nearest;
}

/* From the triangles about the vertex that a point is near to on to those that touch the nearest, as long as that comes
 * nearer: no nearer than the nearest of all. About the corners of the one before all were looked at. */
static double distance2_of(const conic_simplifier *s, const conic_simplifier_point *point, double enough2,
                           const conic_simplifier_triangle **nearest_of_all) {
  const conic_simplifier_vertex *own = &s->vertices[point->vertex];
  uint32_t first = own->is_gone ? own->target : point->vertex;
  approach a = {.at = point->at, .least2 = HUGE_VAL, .enough2 = enough2};
  const conic_simplifier_triangle *before = NULL, *from = nearest_about(s, first, &a);
  *nearest_of_all = from;
  while (from && a.least2 > enough2) {
    const conic_simplifier_triangle *nearest = NULL;
    for (int corner = 0; corner < 3; corner++) {
      uint32_t v = from->corners[corner];
      if (before ? conic_simplifier_has(before, v) : v == first)
        continue;
      const conic_simplifier_triangle *found = nearest_about(s, v, &a);
      nearest = found ? found : nearest;
    }
    before = from;
    *nearest_of_all = nearest ? nearest : *nearest_of_all;
    from = nearest;
  }
  return a.least2;
}

static void measure_points(conic_simplifier *s, uint32_t cluster, const size_t *starts) {
  double most2 = s->errors2[cluster];
  for (size_t i = starts[cluster]; i < starts[cluster + 1]; i++) {
    const conic_simplifier_triangle *nearest;
    double distance2 = distance2_of(s, &s->points[i], s->contrasts ? 0.0 : most2, &nearest);
    most2 = distance2 > most2 ? distance2 : most2;
    if (s->contrasts && nearest)
      conic_simplifier_note_change(s, cluster, &s->points[i], nearest);
  }
  s->errors2[cluster] = most2;
}

/* --- from the triangles to the mesh --- */

/* From a face on to its neighbours, as long as they are nearer and it is not near enough: whether it is in the end. A
 * face without area may have no distance. */
static int walk_near(const conic_simplifier *s, const double at[3], double enough2, uint32_t *face) {
  const conic_mesh *mesh = &s->mesh->mesh;
  double least2 = conic_distance2_to_face(mesh, *face, at);
  for (uint32_t from = CONIC_NONE; from != *face && !(least2 <= enough2);) {
    from = *face;
    for (size_t edge = 3 * (size_t)from; edge < 3 * (size_t)from + 3; edge++) {
      uint32_t across = s->mesh->adjacency->across[edge];
      if (!conic_edge_is_shared(across))
        continue;
      double distance2 = conic_distance2_to_face(mesh, across / 3, at);
      if (!(distance2 < least2))
        continue;
      least2 = distance2;
      *face = across / 3;
    }
  }
  return least2 <= enough2;
}

/* The greater of `most` and how far the middle of some places is from the mesh; `near` is a face that is near, and
 * becomes a nearer one. */
static double farther(const conic_simplifier *s, const double *const places[3], int n, uint32_t *near, double most) {
  double at[3];
  for (int axis = 0; axis < 3; axis++) {
    double sum = places[0][axis] + places[1][axis];
    at[axis] = n == 3 ? (sum + places[2][axis]) / 3.0 : 0.5 * sum;
  }
  return walk_near(s, at, most * most, near) ? most : conic_face_tree_farther_by(s->tree, at, *near, most);
}

/* The middles of the triangles, and those of their edges. */
static double measure_back(const conic_simplifier *s, uint32_t cluster, double most) {
  size_t first = s->mesh->starts[s->begin], begin = s->mesh->starts[s->begin + cluster] - first,
         end = s->mesh->starts[s->begin + cluster + 1] - first;
  for (size_t i = begin; i < end; i++) {
    const conic_simplifier_triangle *t = &s->triangles[i];
    if (!t->is_alive)
      continue;
    const double *const corners[4] = {s->vertices[t->corners[0]].at, s->vertices[t->corners[1]].at,
                                      s->vertices[t->corners[2]].at, s->vertices[t->corners[0]].at};
    most = farther(s, corners, 3, &s->near[i][3], most);
    for (int k = 0; k < 3; k++)
      most = farther(s, corners + k, 2, &s->near[i][k], most);
  }
  return most;
}

/* --- fans --- */

static const double *slot_at(const conic_simplifier *s, uint32_t slot) {
  return s->vertices[s->number[s->mesh->adjacency->place[s->chains->slots[slot].vertices[0]]]].at;
}

/* Whether something between a border's ends is there at the stage before this one, and no more at this one. */
static int loses_some(const conic_simplifier *s, const conic_cluster_border *border, uint32_t stage) {
  uint32_t low = border->from < border->to ? border->from : border->to, high = low ^ border->from ^ border->to;
  for (uint32_t slot = low + 1; slot < high; slot++)
    if (s->chains->slots[slot].stage + 1 == stage)
      return 1;
  return 0;
}

/* The fan that a border's triangle becomes beside a cluster of an earlier stage: the middles of its triangles and of
 * the edges between them. */
static double measure_fan(const conic_simplifier *s, const conic_cluster_border *border, uint32_t stage, double most) {
  const conic_simplifier_triangle *t = &s->triangles[border->edge / 4];
  const double *opposite = s->vertices[t->corners[(border->edge % 4 + 2) % 3]].at;
  const double *corners[3] = {opposite, slot_at(s, border->from), NULL};
  uint32_t step = border->from < border->to ? 1u : UINT32_MAX; /* backwards */
  uint32_t near = s->near[border->edge / 4][border->edge % 4];
  for (uint32_t slot = border->from + step;; slot += step) {
    if (slot != border->to && s->chains->slots[slot].stage < stage)
      continue;
    corners[2] = slot_at(s, slot);
    most = farther(s, corners, 3, &near, most);
    if (slot == border->to)
      return most;
    corners[1] = corners[2];
    most = farther(s, corners, 2, &near, most);
  }
}

static double measure_fans(const conic_simplifier *s, uint32_t cluster, double most) {
  for (size_t i = s->border_starts[cluster]; i < s->border_starts[cluster + 1]; i++)
    for (uint32_t stage = 0; stage < s->stage; stage++)
      if (stage == 0 || loses_some(s, &s->borders[i].of, stage))
        most = measure_fan(s, &s->borders[i].of, stage, most);
  return most;
}

void conic_region_measure(conic_simplifier *s, uint32_t cluster) {
  s->changes[cluster] = (conic_seen_sums){0.0, 0.0, 0.0};
  measure_points(s, cluster, s->point_starts[0]);
  measure_points(s, cluster, s->point_starts[1]);
  if (!conic_simplifier_is_worth_a_level(s, cluster))
    return;
  double most = measure_fans(s, cluster, measure_back(s, cluster, sqrt(s->errors2[cluster])));
  s->errors2[cluster] = most * most;
}
