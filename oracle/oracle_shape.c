/* The formulas themselves: a splat's set-up, and its value at a pixel. */
#include "oracle/oracle_splat.h"

/* The projection, linearised where it takes the splat's centre: the columns of a 2 × 3 matrix. */
static void project_axis(const conic_camera *c, const double p[3], const double axis[3], double result[2]) {
  result[0] = c->fx * (axis[0] / p[2] - p[0] * axis[2] / (p[2] * p[2]));
  result[1] = c->fy * (axis[1] / p[2] - p[1] * axis[2] / (p[2] * p[2]));
}

/* The ellipse that has D = t_u t_uᵀ + t_v t_vᵀ − p pᵀ/F² as its dual conic, seen from the pixel that p projects to. A
 * dual conic [[A, a], [aᵀ, d]] has its centre at a/d, and a aᵀ/d² − A/d is its shape; the ellipse of one standard
 * deviation is smaller by F. The triple of an axis is the homogeneous place it projects to, relative to p's. */
static void outline(const oracle_view *view, const oracle_placed *s, double offset[2], oracle_symmetric *variance) {
  const double f = view->cutoff;
  const double *axes[2] = {s->tu, s->tv};
  double a[2] = {0.0, 0.0}, d = -s->p[2] * s->p[2] / (f * f);
  oracle_symmetric block = {0.0, 0.0, 0.0};
  for (int i = 0; i < 2; i++) {
    double t[2], z = axes[i][2];
    project_axis(&view->camera, s->p, axes[i], t);
    double x = t[0] * s->p[2], y = t[1] * s->p[2];
    block.xx += x * x;
    block.xy += x * y;
    block.yy += y * y;
    a[0] += x * z;
    a[1] += y * z;
    d += z * z;
  }
  offset[0] = a[0] / d;
  offset[1] = a[1] / d;
  variance->xx = (offset[0] * offset[0] - block.xx / d) / (f * f);
  variance->xy = (offset[0] * offset[1] - block.xy / d) / (f * f);
  variance->yy = (offset[1] * offset[1] - block.yy / d) / (f * f);
}

/* The normal of the plane, and the gradient of its inverse depth, n·d/(n·p) at the ray d. */
static int plane_gradient(const oracle_view *view, const oracle_placed *s, double gradient[2]) {
  double normal[3];
  oracle_cross(s->tu, s->tv, normal);
  double distance = oracle_dot(normal, s->p);
  gradient[0] = normal[0] / view->camera.fx / distance;
  gradient[1] = normal[1] / view->camera.fy / distance;
  if (oracle_is_finite(gradient[0]) && oracle_is_finite(gradient[1]))
    return fabs(distance) > 1e-6 * oracle_length(normal) * oracle_length(s->p);
  gradient[0] = gradient[1] = 0.0;
  return 0;
}

static void widen(const oracle_view *view, oracle_shape *shape) {
  shape->variance.xx += view->prefilter;
  shape->variance.yy += view->prefilter;
  shape->inverse = oracle_inverse(shape->variance);
  double half[2] = {view->cutoff * sqrt(shape->variance.xx), view->cutoff * sqrt(shape->variance.yy)};
  for (int i = 0; i < 2; i++) {
    shape->box[0][i] = shape->center[i] - half[i];
    shape->box[1][i] = shape->center[i] + half[i];
  }
}

/* What conic and affine have in common once the variance R′ and the offset of the centre from p's place are known.
 * R′g is taken literally where the plane has a good gradient; else from the centre's offset: see
 * docs/reference/oracle.md. */
