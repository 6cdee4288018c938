/* A shape's value at a pixel, and what single precision may make of it. */
#include "oracle/oracle_splat.h"

static double clamp_to(const double range[2], double x) {
  return oracle_min(oracle_max(x, range[0]), range[1]);
}

/* The ray formula's parameters and derivatives at a place of the screen. */
typedef struct ray_parameters {
  double u[2], iz, jacobian[2][2];
  oracle_symmetric spread; /* S = I + h·JJᵀ */
} ray_parameters;

static ray_parameters find_parameters(const oracle_view *view, const oracle_shape *shape, double x, double y) {
  ray_parameters at;
  const double(*rows)[3] = shape->from_screen;
  at.iz = rows[0][2] * x + rows[1][2] * y + rows[2][2];
  for (int i = 0; i < 2; i++) {
    at.u[i] = (rows[0][i] * x + rows[1][i] * y + rows[2][i]) / at.iz;
    for (int j = 0; j < 2; j++)
      at.jacobian[i][j] = (rows[j][i] - at.u[i] * rows[j][2]) / at.iz;
  }
  const double(*jacobian)[2] = (const double(*)[2])at.jacobian;
  double h = view->prefilter;
  at.spread.xx = 1.0 + h * (jacobian[0][0] * jacobian[0][0] + jacobian[0][1] * jacobian[0][1]);
  at.spread.xy = h * (jacobian[0][0] * jacobian[1][0] + jacobian[0][1] * jacobian[1][1]);
  at.spread.yy = 1.0 + h * (jacobian[1][0] * jacobian[1][0] + jacobian[1][1] * jacobian[1][1]);
  return at;
}

/* The kernel's or its profile's value at q, of an ellipse at an offset from its centre. */
static double ellipse_response(const oracle_view *view, const oracle_shape *shape, const double offset[2], double q,
                               double *doubt) {
  double greater = oracle_greater_eigenvalue(shape->variance), pull[2], h = view->prefilter;
  const double share[2] = {h / greater, oracle_min(h * greater / oracle_determinant(shape->variance), 1.0)};
  oracle_apply(shape->inverse, offset, pull);
  double here = oracle_form(shape->inverse, offset), of_filter = h * (pull[0] * pull[0] + pull[1] * pull[1]);
  double n = of_filter - share[0] * here, m = share[1] * here - of_filter;
  double across = here > 0.0 ? n * here / (n + m + share[1] / 4096.0 * here) : 0.0;
  return conic_oracle_response(view, share, conic_oracle_direction(view, share, n, m, here), across, q, doubt);
}

/* The same of a ray at the splat parameter u, by what the filter is at a place. */
static double filtered_response(const oracle_view *view, const ray_parameters *at, const double u[2], double q,
                                double *doubt) {
  oracle_symmetric filter = {at->spread.xx - 1.0, at->spread.xy, at->spread.yy - 1.0};
  double greater = at->iz > 0.0 ? oracle_greater_eigenvalue(filter) : 0.0;
  double lesser = greater > 0.0 ? oracle_max(oracle_determinant(filter), 0.0) / greater : 0.0;
  const double share[2] = {lesser / (1.0 + lesser), greater / (1.0 + greater)};
  double squared = u[0] * u[0] + u[1] * u[1], form = oracle_form(filter, u);
  double n = (1.0 + lesser) * (form - lesser * squared), m = (1.0 + greater) * (greater * squared - form);
  double direction = greater > 0.0 ? conic_oracle_direction(view, share, n, m, squared) : 0.0;
  double apart = (greater - lesser + greater / 4096.0) * (1.0 + greater);
  double across = apart > 0.0 ? (form - lesser * squared) / apart : 0.0;
  return conic_oracle_response(view, share, direction, across, q, doubt);
}

/* By the filter where the pixel looks; if inverse depth changes little, where the splat's pixels are counted from. */
static double ray_response(const oracle_view *view, const oracle_shape *shape, const ray_parameters *at,
                           const double u[2], double q, double *doubt) {
  const double ratio = shape->range[1] / (1.125 * shape->range[0]);
  ray_parameters center = find_parameters(view, shape, shape->center[0], shape->center[1]);
  double value = filtered_response(view, ratio > 1.0 ? at : &center, u, q, doubt);
  if (doubt && fabs(ratio - 1.0) < 1e-5)
    *doubt += fabs(value - filtered_response(view, ratio > 1.0 ? &center : at, u, q, NULL));
  return value;
}

static double gradient_length(const oracle_shape *shape) {
  return sqrt(shape->gradient[0] * shape->gradient[0] + shape->gradient[1] * shape->gradient[1]);
}

