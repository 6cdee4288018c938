/* Triangles on the oracle's screen: placed, clipped and snapped. */

#include "oracle/oracle_triangle.h"

/* The guard band, in pixels. */
#define GUARD 131000.0

/* A corner of a polygon: its place in camera space, and in the triangle. */
typedef struct corner {
  double p[3], at[2];
} corner;

enum { MOST_CORNERS = 8, N_PLANES = 5 };

/* How far inside near, or a side of the guard band, a point is. */
static double distance(const oracle_view *view, int plane, const double p[3]) {
  const conic_camera *c = &view->camera;
  switch (plane) {
  case 0:
    return p[2] - view->near_z;
  case 1:
    return c->fx * p[0] + (GUARD + c->cx) * p[2];
  case 2:
    return (GUARD - c->cx) * p[2] - c->fx * p[0];
  case 3:
    return c->fy * p[1] + (GUARD + c->cy) * p[2];
  default:
    return (GUARD - c->cy) * p[2] - c->fy * p[1];
  }
}

static int comes_first(const corner *a, const corner *b) {
  for (int axis = 0; axis < 3; axis++)
    if (a->p[axis] != b->p[axis])
      return a->p[axis] < b->p[axis];
  return 1;
}

/* Where an edge meets a plane, from the end that comes first to the other. */
static corner meet(const oracle_view *view, int plane, const corner *a, const corner *b) {
  if (!comes_first(a, b)) {
    const corner *other = a;
    a = b;
    b = other;
  }
  double from = distance(view, plane, a->p), t = from / (from - distance(view, plane, b->p));
  corner met;
  for (int axis = 0; axis < 3; axis++)
    met.p[axis] = a->p[axis] + t * (b->p[axis] - a->p[axis]);
  for (int i = 0; i < 2; i++)
    met.at[i] = a->at[i] + t * (b->at[i] - a->at[i]);
  if (plane == 0)
    met.p[2] = view->near_z;
  return met;
}

static int clip(const oracle_view *view, corner polygon[MOST_CORNERS]) {
  int n = 3;
  for (int plane = 0; plane < N_PLANES && n >= 3; plane++) {
    corner kept[MOST_CORNERS + 1];
    int n_kept = 0;
    for (int i = 0; i < n; i++) {
      const corner *here = &polygon[i], *next = &polygon[(i + 1) % n];
      int is_in = distance(view, plane, here->p) >= 0.0, is_next_in = distance(view, plane, next->p) >= 0.0;
      if (is_in)
        kept[n_kept++] = *here;
      if (is_in != is_next_in)
        kept[n_kept++] = meet(view, plane, here, next);
    }
    n = n_kept;
    memcpy(polygon, kept, (size_t)n * sizeof *polygon);
  }
  return n >= 3 ? n : 0;
}

/* To whole 1/256 px, halves up; *is_unsure where rounding in double may decide. */
static double snap(double px, int *is_unsure) {
  double at = px * 256.0 + 0.5, whole = floor(at);
  double fraction = at - whole;
  if (fraction < 1e-7 || fraction > 1.0 - 1e-7)
    *is_unsure |= fraction != 0.0; /* a value that is exactly between is put up by everybody */
  return whole;
}

