/* The local reference plane (PSS §3.1, step 1): n and t such that, for q = r + t·n,
 *   - among all planes through q, with weights about q, that across n has the least energy, and
 *   - along n, q is at a local minimum of the energy.
 * Eq. 2 as printed, minimised over n and t together, lets q swing about r: its minimum depends on r, not on q alone,
 * and projecting twice moves a point again (docs/notes/surfaces-measured.md says how far). The two conditions are
 * Levin's. They use r only as a point on the line through q along n, so they define a projection.
 *
 * Newton steps in all three unknowns reach the last digits in a few sums. Where they cannot be trusted, the paper's two
 * steps alternate: a safeguarded search along n by Eq. 6 (corrected), then a new normal by the covariance about q. */

#include "core/base/vectors.h"
#include "surface/least_spread.h"
#include "surface/mls_surface.h"

enum { MAX_STEPS = 40, MAX_TURNS = 30, MAX_SEARCH = 40 };

/* In units of h: a Newton step shorter than the first is the last one, because the next would square the error; one
 * longer than the second is not trusted; a search along the normal ends at the third. */
static const double LAST_STEP = 1e-6, LONGEST_STEP = 0.25, SEARCHED = 1e-3;

conic_surface_outcome conic_surface_first_plane(const conic_surface *surface, size_t n_least,
                                                conic_workspace *workspace, double frame[3][3], double *height) {
  static const double origin[3] = {0.0, 0.0, 0.0};
  double sums[CONIC_N_MOMENTS], mean[3], covariance[6];
  surface->loops.moments(&workspace->near, &surface->weighing, origin, sums);
  if (!(sums[CONIC_MOMENT_COUNT] >= (double)n_least))
    return CONIC_SURFACE_TOO_FEW;
  double inverse = 1.0 / sums[0];
  for (int axis = 0; axis < 3; axis++)
    mean[axis] = sums[1 + axis] * inverse;
  for (int i = 0, k = 0; i < 3; i++)
    for (int j = i; j < 3; j++, k++)
      covariance[k] = sums[4 + k] * inverse - mean[i] * mean[j];
  conic_least_spread(covariance, frame);
  *height = frame[2][0] * mean[0] + frame[2][1] * mean[1] + frame[2][2] * mean[2];
  return CONIC_SURFACE_DONE;
}

/* The functions that must vanish at a plane, and their derivatives; lengths in units of h. */
typedef struct well {
  double misfit[3];
  double slope[3][3];
} well;

static well look_at_well(const conic_surface *surface, const conic_workspace *workspace, double h, double frame[3][3],
                         double t) {
  double sums[CONIC_N_PLANE_SUMS], inverse = 1.0 / h, inverse2 = inverse * inverse;
  well here;
  surface->loops.plane(&workspace->near, &surface->weighing, frame, t, sums);
  here.misfit[0] = sums[0] * inverse;
  here.misfit[1] = sums[1] * inverse;
  here.misfit[2] = sums[2];
  here.slope[0][0] = sums[3] * inverse2; /* a tilt of 1 moves a sample at distance h by h */
  here.slope[0][1] = here.slope[1][0] = sums[4] * inverse2;
  here.slope[1][1] = sums[5] * inverse2;
  here.slope[0][2] = sums[6] * inverse;
  here.slope[1][2] = sums[7] * inverse;
  here.slope[2][0] = sums[8] * inverse;
  here.slope[2][1] = sums[9] * inverse;
  here.slope[2][2] = sums[10];
  return here;
}

/* Whether the energy would have a minimum here if the misfit were zero: by tilts, and along n. */
static int is_hollow(const well *here) {
  double determinant = here->slope[0][0] * here->slope[1][1] - here->slope[0][1] * here->slope[1][0];
  return here->slope[0][0] > 0.0 && determinant > 0.0 && here->slope[2][2] < 0.0;
}

/* Newton's step by Cramer's rule; returns 0 where there is none. */
static int newton_step(const well *here, double step[3]) {
  const double(*m)[3] = here->slope;
  double minors[3][3], determinant = 0.0;
  for (int i = 0; i < 3; i++)
    conic_cross(m[(i + 1) % 3], m[(i + 2) % 3], minors[i]);
  for (int axis = 0; axis < 3; axis++)
    determinant += m[0][axis] * minors[0][axis];
  if (!(fabs(determinant) > 1e-12 * fabs(m[0][0] * m[1][1] * m[2][2])))
    return 0;
  for (int axis = 0; axis < 3; axis++)
    step[axis] =
        -(here->misfit[0] * minors[0][axis] + here->misfit[1] * minors[1][axis] + here->misfit[2] * minors[2][axis]) /
        determinant;
  return 1;
}

