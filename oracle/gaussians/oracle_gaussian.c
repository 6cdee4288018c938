/* Gaussians for the oracle: what each profile makes of one, and how much a place of the screen sees of it. */
#include "oracle/gaussians/oracle_gaussian.h"

#include "oracle/gaussians/oracle_unscented.h"

#define UNIT_SLACK (1.0 / 1048576.0)

void conic_oracle_rotation(const double q[4], double r[3][3]) {
  double w = q[0], x = q[1], y = q[2], z = q[3];
  double rows[3][3] = {{1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)},
                       {2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)},
                       {2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)}};
  memcpy(r, rows, sizeof rows);
}

double conic_oracle_quaternion(const conic_profile_row *rules, const conic_gaussians *set, size_t i, double q[4]) {
  double length = 0.0;
  for (int k = 0; k < 4; k++) {
    q[k] = (double)set->rotation[k][i];
    length += q[k] * q[k];
  }
  length = rules->takes_rotation_as_is > 1 || (rules->takes_rotation_as_is && fabs(length - 1.0) < UNIT_SLACK)
               ? 1.0
               : sqrt(length);
  for (int k = 0; k < 4; k++)
    q[k] /= length;
  return length;
}

/* The axes in the world and in camera space. Returns 0 where there are none. */
static int turn_axes(const oracle_gaussian_view *view, const conic_gaussians *set, size_t i, double world[3][3],
                     oracle_gaussian *g) {
  double q[4];
  conic_oracle_quaternion(view->rules, set, i, q);
  conic_oracle_rotation(q, world);
  int is_good = 1;
  for (int axis = 0; axis < 3; axis++) {
    g->scale[axis] = set->scale[axis] ? (double)set->scale[axis][i] : 0.0;
    is_good &= oracle_is_finite(g->scale[axis]) && g->scale[axis] >= 0.0;
    for (int row = 0; row < 3; row++) {
      const double *camera = view->camera->cam_from_world[row];
      g->unit[axis][row] = camera[0] * world[0][axis] + camera[1] * world[1][axis] + camera[2] * world[2][axis];
      g->axes[axis][row] = g->unit[axis][row] * g->scale[axis];
      is_good &= oracle_is_finite(g->axes[axis][row]);
    }
  }
  return is_good;
}

/* The direction of the shortest axis, of a disc the third, turned towards the eye. */
static void pick_normal(const oracle_gaussian_view *view, const double world[3][3], oracle_gaussian *g) {
  int axis = 2;
  if (view->rules->shape != CONIC_SHAPE_DISC && !g->is_flat)
    for (int k = 1; k >= 0; k--)
      axis = g->scale[k] < g->scale[axis] ? k : axis;
  int is_parallel = view->camera->kind == CONIC_CAMERA_ORTHOGRAPHIC;
  double side = (is_parallel ? g->unit[axis][2] : oracle_dot(g->unit[axis], g->mean)) > 0.0 ? -1.0 : 1.0;
  for (int row = 0; row < 3; row++)
    g->normal[row] = side * world[row][axis];
}

static double clamp(double value, double low, double high) {
  return oracle_min(oracle_max(value, low), high);
}

/* How many whole tiles of 16 pixels there are up to a place. */
static double tiles_to(double place, double size) {
  double n = place / 16.0;
  return clamp(n < 0.0 ? ceil(n) : floor(n), 0.0, ceil(size / 16.0)) * 16.0;
}

/* A square about the place, rounded out to tiles. */
static void cover_tiles(const oracle_gaussian_view *view, double radius, oracle_gaussian *g) {
  const double size[2] = {view->camera->width, view->camera->height};
  for (int axis = 0; axis < 2; axis++) {
    double place = g->place_px[axis] - 0.5;
    g->box_px[0][axis] = tiles_to(place - radius, size[axis]);
    g->box_px[1][axis] = tiles_to(place + radius + 15.0, size[axis]);
  }
}

/* √(max(least, before/(after + slack)) + slack). */
static double compensation(const conic_profile_row *rules, double before, double after) {
  const double slack = rules->compensation_slack;
  if (slack > 0.0 && before <= slack)
    return 0.0;
  return sqrt(oracle_max(rules->compensation_least, before / (after + slack)) + slack);
}