static void set_ellipse(const oracle_view *view, const oracle_placed *s, double root, const double r_g[2],
                        const double offset[2], oracle_shape *shape) {
  const conic_camera *c = &view->camera;
  double shrunk[2];
  shape->center[0] = c->fx * s->p[0] / s->p[2] + c->cx + offset[0];
  shape->center[1] = c->fy * s->p[1] / s->p[2] + c->cy + offset[1];
  if (plane_gradient(view, s, shape->gradient)) {
    oracle_apply(shape->variance, shape->gradient, shrunk);
    shape->center_iz = 1.0 / s->p[2] + shape->gradient[0] * offset[0] + shape->gradient[1] * offset[1];
  } else {
    shrunk[0] = r_g[0];
    shrunk[1] = r_g[1];
  }
  widen(view, shape);
  oracle_apply(shape->inverse, shrunk, shape->slope);
  shape->amplitude = root / sqrt(oracle_determinant(shape->variance));
}

static void set_conic(const oracle_view *view, const oracle_placed *s, double facing, oracle_shape *shape) {
  double offset[2], f = view->cutoff, h_z = sqrt(s->tu[2] * s->tu[2] + s->tv[2] * s->tv[2]);
  double between = (s->p[2] - f * h_z) * (s->p[2] + f * h_z);
  outline(view, s, offset, &shape->variance);
  shape->center_iz = s->p[2] / between;
  /* The plane's vanishing line is the polar of p's place, so that R′g = iz(x_t)·(x_t − x_p)/F². */
  double r_g[2] = {shape->center_iz * offset[0] / (f * f), shape->center_iz * offset[1] / (f * f)};
  double root = view->camera.fx * view->camera.fy * fabs(facing) / (between * sqrt(between));
  set_ellipse(view, s, root, r_g, offset, shape);
}

/* The axes on the screen, and their products with themselves added to the variance. */
static void add_axes(const oracle_view *view, const oracle_placed *s, double t[2][2], oracle_shape *shape) {
  for (int i = 0; i < 2; i++) {
    project_axis(&view->camera, s->p, i ? s->tv : s->tu, t[i]);
    shape->variance.xx += t[i][0] * t[i][0];
    shape->variance.xy += t[i][0] * t[i][1];
    shape->variance.yy += t[i][1] * t[i][1];
  }
}

static void set_affine(const oracle_view *view, const oracle_placed *s, double facing, oracle_shape *shape) {
  double t[2][2], r_g[2], offset[2] = {0.0, 0.0}, z = s->p[2];
  shape->variance = (oracle_symmetric){0.0, 0.0, 0.0};
  add_axes(view, s, t, shape);
  /* Along an axis the inverse depth falls by t_z/p_z², which is t·g. */
  for (int k = 0; k < 2; k++)
    r_g[k] = 0.0 - t[0][k] * s->tu[2] / (z * z) - t[1][k] * s->tv[2] / (z * z);
  shape->center_iz = 1.0 / z;
  double root = view->camera.fx * view->camera.fy * fabs(facing) / (z * z * z);
  set_ellipse(view, s, root, r_g, offset, shape);
}

/* A circle about the place that p projects to, at p's depth, and its box; a point's radius is only what it takes along
 * to be measured by. */
static int set_dot(const oracle_view *view, const oracle_placed *s, oracle_shape *shape) {
  const conic_camera *c = &view->camera;
  double longer = oracle_max(oracle_length(s->tu), oracle_length(s->tv));
  double radius = oracle_max(0.5, view->cutoff * longer * sqrt(c->fx * c->fy) / s->p[2]);
  if (shape->formula == ORACLE_POINT)
    radius = 0.5;
  double variance = radius * radius / (view->cutoff * view->cutoff);
  shape->center[0] = c->fx * s->p[0] / s->p[2] + c->cx;
  shape->center[1] = c->fy * s->p[1] / s->p[2] + c->cy;
  shape->center_iz = shape->range[0] = shape->range[1] = 1.0 / s->p[2];
  shape->variance = (oracle_symmetric){variance, 0.0, variance};
  shape->inverse = oracle_inverse(shape->variance);
  shape->amplitude = 1.0;
  for (int i = 0; i < 2; i++) {
    shape->box[0][i] = shape->center[i] - radius;
    shape->box[1][i] = shape->center[i] + radius;
  }
  return 1;
}

