/* What a vertex is best drawn onto, of its neighbours that it may be drawn onto. */

#include "lod/clusters/cluster_simplifier.h"

/* The least cosine by which a face may turn. */
static const double least_turn = 0.2;

/* A vertex with its living triangles: each has a spoke, the corner after the vertex, and then come the corners before
 * it that are after it in no triangle. So each neighbour has one where the surface is simple. */
typedef struct fan {
  uint32_t vertex;
  size_t n_triangles, n_spokes;
  conic_simplifier_spoke *spokes; /* the simplifier's */
} fan;

static int is_ahead(const fan *f, uint32_t v) {
  for (size_t i = 0; i < f->n_triangles; i++)
    if (f->spokes[i].vertex == v)
      return 1;
  return 0;
}

static fan fan_of(const conic_simplifier *s, uint32_t u) {
  fan f = {.vertex = u, .spokes = s->spokes};
  for (uint32_t slot = conic_simplifier_living(s, s->vertices[u].ring); slot != CONIC_NONE;
       slot = conic_simplifier_after(s, slot)) {
    const conic_simplifier_triangle *t = &s->triangles[slot / 3];
    f.spokes[f.n_triangles++] = (conic_simplifier_spoke){
        .vertex = t->corners[(slot % 3 + 1) % 3], .before = t->corners[(slot % 3 + 2) % 3], .slot = slot};
  }
  f.n_spokes = f.n_triangles;
  for (size_t i = 0; i < f.n_triangles; i++)
    if (!is_ahead(&f, f.spokes[i].before))
      f.spokes[f.n_spokes++] = (conic_simplifier_spoke){.vertex = f.spokes[i].before, .before = CONIC_NONE};
  return f;
}

static int has(const conic_simplifier_spoke *of_triangle, uint32_t v) {
  return of_triangle->vertex == v || of_triangle->before == v;
}

static const conic_simplifier_triangle *triangle_of(const conic_simplifier *s,
                                                    const conic_simplifier_spoke *of_triangle) {
  return &s->triangles[of_triangle->slot / 3];
}

/* How many triangles are beside the edge to v. Between clusters they are of two. */
static int count_beside(const conic_simplifier *s, const fan *f, uint32_t v, int *is_between_clusters) {
  uint32_t cluster = CONIC_NONE;
  int n = 0;
  *is_between_clusters = 0;
  for (size_t i = 0; i < f->n_triangles; i++) {
    if (!has(&f->spokes[i], v))
      continue;
    const conic_simplifier_triangle *t = triangle_of(s, &f->spokes[i]);
    n++;
    *is_between_clusters |= cluster != CONIC_NONE && t->cluster != cluster;
    cluster = t->cluster;
  }
  return n;
}

/* How many of the spokes neighbour v. */
static int count_common(const conic_simplifier *s, const fan *f, uint32_t v) {
  int n = 0;
  for (size_t i = 0; i < f->n_spokes; i++)
    f->spokes[i].is_common = 0;
  for (uint32_t slot = conic_simplifier_living(s, s->vertices[v].ring); slot != CONIC_NONE;
       slot = conic_simplifier_after(s, slot)) {
    const uint32_t *corners = s->triangles[slot / 3].corners;
    uint32_t after = corners[(slot % 3 + 1) % 3], before = corners[(slot % 3 + 2) % 3];
    for (size_t i = 0; i < f->n_spokes; i++)
      f->spokes[i].is_common |= f->spokes[i].vertex == after || f->spokes[i].vertex == before;
  }
  for (size_t i = 0; i < f->n_spokes; i++)
    n += f->spokes[i].is_common && f->spokes[i].vertex != v;
  return n;
}

/* Along a border or a chain, and back from none. Where the surface is to stay one, each triangle beside the edge has a
 * corner that neighbours both its ends, opposite, and there are no others; and some of the triangles stay. */