double conic_oracle_longest_axis(const oracle_gaussian_view *view) {
  const conic_profile_row *rules = view->rules;
  double most = rules->axis_most > 0.0 ? rules->axis_most : INFINITY;
  if (rules->axis_share > 0.0)
    most = oracle_min(most, rules->axis_share * oracle_min(view->camera->width, view->camera->height));
  return most;
}

/* The form of an ellipse whose axes have limits: u·uᵀ/λ₁ + v·vᵀ/λ₂. Returns 0 where nothing is drawn. */
static int limit_form(const oracle_gaussian_view *view, oracle_symmetric c, double area, double form[3]) {
  const conic_profile_row *rules = view->rules;
  const double longest = conic_oracle_longest_axis(view), middle = 0.5 * (c.xx + c.yy);
  const double own = sqrt(0.25 * (c.xx - c.yy) * (c.xx - c.yy) + c.xy * c.xy);
  const double spread = oracle_max(own, rules->spread_least);
  double first = middle + spread, second = spread > own ? middle - spread : area / first;
  double u[2] = {c.xy, first - c.xx}, other[2] = {first - c.yy, c.xy};
  if (first < rules->axis_seen * rules->axis_seen || (second <= 0.0 && !(rules->axis_least > 0.0)))
    return 0;
  if (spread == own && c.xx > c.yy) /* the same direction, without cancellation */
    memcpy(u, other, sizeof u);
  double length = sqrt(u[0] * u[0] + u[1] * u[1]);
  u[0] = length > 0.0 ? u[0] / length : 1.0;
  u[1] = length > 0.0 ? u[1] / length : 0.0;
  first = oracle_min(first, longest * longest);
  second = oracle_min(oracle_max(second, rules->axis_least), longest * longest);
  form[0] = u[0] * u[0] / first + u[1] * u[1] / second;
  form[1] = u[0] * u[1] / first - u[0] * u[1] / second;
  form[2] = u[1] * u[1] / first + u[0] * u[0] / second;
  return 1;
}

static int place_ellipse(const oracle_gaussian_view *view, oracle_gaussian *g) {
  const conic_profile_row *rules = view->rules;
  const conic_camera *camera = view->camera;
  const double focal[2] = {camera->fx, camera->fy}, size[2] = {camera->width, camera->height}, z = g->mean[2];
  double rows[2][3], d = rules->dilation;
  for (int axis = 0; axis < 2; axis++) {
    double slope = g->mean[axis] / z, half = 0.5 * size[axis] / focal[axis], c = view->center_px[axis];
    g->place_px[axis] = focal[axis] * slope + c;
    const double beyond = rules->slope_margin * half;
    if (beyond >= 0.0)
      slope = clamp(slope, -(c / focal[axis] + beyond), (size[axis] - c) / focal[axis] + beyond);
    for (int k = 0; k < 3; k++)
      rows[axis][k] = focal[axis] / z * (g->axes[k][axis] - slope * g->axes[k][2]);
  }
  oracle_symmetric bare = {oracle_dot(rows[0], rows[0]), oracle_dot(rows[0], rows[1]), oracle_dot(rows[1], rows[1])};
  oracle_symmetric wide = {bare.xx + d, bare.xy, bare.yy + d};
  double area[3];
  oracle_cross(rows[0], rows[1], area);
  double before = oracle_dot(area, area), after = before + d * (bare.xx + bare.yy) + d * d;
  if (!(after > 0.0) || !oracle_is_finite(after))
    return 0;
  if (rules->compensation_least >= 0.0)
    g->opacity *= compensation(rules, before, after);
  g->form[0] = wide.yy / after;
  g->form[1] = -wide.xy / after;
  g->form[2] = wide.xx / after;
  for (int axis = 0; axis < 2; axis++)
    if (rules->clip > 0.0 && fabs(2.0 * g->place_px[axis] / size[axis] - 1.0) > rules->clip)
      return 0;
  if (conic_profile_limits_axes(rules) && !limit_form(view, wide, after, g->form))
    return 0;
  if (rules->coverage == CONIC_COVERAGE_TILES) {
    double mean = 0.5 * (wide.xx + wide.yy);
    cover_tiles(view, ceil(3.0 * sqrt(mean + sqrt(oracle_max(0.1, mean * mean - after)))), g);
  }
  return 1;
}

