/* The colour of a Gaussian, and how far roundings may take it. */
#include "oracle/gaussians/oracle_uncertain.h"

/* max(0, ½ + Σ sh·Y): each Y is rounded, each product, and each sum. In float the direction is off, too: by the
 * addition theorem, Y of degree l grows by at most √(l·(l + 1)·(2l + 1)/4π) along the sphere; twice that covers what a
 * direction that is not quite of unit length does. */
int conic_oracle_uncertain_color(const oracle_doubting *d, oracle_uncertain *g) {
  const conic_gaussians *set = d->set;
  const int degree = d->view->rules->has_plain_color ? 0 : set->sh_degree;
  const size_t n = (size_t)(degree + 1) * (size_t)(degree + 1), i = g->index;
  const size_t n_stored = (size_t)(set->sh_degree + 1) * (size_t)(set->sh_degree + 1);
  const double most = d->view->rules->color_most > 0.0 ? d->view->rules->color_most : INFINITY;
  double direction[3], y[(CONIC_MAX_SH_DEGREE + 1) * (CONIC_MAX_SH_DEGREE + 1)], length, far = 0.0;
  double sum[3] = {0.5, 0.5, 0.5}, size[3] = {0.5, 0.5, 0.5}, turned[3] = {0.0, 0.0, 0.0};
  for (int axis = 0; axis < 3; axis++) {
    double mean = set->origin[axis] + (double)set->position[axis][i];
    direction[axis] = mean - d->view->eye[axis];
    far += fabs(mean) + fabs(d->view->eye[axis]);
  }
  length = oracle_length(direction);
  for (int axis = 0; axis < 3; axis++)
    direction[axis] = length > 0.0 ? direction[axis] / length : 0.0;
  double off = d->model->setup_roundoff * (length > 0.0 ? 2.0 * far / length + 6.0 : 0.0);
  conic_oracle_harmonic_values(degree, direction, y);
  for (size_t k = 0; k < n; k++) {
    int l = k < 1 ? 0 : k < 4 ? 1 : k < 9 ? 2 : k < 16 ? 3 : 4;
    for (size_t c = 0; c < 3; c++) {
      double coefficient = conic_oracle_harmonic_at(set, (i * n_stored + k) * 3 + c);
      sum[c] += y[k] * coefficient;
      size[c] += fabs(y[k] * coefficient);
      turned[c] += 2.0 * off * sqrt(l * (l + 1) * (2 * l + 1) / 12.566) * fabs(coefficient);
      turned[c] += 8.0 * d->model->setup_roundoff * sqrt((2 * l + 1) / 12.566) * fabs(coefficient);
    }
  }
  for (int c = 0; c < 3; c++) {
    g->color[c] = (bounded){sum[c], turned[c] + ((double)n + 3.0) * ORACLE_FLOAT_UNIT * size[c]};
    if (!bounded_is_finite(g->color[c]))
      return 0;
    g->color[c] = bounded_within(g->color[c], 0.0, most);
    if (d->view->rules->fade_z > 0.0)
      g->color[c] = bounded_multiply(g->color[c], g->fade, ORACLE_FLOAT_UNIT);
  }
  return 1;
}
