#include "oracle/oracle_splat.h"

void conic_oracle_exact(const oracle_view *view, const oracle_placed *s, oracle_exact *exact) {
  const conic_camera *c = &view->camera;
  const double matrix[3][3] = {
      {s->tu[0], s->tu[1], s->tu[2]}, {s->tv[0], s->tv[1], s->tv[2]}, {s->p[0], s->p[1], s->p[2]}};
  double inverse[3][3];
  memset(exact, 0, sizeof *exact);
  exact->has_plane = conic_oracle_invert(matrix, inverse);
  for (int i = 0; i < 3 && exact->has_plane; i++) {
    exact->from_screen[0][i] = inverse[0][i] / c->fx;
    exact->from_screen[1][i] = inverse[1][i] / c->fy;
    exact->from_screen[2][i] = inverse[2][i] - c->cx * inverse[0][i] / c->fx - c->cy * inverse[1][i] / c->fy;
    exact->has_plane = oracle_is_finite(exact->from_screen[0][i] + exact->from_screen[1][i] + exact->from_screen[2][i]);
  }
  exact->is_center_in_front = s->p[2] > 0.0;
  if (exact->is_center_in_front) {
    exact->center_px[0] = c->fx * s->p[0] / s->p[2] + c->cx;
    exact->center_px[1] = c->fy * s->p[1] / s->p[2] + c->cy;
  }
}

/* A place of the screen and what is there of the plane. */
typedef struct spot {
  double at[2], u[2], iz, jacobian[2][2];
} spot;

static spot look_at_spot(const oracle_exact *exact, double x, double y) {
  const double(*rows)[3] = exact->from_screen;
  spot s = {{x, y}, {0.0, 0.0}, rows[0][2] * x + rows[1][2] * y + rows[2][2], {{0.0, 0.0}, {0.0, 0.0}}};
  for (int i = 0; i < 2; i++) {
    s.u[i] = (rows[0][i] * x + rows[1][i] * y + rows[2][i]) / s.iz;
    for (int j = 0; j < 2; j++)
      s.jacobian[i][j] = (rows[j][i] - s.u[i] * rows[j][2]) / s.iz;
  }
  return s;
}

/* Minus the logarithm of the integrand, the kernel taken as a Gaussian; infinite behind the eye. */
static double depth_of(const spot *s, const double x[2], double h) {
  double dx = s->at[0] - x[0], dy = s->at[1] - x[1];
  return s->iz > 0.0 ? 0.5 * (s->u[0] * s->u[0] + s->u[1] * s->u[1]) + 0.5 * (dx * dx + dy * dy) / h : INFINITY;
}

static oracle_symmetric curvature(const spot *s, double h) {
  const double(*j)[2] = (const double(*)[2])s->jacobian;
  return (oracle_symmetric){j[0][0] * j[0][0] + j[1][0] * j[1][0] + 1.0 / h, j[0][0] * j[0][1] + j[1][0] * j[1][1],
                            j[0][1] * j[0][1] + j[1][1] * j[1][1] + 1.0 / h};
}

/* Where the integrand is greatest: Gauss and Newton, with steps halved until they lead down. */
static spot find_mode(const oracle_exact *exact, const double x[2], double h) {
  spot best = look_at_spot(exact, x[0], x[1]);
  double depth = depth_of(&best, x, h);
  if (exact->is_center_in_front) {
    spot center = look_at_spot(exact, exact->center_px[0], exact->center_px[1]);
    double center_depth = depth_of(&center, x, h);
    if (center_depth < depth) {
      best = center;
      depth = center_depth;
    }
  }
  for (int i = 0; i < 40 && depth < INFINITY; i++) {
    double slope[2], step[2], factor = 1.0;
    for (int j = 0; j < 2; j++)
      slope[j] = best.jacobian[0][j] * best.u[0] + best.jacobian[1][j] * best.u[1] + (best.at[j] - x[j]) / h;
    oracle_apply(oracle_inverse(curvature(&best, h)), slope, step);
    int is_lower = 0;
    for (int k = 0; k < 30 && !is_lower; k++, factor *= 0.5) {
      spot next = look_at_spot(exact, best.at[0] - factor * step[0], best.at[1] - factor * step[1]);
      double next_depth = depth_of(&next, x, h);
      is_lower = next_depth < depth;
      if (is_lower) {
        int is_done = depth - next_depth < 1e-6;
        best = next;
        depth = next_depth;
        if (is_done)
          return best;
      }
    }
    if (!is_lower)
      break;
  }
  return best;
}

/* The grid of one trapezoidal sum: its middle and its two steps. */
typedef struct grid {
  const oracle_view *view;
  const oracle_exact *exact;
  double x[2], middle[2], steps[2][2], greatest;
  int n_least; /* points each way that are always looked at */
} grid;