int conic_oracle_is_before_near(const oracle_view *view, const oracle_placed *s) {
  return s->p[2] - view->cutoff * sqrt(s->tu[2] * s->tu[2] + s->tv[2] * s->tv[2]) > view->near_z;
}

/* Pixels are counted from p's place. Where the disc reaches near, they are counted from the middle of the part of the
 * box that lies in the picture. */
static void set_ray_reference(const oracle_view *view, const oracle_placed *s, oracle_shape *shape) {
  const conic_camera *c = &view->camera;
  const double size[2] = {c->width, c->height}, focal[2] = {c->fx, c->fy}, principal[2] = {c->cx, c->cy};
  for (int i = 0; i < 2; i++) {
    double first = oracle_max(ceil(shape->box[0][i] - 0.5), 0.0);
    double last = oracle_min(floor(shape->box[1][i] - 0.5), size[i] - 1.0);
    shape->center[i] = conic_oracle_is_before_near(view, s) ? focal[i] * s->p[i] / s->p[2] + principal[i]
                                                            : floor(0.5 * (first + last + 1.0)) + 0.5;
  }
}

static int set_ray(const oracle_view *view, const oracle_placed *s, oracle_shape *shape) {
  const conic_camera *c = &view->camera;
  const double matrix[3][3] = {
      {s->tu[0], s->tu[1], s->tu[2]}, {s->tv[0], s->tv[1], s->tv[2]}, {s->p[0], s->p[1], s->p[2]}};
  static const double directions[2][2] = {{1.0, 0.0}, {0.0, 1.0}};
  double inverse[3][3];
  if (!conic_oracle_invert(matrix, inverse))
    return 0;
  for (int i = 0; i < 3; i++) {
    shape->from_screen[0][i] = inverse[0][i] / c->fx;
    shape->from_screen[1][i] = inverse[1][i] / c->fy;
    shape->from_screen[2][i] = inverse[2][i] - c->cx * shape->from_screen[0][i] - c->cy * shape->from_screen[1][i];
  }
  shape->gradient[0] = shape->from_screen[0][2];
  shape->gradient[1] = shape->from_screen[1][2];
  for (int i = 0; i < 2; i++) {
    oracle_extreme extremes[2];
    if (!conic_oracle_extremes(view, s, directions[i], extremes))
      return 0;
    shape->box[0][i] = extremes[0].along - view->reach_px;
    shape->box[1][i] = extremes[1].along + view->reach_px;
  }
  set_ray_reference(view, s, shape);
  return 1;
}

/* A ray that counts its pixels from p's place, with the variance that the Jacobian there gives. */
static int set_laplace(const oracle_view *view, const oracle_placed *s, oracle_shape *shape) {
  double t[2][2];
  if (!set_ray(view, s, shape))
    return 0;
  shape->variance = (oracle_symmetric){view->prefilter, 0.0, view->prefilter};
  add_axes(view, s, t, shape);
  shape->inverse = oracle_inverse(shape->variance);
  return 1;
}

/* The trace of the plane on the screen is the line n·d = 0. */
static int set_segment(const oracle_view *view, const oracle_placed *s, oracle_shape *shape) {
  double normal[3], f = view->cutoff;
  oracle_extreme ends[2];
  oracle_cross(s->tu, s->tv, normal);
  double across[2] = {normal[0] / view->camera.fx, normal[1] / view->camera.fy};
  double steepness = sqrt(across[0] * across[0] + across[1] * across[1]);
  double trace[2] = {-across[1] / steepness, across[0] / steepness};
  if (!(steepness > 0.0) || !conic_oracle_extremes(view, s, trace, ends))
    return 0;
  double e[2] = {ends[1].place[0] - ends[0].place[0], ends[1].place[1] - ends[0].place[1]};
  double length = sqrt(e[0] * e[0] + e[1] * e[1]), sigma = 0.5 * length / f;
  double variance = sigma * sigma;
  for (int i = 0; i < 2; i++) {
    e[i] = length > 0.0 ? e[i] / length : trace[i];
    shape->center[i] = 0.5 * (ends[0].place[i] + ends[1].place[i]);
  }
  double steps = length > 0.0 ? (ends[1].inverse_depth - ends[0].inverse_depth) / length : 0.0;
  shape->variance = (oracle_symmetric){variance * e[0] * e[0], variance * e[0] * e[1], variance * e[1] * e[1]};
  widen(view, shape);
  shape->center_iz = 0.5 * (ends[0].inverse_depth + ends[1].inverse_depth);
  for (int i = 0; i < 2; i++) {
    shape->gradient[i] = steps * e[i];
    shape->slope[i] = steps * e[i] * variance / (variance + view->prefilter);
  }
  return 1;
}