static int keeps_surface(const conic_simplifier *s, const fan *f, uint32_t v) {
  uint8_t kind = s->vertices[f->vertex].kind;
  int is_between_clusters, n = count_beside(s, f, v, &is_between_clusters);
  if (n != (kind == CONIC_VERTEX_BORDER ? 1 : 2) || (kind == CONIC_VERTEX_CHAIN && !is_between_clusters))
    return 0;
  return f->n_triangles > (size_t)n && count_common(s, f, v) == n;
}

static double area2_of(const double *const corners[3], double cross[3]) {
  double sides[2][3];
  for (int k = 0; k < 2; k++)
    conic_subtract(corners[k + 1], corners[0], sides[k]);
  conic_cross(sides[0], sides[1], cross);
  return conic_length(cross);
}

/* Whether the triangle of a slot neither turns over nor loses its area when that corner is somewhere else: turns away
 * from its face of the mesh; in what is one, which becomes far simpler than its faces are even, from what it is now. */
int conic_simplifier_keeps_facing(const conic_simplifier *s, uint32_t slot, const double at[3]) {
  const conic_simplifier_triangle *t = &s->triangles[slot / 3];
  const double *corners[3];
  double cross[3], normal[3];
  for (int corner = 0; corner < 3; corner++)
    corners[corner] = s->vertices[t->corners[corner]].at;
  double length = s->is_one ? area2_of(corners, normal) : 0.0;
  for (int axis = 0; axis < 3; axis++) /* NOLINTNEXTLINE(clang-analyzer-core.*): with a length it is set */
    normal[axis] = length > 0.0 ? normal[axis] / length : t->normal[axis] * (double)s->mesh->adjacency->side[t->face];
  corners[slot % 3] = at;
  double area2 = area2_of(corners, cross), along = conic_dot(cross, normal);
  return area2 > 0.0 && along > least_turn * area2;
}

/* The same of all triangles that stay when the vertex goes to that spoke's. */
static int keeps_facing(const conic_simplifier *s, const fan *f, const conic_simplifier_spoke *to) {
  for (size_t i = 0; i < f->n_triangles; i++)
    if (!has(&f->spokes[i], to->vertex) && !conic_simplifier_keeps_facing(s, f->spokes[i].slot, to->at))
      return 0;
  if (!s->is_one)
    return 1;
  for (uint32_t slot = conic_simplifier_living(s, s->vertices[to->vertex].ring); slot != CONIC_NONE;
       slot = conic_simplifier_after(s, slot))
    if (!conic_simplifier_has(&s->triangles[slot / 3], f->vertex) && !conic_simplifier_keeps_facing(s, slot, to->at))
      return 0;
  return 1;
}

/* Whether a triangle is left of each cluster, and to each corner of what goes. */
static int leaves_some(const conic_simplifier *s, const fan *f, uint32_t v) {
  uint32_t last_cluster = CONIC_NONE;
  for (size_t i = 0; i < f->n_triangles; i++) {
    if (!has(&f->spokes[i], v))
      continue;
    const conic_simplifier_triangle *t = triangle_of(s, &f->spokes[i]);
    if (s->alive[t->cluster] <= 1u + (t->cluster == last_cluster))
      return 0;
    last_cluster = t->cluster;
    for (int corner = 0; corner < 3; corner++) {
      uint32_t ring = conic_simplifier_living(s, s->vertices[t->corners[corner]].ring);
      if (conic_simplifier_after(s, ring) == CONIC_NONE)
        return 0;
    }
  }
  return 1;
}

/* Whether two slots of a vertex have its attributes in common. */
static int is_alike(const conic_simplifier *s, uint32_t a, uint32_t b) {
  const conic_simplifier_triangle *first = &s->triangles[a / 3], *second = &s->triangles[b / 3];
  return s->originals[a / 3][a % 3] == s->originals[b / 3][b % 3] && first->cluster == second->cluster &&
         conic_simplifier_material(s, first) == conic_simplifier_material(s, second);
}