static void evaluate_ray(const oracle_view *view, const oracle_shape *shape, double x, double y,
                         double values[ORACLE_N_VALUES]) {
  ray_parameters at = find_parameters(view, shape, x, y);
  double q = oracle_form(oracle_inverse(at.spread), at.u), widened = gradient_length(shape) * view->reach_px;
  values[ORACLE_MARGIN_Q] = view->support - q;
  values[ORACLE_MARGIN_FRONT] = at.iz;
  values[ORACLE_MARGIN_FAR] = at.iz - (shape->range[0] - widened - ORACLE_RANGE_SLACK * shape->range[0]);
  values[ORACLE_MARGIN_NEAR] =
      oracle_min(1.0 / view->near_z, shape->range[1] + widened) + ORACLE_RANGE_SLACK * shape->range[1] - at.iz;
  values[ORACLE_MARGIN_LEFT] = x - shape->box[0][0];
  values[ORACLE_MARGIN_RIGHT] = shape->box[1][0] - x;
  values[ORACLE_MARGIN_TOP] = y - shape->box[0][1];
  values[ORACLE_MARGIN_BOTTOM] = shape->box[1][1] - y;
  values[ORACLE_WEIGHT] = ray_response(view, shape, &at, at.u, q, NULL) / sqrt(oracle_determinant(at.spread));
  values[ORACLE_IZ] = clamp_to(shape->range, at.iz);
  values[ORACLE_IZ_PLANE] = at.iz;
}

/* Whether the place is the disc's, or not far from it, and before the eye: how far u² is from what counts, -1 where it
 * is behind. */
static double within_reach(const oracle_view *view, const ray_parameters *at) {
  double limit = 2.0 * view->cutoff * view->cutoff;
  return at->iz > 0.0 ? limit - at->u[0] * at->u[0] - at->u[1] * at->u[1] : -1.0;
}

/* Half the second derivatives of u² + (y - x)²/h at the place, times h: u = (U, V)/iz has the second derivatives
 * -(J_i g_j + J_j g_i)/iz. */
static oracle_symmetric half_hessian(const oracle_view *view, const oracle_shape *shape, const ray_parameters *at) {
  double steepness[2] = {shape->from_screen[0][2] / at->iz, shape->from_screen[1][2] / at->iz}, n[2][2];
  for (int i = 0; i < 2; i++)
    for (int j = 0; j < 2; j++) {
      n[i][j] = i == j ? 1.0 : 0.0;
      for (int k = 0; k < 2; k++)
        n[i][j] +=
            view->prefilter * (at->jacobian[k][i] * at->jacobian[k][j] -
                               at->u[k] * (at->jacobian[k][i] * steepness[j] + at->jacobian[k][j] * steepness[i]));
    }
  return (oracle_symmetric){n[0][0], n[0][1], n[1][1]};
}

/* The place that the pixel mostly sees, by the Jacobian at p; the pixel's own where that is none. */
static ray_parameters find_pulled(const oracle_view *view, const oracle_shape *shape, double x, double y,
                                  double pull[2]) {
  double offset[2] = {x - shape->center[0], y - shape->center[1]};
  oracle_apply(shape->inverse, offset, pull);
  pull[0] *= view->prefilter;
  pull[1] *= view->prefilter;
  ray_parameters at = find_parameters(view, shape, x - pull[0], y - pull[1]);
  if (within_reach(view, &at) >= 0.0)
    return at;
  pull[0] = pull[1] = 0.0;
  return find_parameters(view, shape, x, y);
}

static void evaluate_laplace(const oracle_view *view, const oracle_shape *shape, double x, double y,
                             double values[ORACLE_N_VALUES]) {
  double pull[2], u[2];
  ray_parameters here = find_parameters(view, shape, x, y), at = find_pulled(view, shape, x, y, pull);
  for (int i = 0; i < 2; i++)
    u[i] = at.u[i] + at.jacobian[i][0] * pull[0] + at.jacobian[i][1] * pull[1];
  double q = oracle_form(oracle_inverse(at.spread), u), plain = oracle_determinant(at.spread);
  if (!(q < view->support) && here.iz > 0.0)
    q = oracle_min(q, here.u[0] * here.u[0] + here.u[1] * here.u[1]);
  double determinant = oracle_max(oracle_determinant(half_hessian(view, shape, &at)), 0.25 * plain);
  values[ORACLE_MARGIN_Q] = view->support - q;
  values[ORACLE_MARGIN_FRONT] = at.iz;
  values[ORACLE_MARGIN_FAR] = values[ORACLE_MARGIN_NEAR] = within_reach(view, &at);
  values[ORACLE_MARGIN_LEFT] = x - shape->box[0][0];
  values[ORACLE_MARGIN_RIGHT] = shape->box[1][0] - x;
  values[ORACLE_MARGIN_TOP] = y - shape->box[0][1];
  values[ORACLE_MARGIN_BOTTOM] = shape->box[1][1] - y;
  values[ORACLE_WEIGHT] = ray_response(view, shape, &at, u, q, NULL) / sqrt(determinant);
  values[ORACLE_IZ] = clamp_to(shape->range, at.iz);
  values[ORACLE_IZ_PLANE] = here.iz;
}

