#include "surface/mls_surface.h"

enum { CHUNK = 256, CHUNKS_A_REPORT = 64 };

/* Feet are looked for within half of h (PSS §3.3); most are found much nearer, with fewer neighbours. */
static const double FIRST_MARGIN = 0.125, LAST_MARGIN = 0.5;

/* Feet nearer than this, in units of h, are the same. */
static const double SAME_FOOT = 1e-8;

double conic_surface_margin(const conic_surface *surface, double h) {
  int is_fast = surface->options.type == CONIC_SURFACE_MLS && surface->options.plane == CONIC_PLANE_FAST;
  return is_fast ? 0.0 : FIRST_MARGIN * h;
}

/* The unit normal of a polynomial with these slopes over a frame. */
static void slope_normal(double frame[3][3], const double slope[2], double normal[3]) {
  double length2 = 1.0 + slope[0] * slope[0] + slope[1] * slope[1], inverse = 1.0 / sqrt(length2);
  for (int axis = 0; axis < 3; axis++)
    normal[axis] = (frame[2][axis] - slope[0] * frame[0][axis] - slope[1] * frame[1][axis]) * inverse;
}

/* From a plane to the polynomial's point over q = r + t·n. */
static conic_surface_outcome climb(const conic_surface *surface, double h, conic_workspace *workspace,
                                   double frame[3][3], double t, conic_landing *projection) {
  double sums[CONIC_N_MOMENTS], q[3];
  conic_fit *fit = &workspace->fit;
  for (int axis = 0; axis < 3; axis++)
    q[axis] = t * frame[2][axis];
  surface->loops.moments(&workspace->near, &surface->weighing, q, sums);
  projection->n_neighbours = (int)sums[CONIC_MOMENT_COUNT];
  if (projection->n_neighbours < conic_n_coefficients(surface->options.degree))
    return CONIC_SURFACE_TOO_FEW;
  conic_surface_outcome outcome = conic_surface_fit(surface, h, workspace, frame, t, fit);
  if (outcome != CONIC_SURFACE_DONE)
    return outcome;
  for (int axis = 0; axis < 3; axis++) {
    projection->offset[axis] = (t + fit->value) * frame[2][axis];
    projection->foot[axis] = q[axis];
    projection->plane_normal[axis] = frame[2][axis];
  }
  slope_normal(frame, fit->slope, projection->normal);
  return CONIC_SURFACE_DONE;
}

static int is_full(const conic_surface *surface) {
  return surface->options.type == CONIC_SURFACE_MLS && surface->options.plane == CONIC_PLANE_FULL;
}

/* The plane for the point of the workspace's neighbours. */
static conic_surface_outcome find_plane(const conic_surface *surface, double h, double margin,
                                        conic_workspace *workspace, double frame[3][3], double *t) {
  size_t n_least = (size_t)conic_n_coefficients(surface->options.degree);
  conic_surface_outcome outcome = conic_surface_first_plane(surface, n_least, workspace, frame, t);
  if (!is_full(surface)) {
    *t = 0.0;
    return outcome;
  }
  if (outcome != CONIC_SURFACE_DONE)
    return outcome;
  *t = fabs(*t) <= margin ? *t : 0.0;
  return conic_surface_find_plane(surface, h, margin, workspace, frame, t);
}

/* A point to be projected. */
typedef struct projection_start {
  double r[3], h;
  uint32_t except;
  const conic_candidates *candidates; /* null: gathered for this point alone */
} projection_start;

/* Finds the plane (or sphere) for a place: first among near samples, then among all within LAST_MARGIN. */
static conic_surface_outcome find_foot(const conic_surface *surface, const projection_start *at,
                                       conic_workspace *workspace, double frame[3][3], double *t,
                                       conic_landing *sphere) {
  const double box[6] = {at->r[0], at->r[1], at->r[2], at->r[0], at->r[1], at->r[2]};
  const conic_candidates *candidates = surface->clusters.mass ? NULL : at->candidates;
  double margin = conic_surface_margin(surface, at->h);
  conic_surface_outcome outcome = CONIC_SURFACE_TOO_FEW;
  for (int i = 0; i < 2; i++) {
    if (!candidates)
      conic_surface_gather(surface, box, margin, workspace, &workspace->single);
    conic_surface_select(surface, candidates ? candidates : &workspace->single, at->r, margin, at->except, workspace);
    workspace->n_evaluations++;
    outcome = surface->options.type == CONIC_SURFACE_APSS
                  ? conic_surface_find_sphere(surface, at->h, margin, workspace, sphere)
                  : find_plane(surface, at->h, margin, workspace, frame, t);
    if (outcome != CONIC_SURFACE_NO_MINIMUM || !(margin > 0.0))
      break;
    margin = LAST_MARGIN * at->h; /* its foot may be farther out */
    candidates = NULL;
  }
  return outcome;
}

static void swap_near(conic_workspace *workspace) {
  conic_near near = workspace->near;
  workspace->near = workspace->other_near;
  workspace->other_near = near;
}

/* Whether the found point is projected to itself. Where the samples lie in several layers there are several minima, and
 * the projection may find another one: such a point is not on the surface. */
