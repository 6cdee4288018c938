/* From what a Gaussian is at the pixels back to its parameters and the camera's: the set-up of oracle_gaussian.c, step
 * by step in reverse. Of a clamp the derivative is that of the side it is on, and at its border that of the inside, as
 * automatic differentiation has it. */

#include "oracle/gaussians/oracle_gradient.h"
#include "oracle/oracle_math.h"

/* What the set-up of an ellipse has on the way. */
typedef struct ellipse_steps {
  double focal[2], slope[2], rows[2][3], area[3], before, after;
  double by_focal[2], by_center[2]; /* how a slope at its border changes with these */
  int is_inside[2], is_near_border[2];
} ellipse_steps;

/* Derivatives by what is in camera space. */
typedef struct space_gradient {
  double mean[3], unit[3][3], scale[3], opacity, focal[2], center[2];
} space_gradient;

static void add_multiple(double to[3], double factor, const double from[3]) {
  for (int k = 0; k < 3; k++)
    to[k] += factor * from[k];
}

static void find_slope_again(const oracle_gaussian_view *view, const oracle_gaussian *g, const conic_float_model *model,
                             int axis, ellipse_steps *s) {
  const double f = s->focal[axis], size = axis ? view->camera->height : view->camera->width;
  const double half = 0.5 * size / f, c = view->center_px[axis], slope = g->mean[axis] / g->mean[2];
  const double beyond = view->rules->slope_margin * half;
  double low = -INFINITY, high = INFINITY;
  if (beyond >= 0.0) {
    low = -(c / f + beyond);
    high = (size - c) / f + beyond;
  }
  s->slope[axis] = oracle_min(oracle_max(slope, low), high);
  s->is_inside[axis] = slope >= low && slope <= high;
  s->by_focal[axis] = s->is_inside[axis] ? 0.0 : -s->slope[axis] / f;
  s->by_center[axis] = s->is_inside[axis] || view->rules->takes_middle ? 0.0 : -1.0 / f;
  double off = model ? 16.0 * model->setup_roundoff * (1.0 + fabs(slope)) : 0.0;
  s->is_near_border[axis] = fabs(slope - low) <= off || fabs(slope - high) <= off;
}

static void step_ellipse(const oracle_gaussian_view *view, const oracle_gaussian *g, const conic_float_model *model,
                         ellipse_steps *s) {
  const double d = view->rules->dilation;
  s->focal[0] = view->camera->fx;
  s->focal[1] = view->camera->fy;
  for (int axis = 0; axis < 2; axis++) {
    find_slope_again(view, g, model, axis, s);
    for (int k = 0; k < 3; k++)
      s->rows[axis][k] = s->focal[axis] / g->mean[2] * (g->axes[k][axis] - s->slope[axis] * g->axes[k][2]);
  }
  oracle_cross(s->rows[0], s->rows[1], s->area);
  s->before = oracle_dot(s->area, s->area);
  s->after = s->before + d * (oracle_dot(s->rows[0], s->rows[0]) + oracle_dot(s->rows[1], s->rows[1])) + d * d;
}

/* |a × b|² grows along a by 2·b × (a × b). */
static void add_area(const ellipse_steps *s, double by_area, double rows[2][3]) {
  double along[3];
  oracle_cross(s->rows[1], s->area, along);
  add_multiple(rows[0], 2.0 * by_area, along);
  oracle_cross(s->area, s->rows[0], along);
  add_multiple(rows[1], 2.0 * by_area, along);
}