/* The pixel that holds the place; of the four borders the upper and the left one are its own. */
static void evaluate_point(const oracle_view *view, const oracle_shape *shape, double x, double y,
                           double values[ORACLE_N_VALUES]) {
  for (int i = 0; i < ORACLE_N_MARGINS; i++)
    values[i] = 1.0;
  values[ORACLE_MARGIN_Q] = view->support;
  values[ORACLE_MARGIN_LEFT] = shape->center[0] - (x - 0.5);
  values[ORACLE_MARGIN_RIGHT] = (x + 0.5) - shape->center[0];
  values[ORACLE_MARGIN_TOP] = shape->center[1] - (y - 0.5);
  values[ORACLE_MARGIN_BOTTOM] = (y + 0.5) - shape->center[1];
  for (int i = 0; i < ORACLE_N_MARGINS; i++) /* not its own, but in doubt */
    if ((i == ORACLE_MARGIN_RIGHT || i == ORACLE_MARGIN_BOTTOM) && values[i] == 0.0)
      values[i] = -1e-300;
  values[ORACLE_WEIGHT] = 1.0;
  values[ORACLE_IZ] = values[ORACLE_IZ_PLANE] = shape->center_iz;
}

void conic_oracle_evaluate(const oracle_view *view, const oracle_shape *shape, double x, double y,
                           double values[ORACLE_N_VALUES]) {
  const conic_camera *c = &view->camera;
  const double ray[3] = {(x - c->cx) / c->fx, (y - c->cy) / c->fy, 1.0};
  values[ORACLE_RAY_LENGTH] = oracle_length(ray);
  if (shape->formula == ORACLE_RAY) {
    evaluate_ray(view, shape, x, y, values);
    return;
  }
  if (shape->formula == ORACLE_LAPLACE) {
    evaluate_laplace(view, shape, x, y, values);
    return;
  }
  if (shape->formula == ORACLE_POINT) {
    evaluate_point(view, shape, x, y, values);
    return;
  }
  double offset[2] = {x - shape->center[0], y - shape->center[1]};
  double q = oracle_form(shape->inverse, offset);
  for (int i = 0; i < ORACLE_N_MARGINS; i++)
    values[i] = 1.0;
  values[ORACLE_MARGIN_Q] = view->support - q;
  values[ORACLE_WEIGHT] = shape->amplitude * ellipse_response(view, shape, offset, q, NULL);
  values[ORACLE_IZ] =
      clamp_to(shape->range, shape->center_iz + shape->slope[0] * offset[0] + shape->slope[1] * offset[1]);
  values[ORACLE_IZ_PLANE] = shape->center_iz + shape->gradient[0] * offset[0] + shape->gradient[1] * offset[1];
}

/* V is held to a few roundings of its own entries, and so are the pixel's offset and what is summed from them. */
static void round_ellipse(const oracle_shape *shape, double unit, const double offset[2],
                          const double values[ORACLE_N_VALUES], double errors[ORACLE_N_VALUES]) {
  double pull[2];
  oracle_apply(shape->inverse, offset, pull);
  double spread = fabs(pull[0]) * sqrt(shape->variance.xx) + fabs(pull[1]) * sqrt(shape->variance.yy);
  errors[ORACLE_MARGIN_Q] = unit * (spread * spread + fabs(pull[0] * offset[0]) + fabs(pull[1] * offset[1]));
  errors[ORACLE_IZ] = unit * (shape->center_iz + fabs(shape->slope[0] * offset[0]) + fabs(shape->slope[1] * offset[1]));
  errors[ORACLE_IZ_PLANE] =
      unit * (shape->center_iz + fabs(shape->gradient[0] * offset[0]) + fabs(shape->gradient[1] * offset[1]));
  errors[ORACLE_WEIGHT] = values[ORACLE_WEIGHT] * unit;
}