/* The share of itself by which the distance may change from p's to the pixels'. It changes with the depth of the disc,
 * with its plane within the filter's reach, and with the length of d, which is at least 1 at p. */
static double greatest_change(const oracle_view *view, const oracle_placed *s, const oracle_shape *shape) {
  const conic_camera *c = &view->camera;
  const double focal[2] = {c->fx, c->fy}, principal[2] = {c->cx, c->cy};
  double turn = 0.0, squares = 0.0, reach = view->cutoff * sqrt(s->tu[2] * s->tu[2] + s->tv[2] * s->tv[2]);
  if (shape->formula == ORACLE_LAPLACE || !conic_oracle_is_before_near(view, s))
    return INFINITY;
  for (int i = 0; i < 2; i++) {
    double place = focal[i] * s->p[i] / s->p[2] + principal[i];
    double across = oracle_max(shape->box[1][i] - place, place - shape->box[0][i]) / focal[i];
    turn += fabs(s->p[i] / s->p[2]) * across;
    squares += across * across;
  }
  double slope = sqrt(shape->gradient[0] * shape->gradient[0] + shape->gradient[1] * shape->gradient[1]);
  return reach / s->p[2] + slope * view->reach_px * s->p[2] + turn + 0.5 * squares;
}

int conic_oracle_shape(const oracle_view *view, const oracle_placed *s, oracle_formula formula, oracle_shape *shape) {
  static const oracle_shape nothing;
  double normal[3], reach = view->cutoff * sqrt(s->tu[2] * s->tu[2] + s->tv[2] * s->tv[2]);
  int is_set = 1;
  oracle_cross(s->tu, s->tv, normal);
  *shape = nothing;
  shape->formula = formula;
  shape->range[0] = 1.0 / (s->p[2] + reach);
  shape->range[1] = 1.0 / oracle_max(view->near_z, s->p[2] - reach);
  if (formula == ORACLE_CONIC && s->p[2] > reach)
    set_conic(view, s, oracle_dot(normal, s->p), shape);
  else if (formula == ORACLE_AFFINE && s->p[2] > 0.0)
    set_affine(view, s, oracle_dot(normal, s->p), shape);
  else if (formula == ORACLE_RAY)
    is_set = set_ray(view, s, shape);
  else if (formula == ORACLE_LAPLACE && s->p[2] > reach)
    is_set = set_laplace(view, s, shape);
  else if (formula == ORACLE_SEGMENT)
    is_set = set_segment(view, s, shape);
  else if ((formula == ORACLE_DISC || formula == ORACLE_POINT) && s->p[2] > 0.0)
    is_set = set_dot(view, s, shape);
  else
    is_set = 0;
  shape->change = is_set ? greatest_change(view, s, shape) : INFINITY;
  shape->change_error = 2.0 * view->floats.unit * ORACLE_NARROW_CHANGE;
  double sum = shape->amplitude + shape->center[0] + shape->center[1] + shape->inverse.xx + shape->inverse.yy;
  for (int i = 0; i < 2; i++)
    sum += shape->box[0][i] + shape->box[1][i];
  return is_set && oracle_is_finite(sum);
}
