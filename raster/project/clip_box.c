
#include <math.h>

#include "raster/project/clip_disc.h"

/* A part of the disc that lines bound. It is convex: on the screen its extremes are the outline's, or corners where the
 * outline meets a line, or two lines meet. */
typedef struct part {
  const conic_view *view;
  const conic_disc *disc;
  double lines[3][3]; /* the near plane is one of them */
  int n_lines, n_points;
  double low_px[2], high_px[2];
} part;

/* Within the disc and kept by all lines, roundings apart: corners lie on them. */
static int keeps(const part *p, double u, double v) {
  const double slack = 1e-9, cutoff = (double)p->view->cutoff;
  for (int i = 0; i < p->n_lines; i++) {
    const double *l = p->lines[i];
    double size = fabs(l[0] * u) + fabs(l[1] * v) + fabs(l[2]);
    if (!((l[0] * u + l[1] * v) + l[2] >= -slack * size))
      return 0;
  }
  return u * u + v * v <= cutoff * cutoff * (1.0 + slack);
}

static void consider_place(part *p, double u, double v) {
  if (!keeps(p, u, v))
    return;
  const conic_view *view = p->view;
  const double focal[2] = {view->fx, view->fy}, principal[2] = {view->cx, view->cy};
  double at[3];
  for (int i = 0; i < 3; i++)
    at[i] = (p->disc->p[i] + u * p->disc->tu[i]) + v * p->disc->tv[i];
  at[2] = at[2] > view->near_z ? at[2] : view->near_z;
  for (int i = 0; i < 2; i++) {
    double px = principal[i] + focal[i] * (at[i] / at[2]);
    p->low_px[i] = p->n_points && p->low_px[i] < px ? p->low_px[i] : px;
    p->high_px[i] = p->n_points && p->high_px[i] > px ? p->high_px[i] : px;
  }
  p->n_points++;
}

/* Where a + b·cos θ + c·sin θ = 0 on the outline. */
static void consider_outline(part *p, double a, double b, double c) {
  double solutions[2][2], cutoff = (double)p->view->cutoff;
  if (!conic_clip_solve(b, c, a, solutions))
    return;
  for (int i = 0; i < 2; i++)
    consider_place(p, cutoff * solutions[i][0], cutoff * solutions[i][1]);
}

static void find_extremes(part *p) {
  const conic_disc *d = p->disc;
  double cutoff = (double)p->view->cutoff;
  p->n_points = 0;
  for (int i = 0; i < 2; i++) /* along x and y: as in raster/project/clip_disc.c */
    consider_outline(p, cutoff * (d->tv[i] * d->tu[2] - d->tu[i] * d->tv[2]), d->tv[i] * d->p[2] - d->p[i] * d->tv[2],
                     d->p[i] * d->tu[2] - d->tu[i] * d->p[2]);
  for (int i = 0; i < p->n_lines; i++) {
    const double *l = p->lines[i];
    consider_outline(p, l[2], cutoff * l[0], cutoff * l[1]);
    for (int k = 0; k < i; k++) {
      const double *m = p->lines[k];
      double determinant = l[0] * m[1] - l[1] * m[0];
      consider_place(p, (l[1] * m[2] - l[2] * m[1]) / determinant, (l[2] * m[0] - l[0] * m[2]) / determinant);
    }
  }
}

int conic_clip_box(const conic_view *view, const conic_disc *disc, const float lines[2][3], int n_lines, int is_or,
                   double low_px[2], double high_px[2]) {
  int n_points = 0, n_parts = is_or ? n_lines : 1;
  for (int i_part = 0; i_part < n_parts; i_part++) {
    part p = {
        .view = view, .disc = disc, .n_lines = 1, .lines = {{disc->tu[2], disc->tv[2], disc->p[2] - view->near_z}}};
    for (int i = is_or ? i_part : 0; i < (is_or ? i_part + 1 : n_lines); i++, p.n_lines++)
      for (int k = 0; k < 3; k++)
        p.lines[p.n_lines][k] = (double)lines[i][k];
    find_extremes(&p);
    for (int i = 0; i < 2 && p.n_points; i++) {
      low_px[i] = n_points && low_px[i] < p.low_px[i] ? low_px[i] : p.low_px[i];
      high_px[i] = n_points && high_px[i] > p.high_px[i] ? high_px[i] : p.high_px[i];
    }
    n_points += p.n_points;
  }
  return n_points > 0;
}