/* U, V and iz are sums over the offset from the splat's place, each rounded; J and S follow from them. */
static void round_ray(const oracle_view *view, const oracle_shape *shape, double x, double y,
                      const double values[ORACLE_N_VALUES], double errors[ORACLE_N_VALUES]) {
  const double unit = view->floats.unit;
  const double(*rows)[3] = shape->from_screen;
  double moved[2] = {0.0, 0.0};
  ray_parameters at =
      shape->formula == ORACLE_LAPLACE ? find_pulled(view, shape, x, y, moved) : find_parameters(view, shape, x, y);
  double reach_x = fabs(x - shape->center[0]), reach_y = fabs(y - shape->center[1]);
  double sums[3], u[2], pull[2], error = 0.0, within_error = 0.0;
  for (int i = 0; i < 3; i++)
    sums[i] = fabs(rows[0][i]) * reach_x + fabs(rows[1][i]) * reach_y + (i < 2 ? fabs(at.u[i] * at.iz) : fabs(at.iz));
  for (int i = 0; i < 2; i++)
    u[i] = at.u[i] + at.jacobian[i][0] * moved[0] + at.jacobian[i][1] * moved[1];
  oracle_apply(oracle_inverse(at.spread), u, pull);
  for (int i = 0; i < 2; i++) {
    double u_error = (sums[i] + fabs(at.u[i]) * sums[2]) / fabs(at.iz);
    within_error += 2.0 * unit * fabs(at.u[i]) * u_error;
    u_error += fabs(at.jacobian[i][0] * moved[0]) + fabs(at.jacobian[i][1] * moved[1]);
    error += 2.0 * fabs(pull[i]) * u_error;
  }
  double spread = fabs(pull[0]) * sqrt(at.spread.xx) + fabs(pull[1]) * sqrt(at.spread.yy);
  errors[ORACLE_MARGIN_Q] = unit * (error + 2.0 * spread * spread * (1.0 + sums[2] / fabs(at.iz)));
  for (int i = ORACLE_MARGIN_FRONT; i <= ORACLE_MARGIN_NEAR; i++)
    errors[i] = unit * (sums[2] + gradient_length(shape) * view->reach_px);
  if (shape->formula == ORACLE_LAPLACE)
    errors[ORACLE_MARGIN_FAR] = errors[ORACLE_MARGIN_NEAR] = within_error;
  for (int i = ORACLE_MARGIN_LEFT; i <= ORACLE_MARGIN_BOTTOM; i++)
    errors[i] = unit * (reach_x + reach_y);
  errors[ORACLE_IZ] = errors[ORACLE_IZ_PLANE] = unit * sums[2];
  errors[ORACLE_WEIGHT] = values[ORACLE_WEIGHT] * unit * (1.0 + 2.0 * sums[2] / fabs(at.iz));
}

/* What the weight at a place would be, but for its amplitude, if q were another. */
static double response_at(const oracle_view *view, const oracle_shape *shape, double x, double y, double q,
                          double *doubt) {
  double offset[2] = {x - shape->center[0], y - shape->center[1]}, pull[2] = {0.0, 0.0};
  *doubt = 0.0;
  if (!view->profile)
    return conic_oracle_kernel(&view->kernel, q);
  if (shape->formula != ORACLE_RAY && shape->formula != ORACLE_LAPLACE)
    return ellipse_response(view, shape, offset, q, doubt);
  ray_parameters at =
      shape->formula == ORACLE_LAPLACE ? find_pulled(view, shape, x, y, pull) : find_parameters(view, shape, x, y);
  const double u[2] = {at.u[0] + at.jacobian[0][0] * pull[0] + at.jacobian[0][1] * pull[1],
                       at.u[1] + at.jacobian[1][0] * pull[0] + at.jacobian[1][1] * pull[1]};
  return ray_response(view, shape, &at, u, q, doubt);
}

void conic_oracle_rounding(const oracle_view *view, const oracle_shape *shape, double x, double y,
                           const double values[ORACLE_N_VALUES], double errors[ORACLE_N_VALUES]) {
  for (int i = 0; i < ORACLE_N_VALUES; i++)
    errors[i] = 0.0;
  if (shape->formula == ORACLE_RAY || shape->formula == ORACLE_LAPLACE)
    round_ray(view, shape, x, y, values, errors);
  else if (shape->formula == ORACLE_POINT) {
    /* The place is formed in double. */
    double position =
        1e-14 * (fabs(shape->center[0]) + fabs(shape->center[1]) + fabs(view->camera.cx) + fabs(view->camera.cy));
    for (int i = ORACLE_MARGIN_LEFT; i <= ORACLE_MARGIN_BOTTOM; i++)
      errors[i] = position;
    errors[ORACLE_IZ] = errors[ORACLE_IZ_PLANE] = ORACLE_UNIT * shape->center_iz;
  } else {
    double offset[2] = {x - shape->center[0], y - shape->center[1]};
    round_ellipse(shape, view->floats.unit, offset, values, errors);
  }
  /* What is wrong in q is wrong in the kernel's value. */
  double q = view->support - values[ORACLE_MARGIN_Q], doubt, other_doubt,
         here = response_at(view, shape, x, y, q, &doubt);
  double change = here - response_at(view, shape, x, y, q + errors[ORACLE_MARGIN_Q], &other_doubt);
  if (here > 0.0)
    errors[ORACLE_WEIGHT] += values[ORACLE_WEIGHT] * (fabs(change / here) + doubt / here);
  errors[ORACLE_WEIGHT] += values[ORACLE_WEIGHT] * view->floats.kernel;
}
