/* The local reference plane: the minimum of PSS Eq. 2.
 *
 * The paper takes turns between t and q; here all three unknowns, two tilts of n and t, take Newton steps together,
 * damped until the energy falls. The minimum is the same, and it is reached to the last digits in a few sums. */
#include <math.h>
#include <string.h>

#include "core/eigen.h"
#include "surface/surface.h"

enum { MAX_STEPS = 60 };

/* Both in units of h: a step shorter than the first is the last, as Newton's squares what is left; none is longer than
 * the second. */
static const double LAST_STEP = 1e-6, LONGEST_STEP = 0.5;

static void cross(const double a[3], const double b[3], double c[3]) {
  for (int axis = 0; axis < 3; axis++)
    c[axis] = a[(axis + 1) % 3] * b[(axis + 2) % 3] - a[(axis + 2) % 3] * b[(axis + 1) % 3];
}

conic_surface_outcome conic_surface_first_plane(const conic_surface *surface, size_t n_least,
                                                conic_workspace *workspace, double frame[3][3], double *height) {
  static const double origin[3] = {0.0, 0.0, 0.0};
  double sums[CONIC_N_MOMENTS], mean[3], covariance[6], values[3];
  surface->kernels->moments(&workspace->near, &surface->weighing, origin, sums);
  if (!(sums[CONIC_MOMENT_COUNT] >= (double)n_least))
    return CONIC_SURFACE_TOO_FEW;
  double inverse = 1.0 / sums[0];
  for (int axis = 0; axis < 3; axis++)
    mean[axis] = sums[1 + axis] * inverse;
  for (int i = 0, k = 0; i < 3; i++)
    for (int j = i; j < 3; j++, k++)
      covariance[k] = sums[4 + k] * inverse - mean[i] * mean[j];
  conic_eigen3(covariance, values, frame);
  cross(frame[2], frame[0], frame[1]);
  *height = frame[2][0] * mean[0] + frame[2][1] * mean[1] + frame[2][2] * mean[2];
  return CONIC_SURFACE_DONE;
}

/* The energy about a plane, with lengths in units of h. */
typedef struct well {
  double energy, gradient[3], hessian[3][3];
} well;

static well look(const conic_surface *surface, const conic_workspace *workspace, double h, double frame[3][3],
                 double t) {
  double sums[CONIC_N_PLANE_SUMS], inverse = 1.0 / h;
  well here;
  surface->kernels->plane(&workspace->near, &surface->weighing, frame, t, sums);
  here.energy = sums[0];
  here.gradient[0] = sums[1] * inverse; /* a tilt of 1 moves what is h away by h */
  here.gradient[1] = sums[2] * inverse;
  here.gradient[2] = sums[3];
  here.hessian[0][0] = sums[4] * inverse * inverse;
  here.hessian[0][1] = here.hessian[1][0] = sums[5] * inverse * inverse;
  here.hessian[0][2] = here.hessian[2][0] = sums[6] * inverse;
  here.hessian[1][1] = sums[7] * inverse * inverse;
  here.hessian[1][2] = here.hessian[2][1] = sums[8] * inverse;
  here.hessian[2][2] = sums[9];
  return here;
}

/* Solves (H + damping · 1) step = -gradient by Cholesky's factors; 0 where the matrix is not positive definite. */
static int solve(const well *here, double damping, double step[3]) {
  double l[3][3] = {{0}};
  for (int j = 0; j < 3; j++) {
    double diagonal = here->hessian[j][j] + damping;
    for (int k = 0; k < j; k++)
      diagonal -= l[j][k] * l[j][k];
    if (!(diagonal > 1e-12 * (fabs(here->hessian[j][j]) + damping)))
      return 0;
    l[j][j] = sqrt(diagonal);
    for (int i = j + 1; i < 3; i++) {
      double sum = here->hessian[i][j];
      for (int k = 0; k < j; k++)
        sum -= l[i][k] * l[j][k];
      l[i][j] = sum / l[j][j];
    }
  }
  for (int i = 0; i < 3; i++) {
    double sum = -here->gradient[i];
    for (int k = 0; k < i; k++)
      sum -= l[i][k] * step[k];
    step[i] = sum / l[i][i];
  }
  for (int i = 3; i-- > 0;) {
    for (int k = i + 1; k < 3; k++)
      step[i] -= l[k][i] * step[k];
    step[i] /= l[i][i];
  }
  return 1;
}

static double length_of(const double v[3]) {
  return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* Tilts n by a and b towards the other two axes. */
static void tilt(double frame[3][3], double a, double b, double tilted[3][3]) {
  double n[3], along = 0.0;
  for (int axis = 0; axis < 3; axis++)
    n[axis] = frame[2][axis] + a * frame[0][axis] + b * frame[1][axis];
  double inverse = 1.0 / length_of(n);
  for (int axis = 0; axis < 3; axis++) {
    tilted[2][axis] = n[axis] * inverse;
    along += frame[0][axis] * tilted[2][axis];
  }
  for (int axis = 0; axis < 3; axis++)
    n[axis] = frame[0][axis] - along * tilted[2][axis];
  inverse = 1.0 / length_of(n);
  for (int axis = 0; axis < 3; axis++)
    tilted[0][axis] = n[axis] * inverse;
  cross(tilted[2], tilted[0], tilted[1]);
}

/* One damped step from `here`; returns its length in units of h, or -1 where no damping makes the matrix definite.
 * *damping grows until it does. */
static double damped_step(const well *here, double h, double *damping, double step[3]) {
  double trace = fabs(here->hessian[0][0]) + fabs(here->hessian[1][1]) + fabs(here->hessian[2][2]);
  while (!solve(here, *damping * trace, step)) {
    *damping = *damping > 0.0 ? *damping * 4.0 : 1e-2;
    if (!(*damping < 1e4))
      return -1.0;
  }
  double length = length_of(step) / h;
  if (length > LONGEST_STEP) {
    for (int i = 0; i < 3; i++)
      step[i] *= LONGEST_STEP / length;
    length = LONGEST_STEP;
  }
  return length;
}

conic_surface_outcome conic_surface_find_plane(const conic_surface *surface, double h, double margin,
                                               conic_workspace *workspace, double frame[3][3], double *t, int *beyond) {
  double damping = 0.0, trial[3][3], step[3];
  well here = look(surface, workspace, h, frame, *t);
  *beyond = 0;
  for (int i = 0; i < MAX_STEPS; i++) {
    double length = damped_step(&here, h, &damping, step);
    if (!(length >= 0.0))
      return CONIC_SURFACE_NO_MINIMUM;
    double trial_t = *t + step[2];
    tilt(frame, step[0] / h, step[1] / h, trial);
    if (!(fabs(trial_t) <= margin)) {
      *beyond = 1;
      return CONIC_SURFACE_NO_MINIMUM;
    }
    int is_last = damping == 0.0 && length <= LAST_STEP;
    well there = here;
    if (!is_last)
      there = look(surface, workspace, h, trial, trial_t);
    if (there.energy <= here.energy * (1.0 + 1e-13)) {
      memcpy(frame, trial, sizeof trial);
      *t = trial_t;
      here = there;
      damping = damping > 1e-3 ? damping * 0.25 : 0.0;
    } else
      damping = damping > 0.0 ? damping * 4.0 : 1e-2;
    if (is_last)
      return CONIC_SURFACE_DONE;
    if (!(damping < 1e8))
      return CONIC_SURFACE_NO_MINIMUM;
  }
  return CONIC_SURFACE_NO_MINIMUM;
}