/* The opacity is multiplied by √max(least, before/after). */
static void compensate_back(const oracle_gaussian_view *view, const ellipse_steps *s, double opacity,
                            const conic_float_model *model, double by_opacity, double rows[2][3], space_gradient *to,
                            uint32_t *doubts) {
  const double least = view->rules->compensation_least, ratio = s->before / s->after;
  to->opacity = by_opacity;
  if (!(least >= 0.0))
    return;
  const double share = sqrt(oracle_max(least, ratio)), d = view->rules->dilation;
  to->opacity = by_opacity * share;
  double size = oracle_dot(s->rows[0], s->rows[0]) * oracle_dot(s->rows[1], s->rows[1]) / s->after;
  if (model && fabs(ratio - least) <= 64.0 * model->setup_roundoff * (model->is_setup_in_float ? size : ratio))
    *doubts |= 1u << CONIC_DOUBT_COMPENSATION;
  if (ratio < least || !(share > 0.0))
    return;
  double by_ratio = 0.5 * by_opacity * opacity / share, by_after = -by_ratio * ratio / s->after;
  add_area(s, by_ratio / s->after + by_after, rows);
  for (int axis = 0; axis < 2; axis++)
    add_multiple(rows[axis], 2.0 * d * by_after, s->rows[axis]);
}

/* The form is the inverse of the covariance: by the latter, it is −form·(…)·form. */
static void invert_back(const oracle_gaussian *g, const ellipse_steps *s, const double by_form[3], double rows[2][3]) {
  const double f[2][2] = {{g->form[0], g->form[1]}, {g->form[1], g->form[2]}};
  const double by[2][2] = {{by_form[0], 0.5 * by_form[1]}, {0.5 * by_form[1], by_form[2]}};
  double c[2][2];
  for (int i = 0; i < 2; i++)
    for (int j = 0; j < 2; j++) {
      c[i][j] = 0.0;
      for (int k = 0; k < 2; k++)
        for (int l = 0; l < 2; l++)
          c[i][j] -= f[i][k] * by[k][l] * f[l][j];
    }
  for (int i = 0; i < 2; i++) /* of a·a, a·b and b·b */
    for (int j = 0; j < 2; j++)
      add_multiple(rows[i], c[i][j] + c[j][i], s->rows[j]);
}

/* Row a of J·V·R·S is f/z·(A_a − slope·A_z), A its axes. */
static void project_back(const oracle_gaussian *g, const ellipse_steps *s, const double *sums, double rows[2][3],
                         space_gradient *to) {
  const double z = g->mean[2];
  for (int axis = 0; axis < 2; axis++) {
    const double f = s->focal[axis], own = oracle_dot(rows[axis], s->rows[axis]), by_place = sums[BY_PLACE + axis];
    double by_slope = 0.0;
    for (int k = 0; k < 3; k++) {
      double by_axis[3] = {0.0, 0.0, 0.0};
      by_axis[axis] = f / z * rows[axis][k];
      by_axis[2] = -by_axis[axis] * s->slope[axis];
      by_slope -= by_axis[axis] * g->axes[k][2];
      to->scale[k] += oracle_dot(by_axis, g->unit[k]);
      add_multiple(to->unit[k], g->scale[k], by_axis);
    }
    to->focal[axis] += own / f + by_slope * s->by_focal[axis] + by_place * g->mean[axis] / z;
    to->center[axis] += by_place + by_slope * s->by_center[axis];
    double by_ratio = by_place * f + (s->is_inside[axis] ? by_slope : 0.0);
    to->mean[axis] += by_ratio / z;
    to->mean[2] -= own / z + by_ratio * g->mean[axis] / z / z;
  }
  to->mean[2] += sums[BY_Z];
}

static void ellipse_back(const oracle_gaussian_view *view, const oracle_gaussian *g, double opacity,
                         const conic_float_model *model, const double *sums, space_gradient *to, uint32_t *doubts) {
  ellipse_steps s;
  double rows[2][3] = {{0.0}};
  step_ellipse(view, g, model, &s);
  compensate_back(view, &s, opacity, model, sums[BY_OPACITY], rows, to, doubts);
  invert_back(g, &s, sums + BY_FORM, rows);
  project_back(g, &s, sums, rows, to);
  if (s.is_near_border[0] || s.is_near_border[1])
    *doubts |= 1u << CONIC_DOUBT_SLOPE;
}

/* Row k of the map to the unit ball is unit_k / s_k, the mean there that times p, and a ray d = ((x − cx)/fx, (y −
 * cy)/fy, 1) becomes that times d; what is summed up by the rows is dL/d(row·d)·d. */