/* Tilts n by a and b towards the other two axes. */
static void tilt(double frame[3][3], double a, double b) {
  double n[3], along = 0.0;
  for (int axis = 0; axis < 3; axis++)
    n[axis] = frame[2][axis] + a * frame[0][axis] + b * frame[1][axis];
  double inverse = 1.0 / conic_length(n);
  for (int axis = 0; axis < 3; axis++) {
    frame[2][axis] = n[axis] * inverse;
    along += frame[0][axis] * frame[2][axis];
  }
  for (int axis = 0; axis < 3; axis++)
    n[axis] = frame[0][axis] - along * frame[2][axis];
  inverse = 1.0 / conic_length(n);
  for (int axis = 0; axis < 3; axis++)
    frame[0][axis] = n[axis] * inverse;
  conic_cross(frame[2], frame[0], frame[1]);
}

/* The local minimum along n that is downhill from t, within the margin: by Newton's steps, or halvings where these
 * leave the bracket. Returns 0 where there is none. */
static int search_along(const conic_surface *surface, double h, double margin, const conic_workspace *workspace,
                        double frame[3][3], double *t) {
  double low = -margin, high = margin;
  int is_low_sure = 0, is_high_sure = 0;
  for (int i = 0; i < MAX_SEARCH; i++) {
    well here = look_at_well(surface, workspace, h, frame, *t);
    double downhill = here.misfit[2]; /* K: -½ of the energy's derivative, which points down */
    if (downhill > 0.0) {
      low = *t;
      is_low_sure = 1;
    } else {
      high = *t;
      is_high_sure = 1;
    }
    double next = here.slope[2][2] < 0.0 ? *t - downhill / here.slope[2][2] : *t + (downhill > 0.0 ? h : -h) * 0.125;
    if (is_low_sure && is_high_sure && !(next > low && next < high))
      next = 0.5 * (low + high);
    if (!(fabs(next) <= margin))
      return 0;
    double moved = fabs(next - *t);
    *t = next;
    if (moved <= SEARCHED * h)
      return is_low_sure || is_high_sure;
  }
  return 0;
}

/* Turns n to the neighbours' direction of least spread about q, which stays. */
static void turn_normal(const conic_surface *surface, conic_workspace *workspace, double frame[3][3], double t) {
  double sums[CONIC_N_MOMENTS];
  const double q[3] = {t * frame[2][0], t * frame[2][1], t * frame[2][2]};
  surface->loops.moments(&workspace->near, &surface->weighing, q, sums);
  conic_least_spread(sums + 4, frame);
}

/* Alternates the paper's steps until they change little. Returns 0 where the search finds no minimum. */
static int take_turns(const conic_surface *surface, double h, double margin, conic_workspace *workspace,
                      double frame[3][3], double *t) {
  for (int i = 0; i < MAX_TURNS; i++) {
    double before[3], changed = 0.0, agreed = 0.0;
    memcpy(before, frame[2], sizeof before);
    if (!search_along(surface, h, margin, workspace, frame, t))
      return 0;
    turn_normal(surface, workspace, frame, *t);
    for (int axis = 0; axis < 3; axis++)
      agreed += before[axis] * frame[2][axis];
    if (agreed < 0.0) { /* the same line, seen from the other end */
      for (int axis = 0; axis < 3; axis++)
        frame[2][axis] = -frame[2][axis];
      conic_cross(frame[2], frame[0], frame[1]);
    }
    for (int axis = 0; axis < 3; axis++)
      changed += (before[axis] - frame[2][axis]) * (before[axis] - frame[2][axis]);
    if (changed < 1e-4)
      return 1;
  }
  return 1;
}

/* Newton's steps from a nearby plane. DONE, or NO_MINIMUM where they do not converge. */
static conic_surface_outcome close_in(const conic_surface *surface, double h, double margin,
                                      const conic_workspace *workspace, double frame[3][3], double *t) {
  double before = LONGEST_STEP;
  for (int i = 0; i < MAX_STEPS; i++) {
    double step[3];
    well here = look_at_well(surface, workspace, h, frame, *t);
    if (!is_hollow(&here) || !newton_step(&here, step))
      return CONIC_SURFACE_NO_MINIMUM;
    double length = conic_length(step) / h;
    if (!(length <= before) || !(fabs(*t + step[2]) <= margin))
      return CONIC_SURFACE_NO_MINIMUM;
    *t += step[2];
    tilt(frame, step[0] / h, step[1] / h);
    if (length <= LAST_STEP)
      return CONIC_SURFACE_DONE;
    before = 0.5 * length > LAST_STEP ? 0.5 * length : LAST_STEP;
  }
  return CONIC_SURFACE_NO_MINIMUM;
}