/* The tiles that a box about the place meets; 0: none. */
static int cover_box(const oracle_gaussian_view *view, const double half[2], oracle_gaussian *g) {
  const double tile = conic_profile_tile(view->rules, view->camera);
  for (int axis = 0; axis < 2; axis++) {
    double radius = ceil(half[axis]), size = axis ? view->camera->height : view->camera->width;
    if (g->place_px[axis] + radius <= 0.0 || g->place_px[axis] - radius >= size)
      return 0;
    g->box_px[0][axis] = floor((g->place_px[axis] - radius) / tile) * tile;
    g->box_px[1][axis] = ceil((g->place_px[axis] + radius) / tile) * tile;
  }
  return 1;
}

/* The centre of the box of the disc's outline at the cutoff, and the pixels that the profile looks at. */
static int place_disc(const oracle_gaussian_view *view, oracle_gaussian *g) {
  const conic_profile_row *rules = view->rules;
  const conic_camera *camera = view->camera;
  const double columns[3][3] = {{g->axes[0][0], g->axes[0][1], g->axes[0][2]},
                                {g->axes[1][0], g->axes[1][1], g->axes[1][2]},
                                {g->mean[0], g->mean[1], g->mean[2]}};
  const double signs[3] = {rules->disc_cutoff * rules->disc_cutoff, rules->disc_cutoff * rules->disc_cutoff, -1.0};
  double extent[2], weight = 0.0;
  for (int k = 0; k < 3; k++) {
    g->rows[0][k] = camera->fx * columns[k][0] + view->center_px[0] * columns[k][2];
    g->rows[1][k] = camera->fy * columns[k][1] + view->center_px[1] * columns[k][2];
    g->rows[2][k] = columns[k][2];
    weight += signs[k] * g->rows[2][k] * g->rows[2][k];
  }
  if (weight == 0.0 || !oracle_is_finite(weight))
    return 0;
  for (int axis = 0; axis < 2; axis++) {
    double place = 0.0, square = 0.0;
    for (int k = 0; k < 3; k++) {
      place += signs[k] / weight * g->rows[axis][k] * g->rows[2][k];
      square += signs[k] / weight * g->rows[axis][k] * g->rows[axis][k];
    }
    g->place_px[axis] = place;
    extent[axis] = sqrt(oracle_max(1e-4, place * place - square));
  }
  if (rules->coverage == CONIC_COVERAGE_TILES) {
    cover_tiles(view, ceil(oracle_max(oracle_max(extent[0], extent[1]), 3.0 * 0.707106)), g);
    return 1;
  }
  const double half[2] = {rules->disc_extent * extent[0], rules->disc_extent * extent[1]};
  return cover_box(view, half, g);
}

/* The box of the unscented transform. */
static int place_solid(const oracle_gaussian_view *view, oracle_gaussian *g) {
  bounded mean[3], axes[3][3];
  oracle_unscented u;
  for (int k = 0; k < 3; k++) {
    mean[k] = bounded_of(g->mean[k]);
    for (int row = 0; row < 3; row++)
      axes[k][row] = bounded_of(g->axes[k][row]);
    if (!(g->scale[k] > 0x1p-23))
      return 0;
  }
  conic_oracle_unscent(view, mean, (const bounded(*)[3])axes, bounded_of(g->opacity), 0.0, &u);
  if (!u.is_seen || !(u.conditions[0].v > 0.0))
    return 0;
  for (int k = 1; k < 4; k++)
    if (!(u.conditions[k].v >= 0.0))
      return 0;
  g->place_px[0] = u.place[0].v;
  g->place_px[1] = u.place[1].v;
  return cover_box(view, (const double[2]){u.radius[0].v, u.radius[1].v}, g);
}

double conic_oracle_harmonic_at(const conic_gaussians *set, size_t at) {
  if (set->sh)
    return (double)set->sh[at];
  uint16_t half = set->sh_half[at];
  int exponent = half >> 10 & 31, fraction = half & 1023;
  double size = exponent ? 1024.0 + fraction : fraction;
  if (exponent == 31)
    return fraction ? NAN : half & 0x8000 ? -INFINITY : INFINITY;
  for (int k = exponent ? exponent : 1; k < 25; k++)
    size *= 0.5;
  for (int k = 25; k < exponent; k++)
    size *= 2.0;
  return half & 0x8000 ? -size : size;
}