static int is_found_again(const conic_surface *surface, const projection_start *at, conic_workspace *workspace,
                          const conic_landing *projection) {
  projection_start again = *at;
  double frame[3][3], t, apart2 = 0.0, moved2 = 0.0, margin = conic_surface_margin(surface, at->h);
  for (int axis = 0; axis < 3; axis++) {
    again.r[axis] += projection->offset[axis];
    moved2 += projection->offset[axis] * projection->offset[axis];
  }
  if (moved2 > margin * margin)
    again.candidates = NULL; /* it may have left the box that they were gathered for */
  swap_near(workspace);
  conic_surface_outcome outcome = find_foot(surface, &again, workspace, frame, &t, NULL);
  swap_near(workspace);
  if (outcome != CONIC_SURFACE_DONE)
    return 0;
  for (int axis = 0; axis < 3; axis++) {
    double apart = projection->offset[axis] + t * frame[2][axis] - projection->foot[axis];
    apart2 += apart * apart;
  }
  return apart2 <= (SAME_FOOT * at->h) * (SAME_FOOT * at->h);
}

static conic_surface_outcome project_place(const conic_surface *surface, const projection_start *at,
                                           conic_workspace *workspace, conic_landing *projection) {
  double frame[3][3], t;
  if (surface->creases.side && conic_creases_project(surface, at->r, at->h, at->except, workspace, projection))
    return projection->outcome;
  conic_surface_outcome outcome = find_foot(surface, at, workspace, frame, &t, projection);
  if (outcome != CONIC_SURFACE_DONE || surface->options.type == CONIC_SURFACE_APSS)
    return outcome;
  outcome = climb(surface, at->h, workspace, frame, t, projection);
  if (outcome != CONIC_SURFACE_DONE || !is_full(surface) || workspace->is_trusting || surface->clusters.mass)
    return outcome; /* clusters differ about every point, so their results do not repeat to the last digits */
  return is_found_again(surface, at, workspace, projection) ? CONIC_SURFACE_DONE : CONIC_SURFACE_NO_MINIMUM;
}

static int is_finite(const double r[3]) {
  return r[0] - r[0] == 0.0 && r[1] - r[1] == 0.0 && r[2] - r[2] == 0.0;
}

void conic_surface_project_one(const conic_surface *surface, const double r[3], double h, uint32_t except,
                               int has_shared, conic_workspace *workspace, conic_landing *projection) {
  conic_surface_outcome outcome = is_finite(r) ? CONIC_SURFACE_TOO_FEW : CONIC_SURFACE_NOT_FINITE;
  memset(projection, 0, sizeof *projection);
  if (is_finite(r) && h > 0.0) {
    const projection_start at = {{r[0], r[1], r[2]}, h, except, has_shared ? &workspace->shared : NULL};
    outcome = project_place(surface, &at, workspace, projection);
  }
  if (outcome != CONIC_SURFACE_DONE)
    memset(projection, 0, sizeof *projection);
  projection->h = h;
  projection->outcome = outcome;
}

/* --- a caller's points --- */

typedef struct projecting {
  conic_surface *surface;
  const double (*positions)[3];
  conic_surface_point *points;
  size_t count;
  conic_workspace *workspaces;
} projecting;

/* Turns the surface's normal to the samples' side. */
static void turn_to(const double side[3], double normal[3]) {
  if (side[0] * normal[0] + side[1] * normal[1] + side[2] * normal[2] < 0.0)
    for (int axis = 0; axis < 3; axis++)
      normal[axis] = -normal[axis];
}

static void project_position(const conic_surface *surface, const double position[3], conic_workspace *workspace,
                             conic_surface_point *point) {
  conic_landing projection;
  double r[3], side[3];
  for (int axis = 0; axis < 3; axis++)
    r[axis] = position[axis] - surface->points.origin[axis];
  double h = is_finite(r) ? conic_surface_scale(surface, r) : 0.0;
  conic_surface_project_one(surface, r, h, CONIC_NO_SLOT, 0, workspace, &projection);
  memset(point, 0, sizeof *point);
  point->outcome = projection.outcome;
  point->h = h;
  for (int axis = 0; axis < 3; axis++)
    point->position[axis] = position[axis];
  if (point->outcome != CONIC_SURFACE_DONE)
    return;
  point->n_neighbours = projection.n_neighbours;
  conic_surface_attributes(surface, workspace, side, point->color);
  for (int axis = 0; axis < 3; axis++) {
    point->position[axis] = surface->points.origin[axis] + (r[axis] + projection.offset[axis]);
    point->foot[axis] = surface->points.origin[axis] + (r[axis] + projection.foot[axis]);
    point->normal[axis] = projection.normal[axis];
    point->plane_normal[axis] = projection.plane_normal[axis];
  }
  turn_to(side, point->normal);
}

static void project_chunk(void *data, size_t i_item, int i_thread) {
  projecting *work = data;
  for (size_t i = i_item * CHUNK; i < (i_item + 1) * CHUNK && i < work->count; i++)
    project_position(work->surface, work->positions[i], &work->workspaces[i_thread], &work->points[i]);
}

conic_status conic_surface_project(conic_surface *surface, size_t count, const double (*positions)[3],
                                   conic_surface_point *points) {
  conic_context *context = surface->context;
  projecting work = {surface, positions, points, count, NULL};
  conic_status status = conic_workspaces_create(context, &work.workspaces);
  if (status == CONIC_OK)
    status = conic_parallel_runs(context, "project", 0.0, 1.0, (count + CHUNK - 1) / CHUNK, CHUNKS_A_REPORT,
                                 project_chunk, &work);
  if (status == CONIC_OK)
    status = conic_workspaces_check(context, work.workspaces);
  conic_workspaces_release(context, work.workspaces);
  return status;
}