/* Among the mesh's vertices at v that triangles have, the one whose normal is nearest to that of a slot's. Where only
 * normals differ along seams, as at creases, they hold up nothing that is one. */
static uint32_t nearest_normal(const conic_simplifier *s, uint32_t v, uint32_t slot) {
  const conic_triangles *mesh = s->mesh->triangles;
  uint32_t own = s->originals[slot / 3][slot % 3], nearest = CONIC_NONE;
  double most = -HUGE_VAL;
  for (uint32_t at = conic_simplifier_living(s, s->vertices[v].ring); at != CONIC_NONE;
       at = conic_simplifier_after(s, at)) {
    uint32_t other = s->originals[at / 3][at % 3];
    double along = 0.0;
    for (int axis = 0; axis < 3 && mesh->normal[0]; axis++)
      along += (double)mesh->normal[axis][own] * (double)mesh->normal[axis][other];
    if (nearest == CONIC_NONE || along > most) {
      nearest = other;
      most = along;
    }
  }
  return nearest;
}

uint32_t conic_simplifier_wedge(const conic_simplifier *s, uint32_t u, uint32_t v, uint32_t slot) {
  uint32_t wedge = CONIC_NONE;
  int may_part = s->is_one && !s->contrasts; /* all has one colour */
  for (uint32_t beside = conic_simplifier_living(s, s->vertices[u].ring); beside != CONIC_NONE;
       beside = conic_simplifier_after(s, beside)) {
    const conic_simplifier_triangle *t = &s->triangles[beside / 3];
    if (!conic_simplifier_has(t, v) || !is_alike(s, slot, beside))
      continue;
    uint32_t found = s->originals[beside / 3][t->corners[0] == v ? 0 : t->corners[1] == v ? 1 : 2];
    if (wedge != CONIC_NONE && wedge != found)
      return may_part ? nearest_normal(s, v, slot) : CONIC_NONE;
    wedge = found;
  }
  return wedge == CONIC_NONE && may_part ? nearest_normal(s, v, slot) : wedge;
}

/* Whether each triangle that stays has its attributes at v. */
static int keeps_seams(const conic_simplifier *s, const fan *f, uint32_t v) {
  if (!s->vertices[f->vertex].is_seam && !s->vertices[v].is_seam)
    return 1;
  for (size_t i = 0; i < f->n_triangles; i++)
    if (!has(&f->spokes[i], v) && conic_simplifier_wedge(s, f->vertex, v, f->spokes[i].slot) == CONIC_NONE)
      return 0;
  return 1;
}

static int may_go(const conic_simplifier *s, const fan *f, const conic_simplifier_spoke *to) {
  uint32_t v = to->vertex;
  return !conic_simplifier_has_many(s, v) && keeps_seams(s, f, v) && keeps_surface(s, f, v) && leaves_some(s, f, v) &&
         keeps_facing(s, f, to);
}

static void find_costs(const conic_simplifier *s, const fan *f) {
  for (size_t i = 0; i < f->n_spokes; i++) {
    const conic_simplifier_vertex *v = &s->vertices[f->spokes[i].vertex];
    conic_quadric both = s->vertices[f->vertex].quadric;
    conic_quadric_add(&both, &v->quadric);
    conic_simplifier_find_place(s, f->vertex, f->spokes[i].vertex, &both, f->spokes[i].at);
    f->spokes[i].cost = conic_quadric_at(&both, f->spokes[i].at) + s->vertices[f->vertex].faded + v->faded;
    f->spokes[i].fading = s->contrasts ? HUGE_VAL : 0.0;
  }
}

/* The cheapest, of equals the lowest vertex; null where no cost is finite. */
static conic_simplifier_spoke *cheapest_of(const fan *f) {
  conic_simplifier_spoke *cheapest = NULL;
  for (conic_simplifier_spoke *next = f->spokes; next < f->spokes + f->n_spokes; next++) {
    double least = cheapest ? cheapest->cost : HUGE_VAL;
    if (next->cost < least || (cheapest && next->cost == least && next->vertex < cheapest->vertex))
      cheapest = next;
  }
  return cheapest;
}