void conic_oracle_harmonics_of(const conic_gaussians *set, size_t i, double *sh) {
  const size_t n = (size_t)(set->sh_degree + 1) * (size_t)(set->sh_degree + 1) * 3;
  for (size_t k = 0; k < n; k++)
    sh[k] = conic_oracle_harmonic_at(set, i * n + k);
}

static void color_towards_eye(const oracle_gaussian_view *view, const conic_gaussians *set, const double mean[3],
                              size_t i, oracle_gaussian *g) {
  double sh[(CONIC_MAX_SH_DEGREE + 1) * (CONIC_MAX_SH_DEGREE + 1) * 3], direction[3];
  conic_oracle_harmonics_of(set, i, sh);
  for (int axis = 0; axis < 3; axis++)
    direction[axis] = view->camera->kind == CONIC_CAMERA_ORTHOGRAPHIC ? view->camera->cam_from_world[2][axis]
                                                                      : mean[axis] - view->eye[axis];
  double length = oracle_length(direction);
  for (int axis = 0; axis < 3; axis++)
    direction[axis] = length > 0.0 ? direction[axis] / length : 0.0;
  conic_oracle_harmonics(sh, view->rules->has_plain_color ? 0 : set->sh_degree, direction, g->color);
  const double fade = conic_profile_fade(view->rules, g->mean[2]), most = view->rules->color_most;
  for (int c = 0; c < 3; c++)
    g->color[c] = fade * (most > 0.0 ? oracle_min(g->color[c], most) : g->color[c]);
  g->opacity *= fade;
}

void conic_oracle_gaussian_place(const oracle_gaussian_view *view, const conic_gaussians *set, size_t i,
                                 oracle_gaussian *g) {
  const conic_profile_row *rules = view->rules;
  double mean[3], world[3][3];
  memset(g, 0, sizeof *g);
  g->index = (uint32_t)i;
  g->is_flat = !set->scale[2];
  g->opacity = (double)set->opacity[i];
  g->box_px[0][0] = g->box_px[0][1] = -INFINITY;
  g->box_px[1][0] = g->box_px[1][1] = INFINITY;
  for (int axis = 0; axis < 3; axis++)
    mean[axis] = set->origin[axis] + (double)set->position[axis][i];
  for (int row = 0; row < 3; row++) {
    const double *camera = view->camera->cam_from_world[row];
    g->mean[row] = camera[0] * mean[0] + camera[1] * mean[1] + camera[2] * mean[2] + camera[3];
    if (!oracle_is_finite(g->mean[row]))
      return;
  }
  int is_near = g->mean[2] < rules->near_z || (rules->is_beyond_near && g->mean[2] == rules->near_z);
  if (!oracle_is_finite(g->opacity) || !turn_axes(view, set, i, world, g) ||
      (rules->shape != CONIC_SHAPE_RAY && (is_near || !(g->mean[2] > 0.0))))
    return;
  pick_normal(view, world, g);
  color_towards_eye(view, set, mean, i, g);
  const int is_round = view->camera->kind == CONIC_CAMERA_FISHEYE || view->camera->kind == CONIC_CAMERA_EQUIRECTANGULAR;
  g->key = (float)(rules->orders_by_distance || (is_round && rules->shape == CONIC_SHAPE_RAY) ? oracle_length(g->mean)
                                                                                              : g->mean[2]);
  g->is_drawn = oracle_is_finite(g->color[0] + g->color[1] + g->color[2]);
  if (rules->shape == CONIC_SHAPE_ELLIPSE)
    g->is_drawn &= place_ellipse(view, g);
  if (rules->shape == CONIC_SHAPE_DISC)
    g->is_drawn &= place_disc(view, g);
  if (rules->shape == CONIC_SHAPE_SOLID)
    g->is_drawn &= place_solid(view, g);
  if (view->prefilter > 0.0)
    g->is_drawn &= conic_oracle_gaussian_box(view, g);
}

/* In the Gaussian's own frame, where it is a unit ball, the ray goes through z·d − m. Of a flat one, where the ray
 * meets the plane. */
