/* What simplifying does to colours. */

#include "lod/clusters/cluster_simplifier.h"

void conic_simplifier_note_change(conic_simplifier *s, uint32_t cluster, const conic_simplifier_point *point,
                                  const conic_simplifier_triangle *triangle) {
  size_t i = (size_t)(triangle - s->triangles);
  const conic_simplifier_triangle *own = &s->triangles[point->triangle];
  conic_seen_place before = {.material = conic_simplifier_material(s, own)},
                   now = {.material = conic_simplifier_material(s, triangle)};
  int n = 0, is_seam = 1;
  for (int corner = 0; corner < 3; corner++) {
    int is_of_point = point->corners >> corner & 1;
    before.corners[corner] = s->mesh->mesh.faces[own->face][corner];
    before.bary[corner] = (double)is_of_point;
    n += is_of_point;
    is_seam &= !is_of_point || s->vertices[s->number[s->mesh->adjacency->place[before.corners[corner]]]].is_seam;
  }
  if (is_seam && n < 3) /* it has more than one colour, of which the nearest triangle may have the other */
    return;
  for (int corner = 0; corner < 3; corner++)
    before.bary[corner] /= (double)n;
  const double *const corners[3] = {s->vertices[triangle->corners[0]].at, s->vertices[triangle->corners[1]].at,
                                    s->vertices[triangle->corners[2]].at};
  memcpy(now.corners, s->originals[i], sizeof now.corners);
  conic_seen_nearest(point->at, corners, now.bary);
  const float *of_face = s->contrasts[point->triangle];
  conic_seen_sums_add(&s->changes[cluster], conic_seen_change_of(s->mesh->triangles, &before, (double)of_face[0], &now),
                      (double)of_face[1]);
}

/* A vertex that is to go, and the triangles about it. */
typedef struct going {
  const conic_simplifier *s;
  uint32_t u, v; /* onto v */
  uint32_t first;
  double contrast, area2; /* the greatest of the triangles; twice the area of all */
} going;

/* How the triangles about u are, and whether all have one colour. */
static int look_about(going *g) {
  const conic_simplifier *s = g->s;
  const conic_triangles *mesh = s->mesh->triangles;
  int is_plain = 1;
  for (uint32_t slot = g->first; slot != CONIC_NONE; slot = conic_simplifier_after(s, slot)) {
    const conic_simplifier_triangle *t = &s->triangles[slot / 3];
    double sides[2][3], cross[3], contrast = (double)s->contrasts[slot / 3][0];
    conic_subtract(s->vertices[t->corners[1]].at, s->vertices[t->corners[0]].at, sides[0]);
    conic_subtract(s->vertices[t->corners[2]].at, s->vertices[t->corners[0]].at, sides[1]);
    conic_cross(sides[0], sides[1], cross);
    g->area2 += conic_length(cross);
    g->contrast = contrast > g->contrast ? contrast : g->contrast;
    for (int k = 0; k < 9 && mesh->color[0]; k++)
      is_plain &= mesh->color[k % 3][s->originals[slot / 3][k / 3]] == mesh->color[k % 3][s->vertices[g->u].original];
    is_plain &= conic_simplifier_material(s, t) == s->vertices[g->u].material;
  }
  return is_plain && !(conic_has_textures(mesh) && g->contrast > 0.0);
}

/* The place that is nearest on what stays when u is drawn onto v. */
static int find_now(const going *g, const double at[3], conic_seen_place *now) {
  const conic_simplifier *s = g->s;
  int is_seam = s->vertices[g->u].is_seam || s->vertices[g->v].is_seam;
  double least2 = HUGE_VAL;
  for (uint32_t slot = g->first; slot != CONIC_NONE; slot = conic_simplifier_after(s, slot)) {
    const conic_simplifier_triangle *t = &s->triangles[slot / 3];
    double bary[3];
    if (conic_simplifier_has(t, g->v))
      continue;
    const double *corners[3] = {s->vertices[t->corners[0]].at, s->vertices[t->corners[1]].at,
                                s->vertices[t->corners[2]].at};
    corners[slot % 3] = s->vertices[g->v].at;
    double distance2 = conic_seen_nearest(at, corners, bary);
    if (!(distance2 < least2))
      continue;
    least2 = distance2;
    memcpy(now->corners, s->originals[slot / 3], sizeof now->corners);
    memcpy(now->bary, bary, sizeof bary);
    uint32_t wedge = is_seam ? conic_simplifier_wedge(s, g->u, g->v, slot) : s->vertices[g->v].original;
    now->corners[slot % 3] = wedge;
    now->material = conic_simplifier_material(s, t);
  }
  return least2 < HUGE_VAL;
}

/* What becomes of the middle between u and the next corner of a triangle about it, or of u itself. */
static double smear_at(const going *g, uint32_t slot, int is_middle) {
  const conic_simplifier *s = g->s;
  const conic_simplifier_triangle *t = &s->triangles[slot / 3];
  conic_seen_place now, before = {.material = conic_simplifier_material(s, t)};
  uint32_t own = slot % 3, next = (own + 1) % 3;
  double at[3];
  memcpy(before.corners, s->originals[slot / 3], sizeof before.corners);
  before.bary[own] = is_middle ? 0.5 : 1.0;
  before.bary[next] = 1.0 - before.bary[own];
  for (int axis = 0; axis < 3; axis++)
    at[axis] =
        before.bary[own] * s->vertices[g->u].at[axis] + before.bary[next] * s->vertices[t->corners[next]].at[axis];
  return find_now(g, at, &now) ? conic_seen_change_of(s->mesh->triangles, &before, g->contrast, &now).smear : 0.0;
}

/* Colours of points differ from one to the next where a surface's do not, and a picture shows their mean: so many steps
 * count as a step of a mesh. */
static const double weight_of_points = 6.0;

/* A step that is just visible, over a length, counts as much as that length counts as a distance. */
double conic_simplifier_fading(const conic_simplifier *s, uint32_t u, uint32_t v) {
  going g = {.s = s, .u = u, .v = v, .first = conic_simplifier_living(s, s->vertices[u].ring)};
  if (look_about(&g))
    return 0.0;
  double most = smear_at(&g, g.first, 0);
  for (uint32_t slot = g.first; slot != CONIC_NONE; slot = conic_simplifier_after(s, slot)) {
    double smear = smear_at(&g, slot, 1);
    most = smear > most ? smear : most;
  }
  most /= s->mesh->kept ? weight_of_points * CONIC_JUST_VISIBLE : CONIC_JUST_VISIBLE;
  return g.area2 * most * most;
}