static double integrand(const grid *g, double i, double j) {
  double at[2], u[2], squared = 0.0;
  const double(*rows)[3] = g->exact->from_screen;
  for (int c = 0; c < 2; c++) {
    at[c] = g->middle[c] + i * g->steps[0][c] + j * g->steps[1][c];
    squared += (at[c] - g->x[c]) * (at[c] - g->x[c]);
  }
  double iz = rows[0][2] * at[0] + rows[1][2] * at[1] + rows[2][2];
  if (!(iz > 0.0))
    return 0.0;
  for (int c = 0; c < 2; c++)
    u[c] = (rows[0][c] * at[0] + rows[1][c] * at[1] + rows[2][c]) / iz;
  double q = u[0] * u[0] + u[1] * u[1], filter = -0.5 * squared / g->view->prefilter;
  if (conic_oracle_kernel_facts(&g->view->kernel).is_gaussian)
    return conic_oracle_exp(filter - 0.5 * q);
  return conic_oracle_exp(filter) * conic_oracle_kernel(&g->view->kernel, q);
}

/* From the middle outwards until what is left counts for nothing. */
static double sum_row(const grid *g, double offset, double j) {
  const int n_most = 4096;
  double sum = 0.0;
  for (int side = 0; side < 2; side++)
    for (int n = side; n < n_most; n++) {
      double value = integrand(g, offset + (side ? -(double)n : (double)n), j);
      sum += value;
      if (n >= g->n_least && value <= 1e-12 * g->greatest)
        break;
    }
  return sum;
}

static double sum_grid(const grid *g, double offset) {
  const int n_most = 4096;
  double sum = 0.0;
  for (int side = 0; side < 2; side++)
    for (int n = side; n < n_most; n++) {
      double row = sum_row(g, offset, offset + (side ? -(double)n : (double)n));
      sum += row;
      if (n >= g->n_least && row <= 1e-12 * (sum + g->greatest))
        break;
    }
  double area = fabs(g->steps[0][0] * g->steps[1][1] - g->steps[0][1] * g->steps[1][0]);
  return sum * area / (2.0 * 3.14159265358979323846 * g->view->prefilter);
}

/* The principal axes of the integrand about its mode, one standard deviation long. */
static void principal_axes(oracle_symmetric curvature, double axes[2][2]) {
  double greater = oracle_greater_eigenvalue(curvature), lesser = oracle_determinant(curvature) / greater;
  double a[2] = {curvature.xy, greater - curvature.xx}, b[2] = {greater - curvature.yy, curvature.xy};
  double *e = fabs(a[0]) + fabs(a[1]) > fabs(b[0]) + fabs(b[1]) ? a : b;
  double length = sqrt(e[0] * e[0] + e[1] * e[1]);
  double unit[2] = {length > 0.0 ? e[0] / length : 1.0, length > 0.0 ? e[1] / length : 0.0};
  for (int c = 0; c < 2; c++)
    axes[0][c] = unit[c] / sqrt(greater);
  axes[1][0] = -unit[1] / sqrt(lesser);
  axes[1][1] = unit[0] / sqrt(lesser);
}

/* Trapezoidal sums: for what is smooth and dies away, as a Gaussian does, they converge faster than any power of the
 * step. A second sum, half a step aside, tells how far off the first is; then the step is halved. */
double conic_oracle_exact_weight(const oracle_view *view, const oracle_exact *exact, double x, double y,
                                 double *change) {
  const double place[2] = {x, y};
  *change = 0.0;
  if (!exact->has_plane)
    return 0.0;
  if (!(view->prefilter > 0.0)) {
    spot s = look_at_spot(exact, x, y);
    return s.iz > 0.0 ? conic_oracle_kernel(&view->kernel, s.u[0] * s.u[0] + s.u[1] * s.u[1]) : 0.0;
  }
  int is_smooth = conic_oracle_kernel_facts(&view->kernel).is_gaussian;
  double tolerance = is_smooth ? 1e-8 : 1e-5, step = 1.0, axes[2][2], result = 0.0;
  spot mode = find_mode(exact, place, view->prefilter);
  if (!(depth_of(&mode, place, view->prefilter) < 700.0))
    return 0.0;
  principal_axes(curvature(&mode, view->prefilter), axes);
  grid g = {.view = view, .exact = exact};
  memcpy(g.x, place, sizeof place);
  memcpy(g.middle, mode.at, sizeof g.middle);
  for (int level = 0; level < 6; level++, step *= 0.5) {
    for (int i = 0; i < 2; i++)
      for (int c = 0; c < 2; c++)
        g.steps[i][c] = step * axes[i][c];
    g.n_least = (int)(6.0 / step);
    g.greatest = integrand(&g, 0.0, 0.0);
    double here = sum_grid(&g, 0.0), aside = sum_grid(&g, 0.5);
    result = 0.5 * (here + aside);
    *change = fabs(here - aside);
    if (*change <= tolerance * (is_smooth ? result + 1e-3 : 1.0))
      break;
  }
  return result;
}