int conic_oracle_gaussian_along(const oracle_gaussian_view *view, const oracle_gaussian *g, double x, double y,
                                double *q, double *z, double *width) {
  const conic_camera *camera = view->camera;
  double origin[3], ray[3], d[3], m[3], cross[3];
  if (view->rays) {
    const oracle_ray *known = &view->rays[(size_t)y * (size_t)camera->width + (size_t)x];
    memcpy(origin, known->origin, sizeof origin);
    memcpy(ray, known->direction, sizeof ray);
    if (!known->is_there)
      return 0;
  } else
    conic_oracle_pixel_ray(camera, x, y, origin, ray);
  const double to_mean[3] = {g->mean[0] - origin[0], g->mean[1] - origin[1], g->mean[2] - origin[2]};
  for (int axis = 0; axis < 3; axis++) {
    d[axis] = oracle_dot(g->unit[axis], ray);
    m[axis] = oracle_dot(g->unit[axis], to_mean);
  }
  if (g->is_flat || g->scale[2] == 0.0) {
    *z = m[2] / d[2];
    double u = (*z * d[0] - m[0]) / g->scale[0], v = (*z * d[1] - m[1]) / g->scale[1];
    *q = u * u + v * v;
    *width = 0.0;
    return *z > 0.0 && oracle_is_finite(*q);
  }
  for (int axis = 0; axis < 3; axis++) {
    d[axis] /= g->scale[axis];
    m[axis] /= g->scale[axis];
  }
  double square = oracle_dot(d, d);
  oracle_cross(d, m, cross);
  *q = oracle_dot(cross, cross) / square;
  *z = oracle_dot(d, m) / square;
  *width = 1.0 / sqrt(square);
  return *z > 0.0 && oracle_is_finite(*q) && oracle_is_finite(*z);
}

static double disc_form(const oracle_gaussian_view *view, const oracle_gaussian *g, double x, double y, double *z) {
  double k[3], l[3], p[3];
  for (int i = 0; i < 3; i++) {
    k[i] = x * g->rows[2][i] - g->rows[0][i];
    l[i] = y * g->rows[2][i] - g->rows[1][i];
  }
  oracle_cross(k, l, p);
  if (p[2] == 0.0)
    return -1.0;
  double u = p[0] / p[2], v = p[1] / p[2], dx = g->place_px[0] - x, dy = g->place_px[1] - y;
  double hit = u * g->rows[2][0] + v * g->rows[2][1] + g->rows[2][2];
  if (view->rules->disc_near > 0.0) {
    *z = hit;
    if (hit < view->rules->disc_near)
      return -1.0;
  }
  return oracle_min(u * u + v * v, 2.0 * (dx * dx + dy * dy));
}

double conic_oracle_gaussian_alpha(const oracle_gaussian_view *view, const oracle_gaussian *g, double x, double y,
                                   double *z) {
  const conic_profile_row *rules = view->rules;
  double q, width, share = 1.0;
  if (x < g->box_px[0][0] || x >= g->box_px[1][0] || y < g->box_px[0][1] || y >= g->box_px[1][1])
    return 0.0;
  *z = g->mean[2];
  if (view->prefilter > 0.0) {
    if (!conic_oracle_gaussian_filtered(view, g, x, y, &q, z, &share))
      return 0.0;
  } else if (rules->shape == CONIC_SHAPE_RAY) {
    if (!conic_oracle_gaussian_along(view, g, x, y, &q, z, &width))
      return 0.0;
  } else if (rules->shape == CONIC_SHAPE_SOLID) {
    double at;
    if (!conic_oracle_gaussian_along(view, g, x, y, &q, &at, &width))
      return 0.0;
  } else if (rules->shape == CONIC_SHAPE_DISC) {
    q = disc_form(view, g, x, y, z);
  } else {
    double dx = g->place_px[0] - x, dy = g->place_px[1] - y;
    q = g->form[0] * dx * dx + 2.0 * g->form[1] * dx * dy + g->form[2] * dy * dy;
  }
  if (!(q >= 0.0) || (rules->greatest_half_q > 0.0 && q > 2.0 * rules->greatest_half_q))
    return 0.0;
  const double fall = (conic_oracle_exp(-0.5 * q) - rules->fall_end) / (1.0 - rules->fall_end);
  double alpha = oracle_min(rules->alpha_most, g->opacity * share * fall);
  return alpha >= rules->alpha_least ? alpha : 0.0;
}
