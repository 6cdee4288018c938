#include "oracle/gaussians/oracle_coverage.h"

/* Pixels from tile `first` to before tile `behind`, with the least and greatest that each may be. */
static void admit_tiles(const oracle_doubting *d, int axis, const double first[2], const double behind[2],
                        oracle_uncertain *g) {
  const double tile = conic_profile_tile(d->view->rules, d->view->camera);
  const double size = axis ? d->view->camera->height : d->view->camera->width, most = ceil(size / tile);
  double tiles[4] = {first[0], first[1], behind[0], behind[1]};
  for (int k = 0; k < 4; k++)
    tiles[k] = tile * oracle_min(oracle_max(floor(tiles[k] / tile), 0.0), most);
  g->wide[0][axis] = tiles[0];
  g->sure[0][axis] = tiles[1];
  g->sure[1][axis] = tiles[2];
  g->wide[1][axis] = tiles[3];
}

void conic_oracle_admit_square(const oracle_doubting *d, bounded radius, oracle_uncertain *g) {
  double least = ceil(bounded_low(radius)), most = ceil(bounded_high(radius));
  for (int axis = 0; axis < 2; axis++) {
    double low = bounded_low(g->place[axis]) - 0.5, high = bounded_high(g->place[axis]) - 0.5;
    double ulp = d->model->is_setup_in_float ? 2e-7 * (fabs(low) + most + 16.0) : 1e-13 * (fabs(low) + most);
    const double first[2] = {low - most - ulp, high - least + ulp};
    const double behind[2] = {low + least + 15.0 - ulp, high + most + 15.0 + ulp};
    admit_tiles(d, axis, first, behind, g);
  }
}

void conic_oracle_admit_box(const oracle_doubting *d, const bounded radius[2], oracle_uncertain *g) {
  for (int axis = 0; axis < 2; axis++) {
    double least = ceil(bounded_low(radius[axis])), most = ceil(bounded_high(radius[axis]));
    double low = bounded_low(g->place[axis]), high = bounded_high(g->place[axis]);
    double ulp = d->model->is_setup_in_float ? 2e-7 * (fabs(low) + most + 16.0) : 2e-9;
    const double first[2] = {low - most - ulp, high - least + ulp};
    const double tile = conic_profile_tile(d->view->rules, d->view->camera);
    const double behind[2] = {low + least + tile - ulp, high + most + tile + ulp};
    admit_tiles(d, axis, first, behind, g);
    double size = axis ? d->view->camera->height : d->view->camera->width; /* beside the picture, it is culled */
    if (high + most + ulp <= 0.0 || low - most - ulp >= size)
      g->wide[1][axis] = -INFINITY;
    if (low + least - ulp <= 0.0 || high - least + ulp >= size)
      g->sure[1][axis] = -INFINITY;
  }
}

double conic_oracle_reach_in_q(const oracle_doubting *d, bounded opacity) {
  double most = bounded_high(opacity);
  if (d->limits.half_cutoff > 0.0)
    return 2.0 * d->limits.half_cutoff + 0.01;
  if (!oracle_is_finite(most)) /* no file has it */
    most = 1e30;
  return most * 1.001 >= d->limits.alpha_least ? 2.0 * conic_oracle_log(most * 1.001 / d->limits.alpha_least) + 0.01
                                               : -1.0;
}

void conic_oracle_reach_everywhere(oracle_uncertain *g) {
  for (int axis = 0; axis < 2; axis++) {
    g->reach[0][axis] = -INFINITY;
    g->reach[1][axis] = INFINITY;
  }
}

/* Of a form that may be anything, q may be, too, however far away. But every program looks at a box alone, or at the
 * tiles of 16 pixels that it meets, and the variances are known. */
void conic_oracle_reach_of_ellipse(const bounded variance[2], double q, oracle_uncertain *g) {
  const int is_known = bounded_is_finite(g->form[0]) && bounded_is_finite(g->form[1]) && bounded_is_finite(g->form[2]);
  for (int axis = 0; axis < 2; axis++) {
    double half = sqrt(q * bounded_high(variance[axis])) + ORACLE_REACH_MARGIN_PX;
    half += half * 1e-3 + g->place[axis].off + (is_known ? 0.0 : 16.0);
    g->reach[0][axis] = g->place[axis].v - half;
    g->reach[1][axis] = g->place[axis].v + half;
  }
}