static void ray_back(const oracle_gaussian_view *view, const oracle_gaussian *g, const double *sums,
                     space_gradient *to) {
  const double focal[2] = {view->camera->fx, view->camera->fy};
  const int is_flat = g->is_flat || g->scale[2] == 0.0;
  to->opacity = sums[BY_OPACITY];
  for (int k = 0; k < 3; k++) {
    const double *by_ray = sums + BY_BALL + (size_t)k * 3, by_middle = sums[BY_MIDDLE + k];
    const double scale = is_flat && k == 2 ? 1.0 : g->scale[k];
    double by_row[3];
    for (int axis = 0; axis < 3; axis++)
      by_row[axis] = by_ray[axis] + by_middle * g->mean[axis];
    add_multiple(to->mean, by_middle / scale, g->unit[k]);
    add_multiple(to->unit[k], 1.0 / scale, by_row);
    if (!(is_flat && k == 2))
      to->scale[k] -= oracle_dot(by_row, g->unit[k]) / scale / scale;
    for (int axis = 0; axis < 2; axis++) {
      to->focal[axis] -= g->unit[k][axis] / scale * by_ray[axis] / focal[axis];
      to->center[axis] -= g->unit[k][axis] / scale * by_ray[2] / focal[axis];
    }
  }
}

static void quaternion_back(const double q[4], double length, const double by[3][3], double free[4], double to[4]) {
  const double w = q[0], x = q[1], y = q[2], z = q[3];
  const double skew[3] = {by[2][1] - by[1][2], by[0][2] - by[2][0], by[1][0] - by[0][1]};
  const double both[3] = {by[2][1] + by[1][2], by[0][2] + by[2][0], by[1][0] + by[0][1]};
  double along = 0.0, square = 0.0;
  to[0] = 2.0 * (x * skew[0] + y * skew[1] + z * skew[2]);
  to[1] = 2.0 * (w * skew[0] + y * both[2] + z * both[1] - 2.0 * x * (by[1][1] + by[2][2]));
  to[2] = 2.0 * (w * skew[1] + x * both[2] + z * both[0] - 2.0 * y * (by[0][0] + by[2][2]));
  to[3] = 2.0 * (w * skew[2] + x * both[1] + y * both[0] - 2.0 * z * (by[0][0] + by[1][1]));
  for (int k = 0; k < 4; k++) {
    along += to[k] * q[k];
    square += q[k] * q[k];
  }
  memcpy(free, to, 4 * sizeof *to);
  for (int k = 0; k < 4; k++) /* its length does not matter */
    to[k] = (to[k] - along / square * q[k]) / length;
}

/* From camera space to the world. */
static void turn_back(const oracle_gaussian_view *view, const conic_gaussians *set, size_t i, const double mean[3],
                      const space_gradient *from, oracle_parameters *to, oracle_camera_gradient *camera) {
  double q[4], world[3][3], by_world[3][3] = {{0.0}};
  double length = conic_oracle_quaternion(view->rules, set, i, q);
  conic_oracle_rotation(q, world);
  for (int row = 0; row < 3; row++) {
    const double *v = view->camera->cam_from_world[row];
    for (int j = 0; j < 3; j++) {
      to->mean[j] += v[j] * from->mean[row];
      camera->cam_from_world[row][j] += from->mean[row] * mean[j];
      for (int k = 0; k < 3; k++) {
        by_world[j][k] += v[j] * from->unit[k][row];
        camera->cam_from_world[row][j] += from->unit[k][row] * world[j][k];
      }
    }
    camera->cam_from_world[row][3] += from->mean[row];
  }
  quaternion_back(q, length, by_world, to->turn, to->rotation);
}

/* Whether rounding decides if a channel of the colour is above 0. `size` is the sum of its terms' absolute values. */
static int is_clamp_in_doubt(const conic_float_model *model, double sum, double size) {
  return model && fabs(sum) <= (16.0 * model->setup_roundoff + 24.0 * 0x1p-24) * size;
}

