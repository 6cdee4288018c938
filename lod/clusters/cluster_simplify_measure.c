/* How far a cluster and its simpler triangles are from each other. What is found depends on no other cluster's, so that
 * clusters may be measured at the same time. */

#include "core/base/real.h"
#include "lod/clusters/cluster_simplifier.h"

/* The least cosine between a face and what stands for it where it is fitted. */
static const double least_alike = 0.5;

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

/* Whether a triangle is nearer than all before. */
static int comes_nearer(const conic_simplifier *s, const conic_simplifier_triangle *t, approach *a) {
  double distance2 = conic_distance2_to_triangle(a->at, s->vertices[t->corners[0]].at, s->vertices[t->corners[1]].at,
                                                 s->vertices[t->corners[2]].at);
  if (!(distance2 < a->least2))
    return 0;
  a->least2 = distance2;
  return 1;
}

/* The nearest of the triangles about a vertex, or of the first of many, if it is nearer than all before. */
static const conic_simplifier_triangle *nearest_about(const conic_simplifier *s, uint32_t v, approach *a) {
  const conic_simplifier_triangle *nearest = NULL;
  int n = 0;
  for (uint32_t slot = conic_simplifier_living(s, s->vertices[v].ring);
       slot != CONIC_NONE && a->least2 > a->enough2 && n < CONIC_SIMPLIFIER_MANY;
       slot = conic_simplifier_after(s, slot), n++)
    if (comes_nearer(s, &s->triangles[slot / 3], a))
      nearest = &s->triangles[slot / 3];
  return nearest;
}

/* What was nearest to the face of a point, where that is known and still there. */
static const conic_simplifier_triangle *known_near(const conic_simplifier *s, const conic_simplifier_point *point) {
  uint32_t known = s->hits ? s->hits[point->triangle].triangle : CONIC_NONE;
  return known != CONIC_NONE && s->triangles[known].is_alive ? &s->triangles[known] : NULL;
}

/* Begins with what is known, or with the triangles about the vertex that a point is near to. Goes on to those that
 * touch the nearest, as long as that comes nearer and is not far, but no nearer than the nearest of all. About the
 * corners of the triangle before, all have been looked at. */
