/* Patches near the eye are divided into cells; cells out of sight are left out, and each other cell is sampled as
 * finely as its nearness needs. */
#include <math.h>

#include "surface/patches/patch_set.h"

enum { CELL_ROWS = 16, DEEPEST_CELL = 22 };

typedef struct descent {
  const conic_patches_view *view;
  const conic_patch *patch;
  int degree;
  double cutoff;
  const conic_grid_samples *to; /* null: samples are only counted */
  size_t n;
} descent;

/* The place (s, t) of a patch, in camera space. */
static void place_on_patch(const descent *d, double s, double t, double p[3]) {
  double height = 0.0, s_power = 1.0, place[3];
  for (int i = 0; i <= d->degree; i++, s_power *= s) {
    double row = 0.0;
    for (int j = d->degree - i; j >= 0; j--)
      row = row * t + (double)d->patch->coefficients[(i + j) * (i + j + 1) / 2 + j];
    height += row * s_power;
  }
  for (int axis = 0; axis < 3; axis++)
    place[axis] = (double)d->patch->center[axis] + s * (double)d->patch->along[axis] +
                  t * (double)d->patch->across[axis] + height * (double)d->patch->normal[axis];
  conic_viewpoint_move(&d->view->from, place, p);
}

static void emit_cell(descent *d, const conic_grid_part *part) {
  if (d->to) {
    conic_grid_samples to = *d->to;
    for (int axis = 0; axis < 3; axis++) {
      to.position[axis] += d->n;
      to.tangent_u[axis] += d->n;
      to.tangent_v[axis] += d->n;
    }
    to.weight += d->n;
    conic_grid_sample(d->patch, d->degree, d->cutoff, part, &to);
  }
  d->n += conic_grid_count(part);
}

/* Samples, or divides further, the cell in `row` and `column` of the 2^depth × 2^depth cells of the patch. */
static void descend(descent *d, int depth, int64_t row, int64_t column) {
  double half = 1.0 / (double)(INT64_C(1) << depth), p[3];
  double s = (double)(2 * column + 1) * half - 1.0, t = (double)(2 * row + 1) * half - 1.0;
  double to_s = fabs(s) > half ? fabs(s) - half : 0.0, to_t = fabs(t) > half ? fabs(t) - half : 0.0;
  if (to_s * to_s + to_t * to_t > 1.0)
    return;
  double slope = (double)d->patch->slope, stretch = (double)d->patch->radius * sqrt(1.0 + slope * slope);
  double step = 2.0 * half / CELL_ROWS;
  double around = 1.001 * stretch * (1.4143 * half + CONIC_SAMPLE_OUTLINE * step);
  place_on_patch(d, s, t, p);
  if (!conic_patches_sees(d->view, p, around))
    return;
  if (depth == DEEPEST_CELL || conic_patch_rows(d->view, d->patch, p, around) * half <= CELL_ROWS) {
    conic_grid_part part = {CELL_ROWS * (INT64_C(1) << depth), CELL_ROWS * row, CELL_ROWS * column, CELL_ROWS,
                            CELL_ROWS};
    emit_cell(d, &part);
    return;
  }
  for (int child = 0; child < 4; child++)
    descend(d, depth + 1, 2 * row + child / 2, 2 * column + child % 2);
}

size_t conic_patch_sample_deep(const conic_patches_view *view, const conic_patch *patch, int degree, double cutoff,
                               const conic_grid_samples *to) {
  descent d = {view, patch, degree, cutoff, to, 0};
  descend(&d, 0, 0, 0);
  return d.n;
}