/* The colour max(0, ½ + Σ sh·Y(direction)). The eye is −R⁻¹t, so that R·(its change) is −(change of t + change of R ·
 * eye). */
static void color_back(const oracle_gaussian_view *view, const oracle_eye *eye, const conic_gaussians *set, size_t i,
                       const double mean[3], const conic_float_model *model, const double by_color[3],
                       oracle_parameters *to, oracle_camera_gradient *camera) {
  enum { MOST = (CONIC_MAX_SH_DEGREE + 1) * (CONIC_MAX_SH_DEGREE + 1) };
  const int n = (set->sh_degree + 1) * (set->sh_degree + 1);
  double sh[3 * MOST], y[MOST], slopes[MOST][3], by[3], direction[3], by_direction[3] = {0.0, 0.0, 0.0};
  for (int axis = 0; axis < 3; axis++)
    direction[axis] = mean[axis] - view->eye[axis];
  const double length = oracle_length(direction);
  for (int axis = 0; axis < 3; axis++)
    direction[axis] = length > 0.0 ? direction[axis] / length : 0.0;
  conic_oracle_harmonics_of(set, i, sh);
  conic_oracle_harmonic_values(set->sh_degree, direction, y);
  conic_oracle_harmonic_slopes(set->sh_degree, direction, slopes);
  for (int c = 0; c < 3; c++) {
    double sum = 0.0, size = 0.5;
    for (int k = 0; k < n; k++) {
      sum += y[k] * sh[3 * k + c];
      size += fabs(y[k] * sh[3 * k + c]);
    }
    by[c] = sum + 0.5 >= 0.0 ? by_color[c] : 0.0;
    if (is_clamp_in_doubt(model, sum + 0.5, size))
      to->doubts |= 1u << CONIC_DOUBT_COLOR;
  }
  for (int k = 0; k < n; k++)
    for (int c = 0; c < 3; c++) {
      to->sh[3 * k + c] = by[c] * y[k];
      add_multiple(by_direction, by[c] * sh[3 * k + c], slopes[k]);
    }
  if (!(length > 0.0))
    return;
  const double along = oracle_dot(by_direction, direction);
  for (int axis = 0; axis < 3; axis++) {
    by_direction[axis] = (by_direction[axis] - along * direction[axis]) / length;
    to->mean[axis] += by_direction[axis];
  }
  for (int row = 0; row < 3; row++) {
    double turned = 0.0;
    for (int axis = 0; axis < 3; axis++)
      turned += eye->inverse[axis][row] * by_direction[axis];
    add_multiple(camera->cam_from_world[row], turned, eye->place);
    camera->cam_from_world[row][3] += turned;
  }
}

void conic_oracle_gradient_chain(const oracle_gaussian_view *view, const oracle_eye *eye, const conic_gaussians *set,
                                 size_t i, const conic_float_model *model, const double *form, const double *sums,
                                 oracle_parameters *to, oracle_camera_gradient *camera) {
  oracle_gaussian g;
  space_gradient space = {0};
  double mean[3];
  memset(to, 0, sizeof *to);
  conic_oracle_gaussian_place(view, set, i, &g);
  if (form)
    memcpy(g.form, form, sizeof g.form);
  for (int axis = 0; axis < 3; axis++)
    mean[axis] = set->origin[axis] + (double)set->position[axis][i];
  if (view->rules->shape == CONIC_SHAPE_RAY)
    ray_back(view, &g, sums, &space);
  else
    ellipse_back(view, &g, (double)set->opacity[i], model, sums, &space, &to->doubts);
  turn_back(view, set, i, mean, &space, to, camera);
  color_back(view, eye, set, i, mean, model, sums + BY_COLOR, to, camera);
  memcpy(to->scale, space.scale, sizeof to->scale);
  to->opacity = space.opacity;
  for (int axis = 0; axis < 2; axis++) {
    camera->focal[axis] += space.focal[axis];
    camera->center[axis] += view->rules->takes_middle ? 0.0 : space.center[axis];
  }
}