static double distance2_of(const conic_simplifier *s, const conic_simplifier_point *point, double enough2,
                           const conic_simplifier_triangle **nearest_of_all) {
  const conic_simplifier_vertex *own = &s->vertices[point->vertex];
  uint32_t first = own->is_gone ? own->target : point->vertex;
  approach a = {.at = point->at, .least2 = HUGE_VAL, .enough2 = enough2};
  const conic_simplifier_triangle *before = NULL, *known = known_near(s, point), *from = known;
  if (!known || !comes_nearer(s, known, &a)) {
    known = NULL;
    from = nearest_about(s, first, &a);
  }
  *nearest_of_all = from;
  for (int n = 0; n < CONIC_SIMPLIFIER_MANY && from && a.least2 > enough2; n++) {
    const conic_simplifier_triangle *nearest = NULL;
    for (int corner = 0; corner < 3; corner++) {
      uint32_t v = from->corners[corner];
      if (before ? conic_simplifier_has(before, v) : !known && v == first)
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

static void find_bary(const conic_simplifier *s, const double at[3], uint32_t triangle, double bary[3]) {
  const uint32_t *v = s->triangles[triangle].corners;
  const double *const corners[3] = {s->vertices[v[0]].at, s->vertices[v[1]].at, s->vertices[v[2]].at};
  conic_seen_nearest(at, corners, bary);
}

/* Whether a triangle looks the same way as a face of the mesh. */
static int looks_alike(const conic_simplifier *s, uint32_t triangle, uint32_t face) {
  const conic_simplifier_triangle *t = &s->triangles[triangle], *own = &s->triangles[face];
  double sides[2][3], cross[3];
  for (int k = 0; k < 2; k++)
    conic_subtract(s->vertices[t->corners[k + 1]].at, s->vertices[t->corners[0]].at, sides[k]);
  conic_cross(sides[0], sides[1], cross);
  double along = conic_dot(cross, own->normal) * (double)s->mesh->adjacency->side[own->face];
  return along > least_alike * conic_length(cross);
}

static void put_hit(const conic_simplifier *s, const conic_simplifier_point *point, const double bary[3],
                    conic_simplifier_hit *hit) {
  double apart[3] = {point->at[0], point->at[1], point->at[2]};
  for (int k = 0; k < 9; k++)
    apart[k % 3] -= bary[k / 3] * s->vertices[s->triangles[hit->triangle].corners[k / 3]].at[k % 3];
  hit->height = (float)conic_dot(apart, s->triangles[point->triangle].normal);
  for (int k = 0; k < 3; k++)
    hit->bary[k] = (float)bary[k];
}

/* What is nearest to the middle of a face. Where that is seen from within a triangle that was nearest at the last
 * stage, it still is. */
static void find_hit(conic_simplifier *s, const conic_simplifier_point *point) {
  conic_simplifier_hit *hit = &s->hits[point->triangle];
  double bary[3] = {0.0, 0.0, 0.0};
  if (hit->triangle != CONIC_NONE && s->triangles[hit->triangle].is_alive)
    find_bary(s, point->at, hit->triangle, bary);
  if (!(bary[0] > 0.0 && bary[1] > 0.0 && bary[2] > 0.0)) {
    const conic_simplifier_triangle *nearest;
    distance2_of(s, point, 0.0, &nearest);
    hit->triangle = nearest ? (uint32_t)(nearest - s->triangles) : CONIC_NONE;
    if (nearest)
      find_bary(s, point->at, hit->triangle, bary);
  }
  if (hit->triangle != CONIC_NONE && looks_alike(s, hit->triangle, point->triangle))
    put_hit(s, point, bary, hit);
  else
    hit->triangle = CONIC_NONE;
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

/* The next vertex of a fan beside a cluster of an earlier stage, from a border's `from` to its `to`. */
static uint32_t next_of_fan(const conic_simplifier *s, const conic_cluster_border *border, uint32_t stage,
                            uint32_t slot) {
  do
    slot += border->from < border->to ? 1u : UINT32_MAX; /* backwards */
  while (slot != border->to && s->chains->slots[slot].stage < stage);
  return slot;
}

static const double *fan_middle(const conic_simplifier *s, const conic_cluster_border *border) {
  return s->vertices[s->triangles[border->edge / 4].corners[(border->edge % 4 + 2) % 3]].at;
}

static double distance2_to_fan(const conic_simplifier *s, const conic_cluster_border *border, uint32_t stage,
                               const double at[3]) {
  double least2 = HUGE_VAL;
  for (uint32_t slot = border->from; slot != border->to;) {
    uint32_t next = next_of_fan(s, border, stage, slot);
    double distance2 = conic_distance2_to_triangle(at, fan_middle(s, border), slot_at(s, slot), slot_at(s, next));
    least2 = distance2 < least2 ? distance2 : least2;
    slot = next;
  }
  return least2;
}

/* The nearest of the triangles that share a corner with this one, but for itself. */
static double distance2_beside(const conic_simplifier *s, const conic_simplifier_triangle *t, const double at[3]) {
  double least2 = HUGE_VAL;
  for (int corner = 0; corner < 3; corner++)
    for (uint32_t slot = conic_simplifier_living(s, s->vertices[t->corners[corner]].ring); slot != CONIC_NONE;
         slot = conic_simplifier_after(s, slot)) {
      const uint32_t *v = s->triangles[slot / 3].corners;
      if (&s->triangles[slot / 3] != t)
        least2 = fmin(
            least2, conic_distance2_to_triangle(at, s->vertices[v[0]].at, s->vertices[v[1]].at, s->vertices[v[2]].at));
    }
  return least2;
}

/* The greater of `most2` and how far a place is whose triangle becomes a fan beside a cluster of an earlier stage. */
static double farther_of_fans(const conic_simplifier *s, const conic_simplifier_triangle *t, const double at[3],
                              double most2) {
  size_t low = 0, triangle = (size_t)(t - s->triangles);
  CONIC_BISECT(low, s->n_borders, s->borders[middle].of.edge / 4 < triangle);
  for (; low < s->n_borders && s->borders[low].of.edge / 4 == triangle; low++)
    for (uint32_t stage = 0; stage < s->stage; stage++) {
      const conic_cluster_border *border = &s->borders[low].of;
      if (stage > 0 && !loses_some(s, border, stage))
        continue;
      double distance2 = distance2_to_fan(s, border, stage, at);
      if (distance2 > most2)
        distance2 = fmin(distance2, distance2_beside(s, t, at));
      most2 = fmax(most2, distance2);
    }
  return most2;
}

static void measure_points(conic_simplifier *s, uint32_t cluster, const size_t *starts) {
  double most2 = s->errors2[cluster];
  for (size_t i = starts[cluster]; i < starts[cluster + 1]; i++) {
    const conic_simplifier_triangle *nearest;
    double distance2 = distance2_of(s, &s->points[i], s->contrasts ? 0.0 : most2, &nearest);
    most2 = distance2 > most2 ? distance2 : most2;
    if (nearest && nearest->cluster == cluster)
      most2 = farther_of_fans(s, nearest, s->points[i].at, most2);
    if (s->contrasts && nearest)
      conic_simplifier_note_change(s, cluster, &s->points[i], nearest);
  }
  s->errors2[cluster] = most2;
}

/* --- from the triangles to the mesh --- */

/* Goes from a face on to its neighbours, as long as they are nearer and it is not near enough. Returns whether it is in
 * the end. A face without area may have no distance. */
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

/* The greater of `most` and how far a place is from the mesh; `near` is a face that is near, and becomes a nearer
 * one. */
static double farther_of_place(const conic_simplifier *s, const double at[3], uint32_t *near, double most) {
  return walk_near(s, at, most * most, near) ? most : conic_face_tree_farther_by(s->tree, at, *near, most);
}

/* The same of the middle of some places. */
static double farther(const conic_simplifier *s, const double *const places[3], int n, uint32_t *near, double most) {
  double at[3];
  for (int axis = 0; axis < 3; axis++) {
    double sum = places[0][axis] + places[1][axis];
    at[axis] = n == 3 ? (sum + places[2][axis]) / 3.0 : 0.5 * sum;
  }
  return farther_of_place(s, at, near, most);
}

/* Triangles of a region that is one may be large, and their corners lie off the mesh, so they are measured on a grid.
 * All grids together have twice as many places as the mesh has faces, or some 30,000. Each has at least the corners,
 * thirds of the edges and the middle. */
enum { MOST_PLACES = 30000, LEAST_PARTS = 3, MOST_PARTS = 16 };

static double measure_grid(const conic_simplifier *s, const double *const corners[3], uint32_t *near, double most) {
  size_t n_places = 2 * s->n_triangles < MOST_PLACES ? 2 * s->n_triangles : MOST_PLACES;
  int n = LEAST_PARTS;
  while (n < MOST_PARTS && (size_t)((n + 1) * (n + 2) / 2) * s->n_alive < n_places)
    n++;
  for (int i = 0; i <= n; i++)
    for (int k = 0; k <= n - i; k++) {
      double at[3];
      for (int axis = 0; axis < 3; axis++)
        at[axis] =
            ((double)i * corners[0][axis] + (double)k * corners[1][axis] + (double)(n - i - k) * corners[2][axis]) /
            (double)n;
      most = farther_of_place(s, at, near, most);
    }
  return most;
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
    most = s->is_one ? measure_grid(s, corners, &s->near[i][3], most) : farther(s, corners, 3, &s->near[i][3], most);
    for (int k = 0; k < 3 && !s->is_one; k++)
      most = farther(s, corners + k, 2, &s->near[i][k], most);
  }
  return most;
}

/* --- from fans to the mesh --- */

/* The fan that a border's triangle becomes: the middles of its triangles and of the edges between them. */
static double measure_fan(const conic_simplifier *s, const conic_cluster_border *border, uint32_t stage, double most) {
  uint32_t near = s->near[border->edge / 4][border->edge % 4];
  for (uint32_t slot = border->from, next; slot != border->to; slot = next) {
    next = next_of_fan(s, border, stage, slot);
    const double *const corners[3] = {fan_middle(s, border), slot_at(s, slot), slot_at(s, next)};
    if (slot != border->from)
      most = farther(s, corners, 2, &near, most);
    most = farther(s, corners, 3, &near, most);
  }
  return most;
}

static double measure_fans(const conic_simplifier *s, uint32_t cluster, double most) {
  for (size_t i = s->border_starts[cluster]; i < s->border_starts[cluster + 1]; i++)
    for (uint32_t stage = 0; stage < s->stage; stage++)
      if (stage == 0 || loses_some(s, &s->borders[i].of, stage))
        most = measure_fan(s, &s->borders[i].of, stage, most);
  return most;
}

void conic_region_measure(conic_simplifier *s, uint32_t cluster) {
  if (s->is_to_fit) {
    for (size_t i = s->point_starts[0][cluster]; i < s->point_starts[0][cluster + 1]; i++)
      if (s->points[i].corners == 7)
        find_hit(s, &s->points[i]);
    return;
  }
  s->changes[cluster] = (conic_seen_sums){0.0, 0.0, 0.0};
  measure_points(s, cluster, s->point_starts[0]);
  measure_points(s, cluster, s->point_starts[1]);
  if (!conic_simplifier_is_worth_a_level(s, cluster))
    return;
  double most = measure_fans(s, cluster, measure_back(s, cluster, sqrt(s->errors2[cluster])));
  s->errors2[cluster] = most * most;
}