conic_surface_outcome conic_surface_find_plane(const conic_surface *surface, double h, double margin,
                                               conic_workspace *workspace, double frame[3][3], double *t) {
  double first[3][3], first_t = *t;
  memcpy(first, frame, sizeof first);
  if (close_in(surface, h, margin, workspace, frame, t) == CONIC_SURFACE_DONE)
    return CONIC_SURFACE_DONE;
  memcpy(frame, first, sizeof first);
  *t = first_t;
  if (!take_turns(surface, h, margin, workspace, frame, t))
    return CONIC_SURFACE_NO_MINIMUM;
  return close_in(surface, h, margin, workspace, frame, t);
}

/* --- algebraic spheres --- */

enum { MAX_ROUNDS = 100, LEAST_SAMPLES = 4 };

/* In units of h: a step shorter than this is the last one; if the samples' mean is farther from the foot than this,
 * they lie to one side, and the sphere there follows no data. */
static const double SETTLED = 1e-10, FARTHEST_MEAN = 0.75;

typedef struct fitted_sphere {
  double constant, linear[3], square; /* about the place of its weights */
} fitted_sphere;

/* The sphere whose gradient is nearest to the normals, through the samples' mean. 0 where the normals cancel. */
static int fit_sphere(const double sums[CONIC_N_SPHERE_SUMS], fitted_sphere *s) {
  double w = sums[0], inverse = 1.0 / w;
  const double *places = sums + 1, *normals = sums + 4;
  double spread = sums[7] - conic_dot(places, places) * inverse;
  double turn = sums[8] - conic_dot(places, normals) * inverse;
  s->square = spread > 0.0 ? 0.5 * turn / spread : 0.0;
  for (int axis = 0; axis < 3; axis++)
    s->linear[axis] = (normals[axis] - 2.0 * s->square * places[axis]) * inverse;
  s->constant = -(conic_dot(s->linear, places) + s->square * sums[7]) * inverse;
  return conic_dot(s->linear, s->linear) - 4.0 * s->constant * s->square > 0.0;
}

/* Moves from `from` along the sphere's gradient to its surface; returns 0 where there is none. */
static int drop_to_sphere(const fitted_sphere *s, const double from[3], double foot[3], double normal[3]) {
  double gradient[3], value = s->constant + conic_dot(s->linear, from) + s->square * conic_dot(from, from);
  for (int axis = 0; axis < 3; axis++)
    gradient[axis] = s->linear[axis] + 2.0 * s->square * from[axis];
  double length2 = conic_dot(gradient, gradient), root2 = length2 - 4.0 * s->square * value;
  if (!(length2 > 0.0 && root2 >= 0.0))
    return 0;
  double length = sqrt(length2), along = -2.0 * value / (length + sqrt(root2));
  for (int axis = 0; axis < 3; axis++) {
    foot[axis] = from[axis] + along * gradient[axis] / length;
    normal[axis] = s->linear[axis] + 2.0 * s->square * foot[axis];
  }
  length = conic_length(normal);
  for (int axis = 0; axis < 3; axis++)
    normal[axis] = length > 0.0 ? normal[axis] / length : 0.0;
  return length > 0.0;
}

conic_surface_outcome conic_surface_find_sphere(const conic_surface *surface, double h, double margin,
                                                conic_workspace *workspace, conic_landing *projection) {
  double foot[3] = {0.0, 0.0, 0.0}, normal[3], sums[CONIC_N_SPHERE_SUMS];
  for (int i = 0; i < MAX_ROUNDS; i++) {
    fitted_sphere s;
    double from[3], step[3];
    surface->loops.sphere(&workspace->near, &surface->weighing, foot, sums);
    if (!(sums[9] >= (double)LEAST_SAMPLES))
      return CONIC_SURFACE_TOO_FEW;
    for (int axis = 0; axis < 3; axis++)
      from[axis] = -foot[axis]; /* the point itself, relative to the foot */
    if (!fit_sphere(sums, &s) || !drop_to_sphere(&s, from, step, normal))
      return CONIC_SURFACE_NO_MINIMUM;
    double moved = conic_length(step);
    for (int axis = 0; axis < 3; axis++)
      foot[axis] += step[axis];
    if (!(conic_dot(foot, foot) <= margin * margin))
      return CONIC_SURFACE_NO_MINIMUM;
    if (moved <= SETTLED * h) {
      if (conic_dot(sums + 1, sums + 1) > (FARTHEST_MEAN * h * sums[0]) * (FARTHEST_MEAN * h * sums[0]))
        return CONIC_SURFACE_ILL_CONDITIONED;
      for (int axis = 0; axis < 3; axis++) {
        projection->offset[axis] = projection->foot[axis] = foot[axis];
        projection->normal[axis] = projection->plane_normal[axis] = normal[axis];
      }
      projection->n_neighbours = (int)sums[9];
      return CONIC_SURFACE_DONE;
    }
  }
  return CONIC_SURFACE_NO_MINIMUM;
}
