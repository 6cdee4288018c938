/* How far off the set-up of a program of floats may be in its derivative: the chain of oracle_gradient_chain.c once
 * more, with every term taken without regard to its sign. What any order of these products and sums errs by is at most
 * the number of roundings of a term, times the unit, times this sum. */

#include "oracle/gaussians/oracle_gradient_job.h"

void conic_oracle_row_sizes(const oracle_gaussian_view *view, const oracle_gaussian *g, row_sizes *s) {
  s->focal[0] = view->camera->fx;
  s->focal[1] = view->camera->fy;
  for (int axis = 0; axis < 2; axis++) {
    s->slope[axis] = fabs(g->mean[axis] / g->mean[2]);
    if (view->rules->slope_margin >= 0.0) /* it is clamped, by less than that */
      s->slope[axis] = oracle_min(s->slope[axis], 1.3 * (view->camera->width + view->camera->height) / s->focal[axis]);
    for (int k = 0; k < 3; k++)
      s->rows[axis][k] = s->focal[axis] / g->mean[2] * g->scale[k] * (1.0 + s->slope[axis]);
  }
}

static void size_form(const oracle_gaussian *g, const double *sums, row_sizes *s) {
  const double cross = sqrt(g->form[0] * g->form[2]), f[2][2] = {{g->form[0], cross}, {cross, g->form[2]}};
  const double by[2][2] = {{sums[BY_FORM], 0.5 * sums[BY_FORM + 1]}, {0.5 * sums[BY_FORM + 1], sums[BY_FORM + 2]}};
  for (int i = 0; i < 2; i++)
    for (int j = 0; j < 2; j++) {
      double c = 0.0;
      for (int k = 0; k < 2; k++)
        for (int l = 0; l < 2; l++)
          c += f[i][k] * by[k][l] * f[l][j];
      for (int k = 0; k < 3; k++)
        s->by_rows[i][k] += 2.0 * c * s->rows[j][k];
    }
}

/* √(|a × b|²/after): the determinants come of products of covariances, too. */
static double size_compensation(const oracle_gaussian_view *view, const oracle_gaussian *g, double opacity,
                                double by_opacity, row_sizes *s) {
  const double least = view->rules->compensation_least;
  if (!(least >= 0.0) || opacity == 0.0)
    return by_opacity;
  const double share = fabs(g->opacity / opacity), after = 1.0 / (g->form[0] * g->form[2] - g->form[1] * g->form[1]);
  if (!(share > 0.0) || share * share <= least)
    return by_opacity * share;
  const double by_before = by_opacity * fabs(opacity) / share / after;
  for (int i = 0; i < 2; i++)
    for (int k = 0; k < 3; k++)
      s->by_rows[i][k] += by_before * 4.0 * oracle_dot(s->rows[1 - i], s->rows[1 - i]) * s->rows[i][k];
  return by_opacity * share;
}

static void size_space(const oracle_gaussian *g, const double *sums, row_sizes *s, double by_axes[3][3]) {
  const double z = g->mean[2];
  for (int axis = 0; axis < 2; axis++) {
    double by_slope = 0.0, own = 0.0;
    for (int k = 0; k < 3; k++) {
      double by = s->focal[axis] / z * s->by_rows[axis][k];
      by_axes[k][axis] += by;
      by_axes[k][2] += by * s->slope[axis];
      by_slope += by * g->scale[k];
      own += s->by_rows[axis][k] * s->rows[axis][k];
    }
    double by_ratio = sums[BY_PLACE + axis] * s->focal[axis] + by_slope;
    s->by_mean[axis] += by_ratio / z;
    s->by_mean[2] += own / z + by_ratio * s->slope[axis] / z;
  }
  s->by_mean[2] += sums[BY_Z];
}

static void size_turn(const oracle_gaussian_view *view, const double q[4], double length, const oracle_gaussian *g,
                      const row_sizes *s, double by_axes[3][3], oracle_parameters *to) {
  double all = 0.0;
  for (int k = 0; k < 3; k++) {
    to->scale[k] = by_axes[k][0] + by_axes[k][1] + by_axes[k][2];
    all += g->scale[k] * to->scale[k];
  }
  for (int row = 0; row < 3; row++)
    for (int j = 0; j < 3; j++)
      to->mean[j] += fabs(view->camera->cam_from_world[row][j]) * s->by_mean[row];
  for (int k = 0; k < 4; k++) /* |∂R/∂q| ≤ 4, over all that turn; and the part along q is taken away */
    to->rotation[k] = 4.0 * all * (1.0 + fabs(q[k])) / length;
}

static void size_color(const oracle_gaussian_view *view, const conic_gaussians *set, size_t i, const double by_color[3],
                       oracle_parameters *to) {
  const int n = (set->sh_degree + 1) * (set->sh_degree + 1);
  double sh[3 * (CONIC_MAX_SH_DEGREE + 1) * (CONIC_MAX_SH_DEGREE + 1)], direction[3], far = 0.0, by_direction = 0.0;
  for (int axis = 0; axis < 3; axis++) {
    const double mean = set->origin[axis] + (double)set->position[axis][i];
    direction[axis] = mean - view->eye[axis];
    far += fabs(mean) + fabs(view->eye[axis]);
  }
  const double length = oracle_length(direction);
  conic_oracle_harmonics_of(set, i, sh);
  for (int k = 0; k < n; k++) {
    const int l = k < 1 ? 0 : k < 4 ? 1 : k < 9 ? 2 : k < 16 ? 3 : 4;
    const double largest = sqrt((2 * l + 1) / 12.566), cancelled = length > 0.0 ? 1.0 + far / length : 1.0;
    for (int c = 0; c < 3; c++) { /* of degree l, Y is at most √((2l + 1)/4π), and grows by l + 1 times that */
      to->sh[3 * k + c] = by_color[c] * largest * (l ? 1.0 + l * cancelled : 1.0);
      by_direction += by_color[c] * fabs(sh[3 * k + c]) * largest * l * (l + 1) * cancelled;
    }
  }
  for (int axis = 0; axis < 3 && length > 0.0; axis++)
    to->mean[axis] += 2.0 * by_direction / length;
}

void conic_oracle_gradient_sizes(const oracle_gaussian_view *view, const conic_gaussians *set, size_t i,
                                 const double *sums, oracle_parameters *to) {
  oracle_gaussian g;
  row_sizes s = {0};
  double q[4], by_axes[3][3] = {{0.0}};
  memset(to, 0, sizeof *to);
  conic_oracle_gaussian_place(view, set, i, &g);
  const double length = conic_oracle_quaternion(view->rules, set, i, q);
  conic_oracle_row_sizes(view, &g, &s);
  to->opacity = size_compensation(view, &g, (double)set->opacity[i], sums[BY_OPACITY], &s);
  size_form(&g, sums, &s);
  size_space(&g, sums, &s, by_axes);
  size_turn(view, q, length, &g, &s, by_axes, to);
  size_color(view, set, i, sums + BY_COLOR, to);
}