/* Appends a piece; 0 where it can't be seen. */
static int add_seen_piece(const oracle_mesh *mesh, const oracle_view *view, const corner *const corners[3],
                          oracle_triangle *t) {
  const conic_camera *c = &view->camera;
  t->is_unsure = view->floats.is_setup_in_float;
  t->depth_error = 0.0;
  for (int k = 0; k < 3; k++) {
    const double *p = corners[k]->p;
    t->iz[k] = 1.0 / p[2];
    t->x[k] = snap(oracle_min(oracle_max(c->fx * p[0] * t->iz[k] + c->cx, -GUARD), GUARD), &t->is_unsure);
    t->y[k] = snap(oracle_min(oracle_max(c->fy * p[1] * t->iz[k] + c->cy, -GUARD), GUARD), &t->is_unsure);
    double origin = fabs(c->cam_from_world[0][3]) + fabs(c->cam_from_world[1][3]) + fabs(c->cam_from_world[2][3]);
    double terms = 2.0 * (oracle_length(p) + origin); /* of the sums that its place is, at most */
    t->depth_error = oracle_max(t->depth_error, view->floats.centre * terms * t->iz[k]);
    memcpy(t->at[k], corners[k]->at, sizeof t->at[k]);
    if (!(t->iz[k] >= 1e-30 && t->iz[k] <= 1e30))
      return 0;
  }
  t->box[0][0] = oracle_min(t->x[0], oracle_min(t->x[1], t->x[2]));
  t->box[1][0] = oracle_max(t->x[0], oracle_max(t->x[1], t->x[2]));
  t->box[0][1] = oracle_min(t->y[0], oracle_min(t->y[1], t->y[2]));
  t->box[1][1] = oracle_max(t->y[0], oracle_max(t->y[1], t->y[2]));
  double area = (t->x[1] - t->x[0]) * (t->y[2] - t->y[0]) - (t->x[2] - t->x[0]) * (t->y[1] - t->y[0]);
  return area != 0.0 && !(area > 0.0 && mesh->options->cull_back) && t->box[1][0] >= 0.0 &&
         t->box[0][0] <= 256.0 * c->width && t->box[1][1] >= 0.0 && t->box[0][1] <= 256.0 * c->height;
}

/* Appends the part of triangle i that may be seen, at most six pieces. */
static void add_seen_triangle(oracle_mesh *mesh, const oracle_view *view, size_t i) {
  const conic_triangles *set = mesh->triangles;
  corner polygon[MOST_CORNERS];
  for (int k = 0; k < 3; k++) {
    double world[3];
    for (int axis = 0; axis < 3; axis++)
      world[axis] = set->origin[axis] + (double)set->position[axis][set->corners[i][k]];
    if (!oracle_is_finite(world[0] + world[1] + world[2]))
      return;
    for (int axis = 0; axis < 3; axis++)
      polygon[k].p[axis] = oracle_dot(view->camera.cam_from_world[axis], world) + view->camera.cam_from_world[axis][3];
    polygon[k].at[0] = k == 1;
    polygon[k].at[1] = k == 2;
    if (polygon[k].p[2] >= view->near_z && !(polygon[k].p[2] <= 1e30))
      return;
  }
  int n = clip(view, polygon);
  for (int k = 1; k + 1 < n; k++) {
    const corner *const corners[3] = {&polygon[0], &polygon[k], &polygon[k + 1]};
    mesh->pieces[mesh->n].index = (uint32_t)i;
    mesh->n += (size_t)add_seen_piece(mesh, view, corners, &mesh->pieces[mesh->n]);
  }
}

conic_status conic_oracle_mesh_create(conic_context *context, const conic_drawing *drawing, const oracle_scene *scene,
                                      const conic_render_options *options, oracle_mesh *mesh) {
  enum { MOST_PIECES = MOST_CORNERS - 2 };
  memset(mesh, 0, sizeof *mesh);
  if (!drawing->triangles || drawing->triangles->count == 0)
    return CONIC_OK;
  mesh->triangles = drawing->triangles;
  mesh->options = options;
  mesh->first_id = (uint32_t)drawing->splats->count;
  mesh->epsilon = options->epsilon >= 0.0 ? options->epsilon : 4.0 * scene->view.cutoff * scene->longest;
  mesh->pieces = conic_memory_allocate(context, mesh->triangles->count, MOST_PIECES * sizeof *mesh->pieces);
  if (!mesh->pieces)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < mesh->triangles->count; i++)
    add_seen_triangle(mesh, &scene->view, i);
  return CONIC_OK;
}

void conic_oracle_mesh_release(conic_context *context, oracle_mesh *mesh) {
  conic_memory_release(context, mesh->pieces);
  mesh->pieces = NULL;
  mesh->n = 0;
}