void conic_simplifier_find_target(conic_simplifier *s, uint32_t u) {
  conic_simplifier_vertex *own = &s->vertices[u];
  s->queue.keys[u] = HUGE_VAL;
  own->target = CONIC_NONE;
  own->is_old = 0;
  if (conic_simplifier_has_many(s, u))
    return;
  fan f = fan_of(s, u);
  if (f.n_spokes - f.n_triangles != (own->kind == CONIC_VERTEX_BORDER)) /* the triangles are no simple fan */
    return;
  find_costs(s, &f);
  for (conic_simplifier_spoke *next = cheapest_of(&f); next; next = cheapest_of(&f)) {
    int may = may_go(s, &f, next);
    if (may && !(next->fading < HUGE_VAL)) { /* colours are looked at only where the rest is cheap */
      next->fading = conic_simplifier_fading(s, u, next->vertex);
      next->cost += next->fading;
      continue;
    }
    if (may) {
      own->fading = next->fading;
      s->queue.keys[u] = next->cost;
      own->target = next->vertex;
      memcpy(own->to, next->at, sizeof own->to);
      return;
    }
    next->cost = HUGE_VAL;
  }
}

/* --- places --- */

/* What holds a vertex at its place where the quadric does not, as a part of the quadric's own size. */
static const double hold = 1e-3;

/* Solves the symmetric system whose upper half is given: by the cofactors, so that it is the same everywhere. Returns
 * whether it has a solution. */
static int solve_upper(const double a[6], const double right[3], double x[3]) {
  double c0 = a[3] * a[5] - a[4] * a[4], c1 = a[2] * a[4] - a[1] * a[5], c2 = a[1] * a[4] - a[2] * a[3];
  double determinant = a[0] * c0 + a[1] * c1 + a[2] * c2;
  double c3 = a[0] * a[5] - a[2] * a[2], c4 = a[1] * a[2] - a[0] * a[4], c5 = a[0] * a[3] - a[1] * a[1];
  if (!(determinant > 0.0))
    return 0;
  x[0] = (c0 * right[0] + c1 * right[1] + c2 * right[2]) / determinant;
  x[1] = (c1 * right[0] + c3 * right[1] + c4 * right[2]) / determinant;
  x[2] = (c2 * right[0] + c4 * right[1] + c5 * right[2]) / determinant;
  return 1;
}

/* What has one colour is moved to where the quadric is least, but no farther than the edge is long; what lies on a
 * border only along one. */
static int may_move(const conic_simplifier *s, uint32_t u, uint32_t v) {
  return s->is_one && !s->contrasts && s->vertices[v].kind == s->vertices[u].kind;
}

void conic_simplifier_find_place(const conic_simplifier *s, uint32_t u, uint32_t v, const conic_quadric *both,
                                 double at[3]) {
  const double *from = s->vertices[v].at, *gone = s->vertices[u].at, *a = both->a;
  double side[3], step[3], held = hold * (a[0] + a[3] + a[5]);
  const double holding[6] = {a[0] + held, a[1], a[2], a[3] + held, a[4], a[5] + held};
  const double right[3] = {-(a[0] * from[0] + a[1] * from[1] + a[2] * from[2] + both->b[0]),
                           -(a[1] * from[0] + a[3] * from[1] + a[4] * from[2] + both->b[1]),
                           -(a[2] * from[0] + a[4] * from[1] + a[5] * from[2] + both->b[2])};
  memcpy(at, from, 3 * sizeof *at);
  conic_subtract(gone, from, side);
  if (!may_move(s, u, v) || !solve_upper(holding, right, step) || !(conic_dot(step, step) <= conic_dot(side, side)))
    return;
  for (int axis = 0; axis < 3; axis++)
    at[axis] = (double)(float)(from[axis] + step[axis]);
}
