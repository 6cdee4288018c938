#include "oracle/gaussians/oracle_lens.h"

/* How many roundings stand between a number and a polynomial of it. */
static const double n_roundings = 12.0;

/* k1 to k6 of the factor, then p1 and p2. */
typedef struct lens_numbers {
  double k[6], p[2];
} lens_numbers;

static lens_numbers numbers_of(const conic_camera *camera) {
  const double *d = camera->distortion;
  if (camera->lens == CONIC_LENS_OPENCV)
    return (lens_numbers){{d[0], d[1], d[4], d[5], d[6], d[7]}, {d[2], d[3]}};
  if (camera->lens == CONIC_LENS_RADIAL)
    return (lens_numbers){{d[0], d[1], d[2], d[3], 0.0, 0.0}, {0.0, 0.0}};
  return (lens_numbers){{0.0}, {0.0}};
}

int conic_oracle_is_bent(const conic_camera *camera) {
  return camera->lens || camera->shutter || camera->kind == CONIC_CAMERA_FISHEYE ||
         camera->kind == CONIC_CAMERA_EQUIRECTANGULAR;
}

/* Σ w_i·k_i·s^i from the first power on, n of them, where w is first, first + by, …; all its terms positive in *size.
 */
static double sum_of_powers(const double *k, int n, double s, double first, double by, double *size) {
  double sum = 0.0, power = 1.0;
  *size = 0.0;
  for (int i = 0; i < n; i++) {
    power *= s;
    sum += (first + i * by) * k[i] * power;
    *size += fabs((first + i * by) * k[i] * power);
  }
  return sum;
}

/* atan2 of y ≥ 0: the tangent of an eighth of the angle, and its series. */
static double angle_of(double y, double x) {
  double t = y / (x + sqrt(x * x + y * y)), sum = 0.0, power;
  for (int i = 0; i < 2; i++)
    t = t / (1.0 + sqrt(1.0 + t * t));
  power = t;
  for (int n = 1; n < 60; n += 2) {
    sum += (n % 4 == 1 ? power : -power) / n;
    power *= t * t;
  }
  return 8.0 * sum;
}

static double sine_of(double angle) {
  double term = angle, sum = angle;
  for (int n = 3; n < 40; n += 2) {
    term *= -angle * angle / (n * (n - 1));
    sum += term;
  }
  return sum;
}

/* --- fisheyes: θ·(1 + k1·θ² + … + k4·θ⁸) --- */

static double slope_of_fisheye(const lens_numbers *l, double angle) {
  double unused;
  return 1.0 + sum_of_powers(l->k, 4, angle * angle, 3.0, 2.0, &unused);
}

static double bend_of_fisheye(const lens_numbers *l, double angle) {
  double bend = 0.0, power = angle;
  for (int i = 0; i < 4; i++, power *= angle * angle)
    bend += (2.0 * i + 3.0) * (2.0 * i + 2.0) * l->k[i] * power;
  return bend;
}

/* The least place where a slope without k4 is 0: found from 0 on, in steps, then halved. */
static double find_turn(const lens_numbers *l) {
  const double most = 3.2, step = 1.0 / 4096.0;
  double low = 0.0;
  while (low < most && slope_of_fisheye(l, low + step) > 0.0)
    low += step;
  if (low >= most)
    return INFINITY;
  double high = low + step;
  for (int i = 0; i < 60; i++) {
    const double middle = 0.5 * (low + high);
    *(slope_of_fisheye(l, middle) > 0.0 ? &low : &high) = middle;
  }
  return high;
}

/* With k4 the program takes 20 steps of Newton's, from 1.57 on. */
static double find_turn_by_steps(const lens_numbers *l) {
  double angle = 1.57, step = 1.0;
  for (int i = 0; i < 20 && fabs(step) >= 1e-6; i++) {
    step = slope_of_fisheye(l, angle) / bend_of_fisheye(l, angle);
    angle -= step;
  }
  return fabs(step) < 1e-6 && angle > 0.0 ? angle : INFINITY;
}

double conic_oracle_most_angle(const conic_camera *c) {
  const lens_numbers l = numbers_of(c);
  if (c->kind != CONIC_CAMERA_FISHEYE)
    return INFINITY;
  const double x = oracle_max(c->cx, c->width - c->cx), y = oracle_max(c->cy, c->height - c->cy);
  const double corner = sqrt(x * x + y * y) / oracle_min(c->fx, c->fy);
  return oracle_min(corner, l.k[3] == 0.0 ? find_turn(&l) : find_turn_by_steps(&l));
}

static int show_by_fisheye(const oracle_gaussian_view *view, const bounded at[3], double unit, bounded normal[2],
                           int *may_be) {
  const lens_numbers l = numbers_of(view->camera);
  const bounded square = bounded_add(bounded_multiply(at[0], at[0], unit), bounded_multiply(at[1], at[1], unit), unit);
  const bounded across = bounded_root(square, unit);
  const double far = across.v * across.v + at[2].v * at[2].v, most = view->most_angle;
  bounded angle = {angle_of(across.v, at[2].v), (fabs(at[2].v) * across.off + across.v * at[2].off) / far};
  angle = bounded_rounded(bounded_rounded(angle, unit), unit);
  const double slack = angle.off + n_roundings * unit * most;
  const int is_seen = angle.v < most;
  double size;
  *may_be = angle.v - slack < most;
  angle.v = oracle_min(angle.v, most);
  const double grown = 1.0 + sum_of_powers(l.k, 4, angle.v * angle.v, 1.0, 0.0, &size);
  bounded radius = {angle.v * grown, 0.0};
  radius.off =
      n_roundings * unit * angle.v * (1.0 + size) + slack * (fabs(slope_of_fisheye(&l, angle.v)) + slack * 64.0);
  bounded part = bounded_divide(radius, across, unit);
  if (!(across.v > 4.0 * across.off)) { /* next to the axis it is 1/z */
    const double v = across.v > 0.0 ? part.v : 1.0 / at[2].v;
    part = bounded_divide(bounded_of(1.0), at[2], unit);
    part = (bounded){v, part.off + fabs(part.v - v)};
    part.off += part.v * (bounded_high(across) / at[2].v) * (bounded_high(across) / at[2].v);
    radius = bounded_of(1.0);
  }
  for (int axis = 0; axis < 2; axis++)
    normal[axis] = bounded_multiply(part, at[axis], unit);
  if (bounded_low(radius) > 0.0)
    return is_seen;
  for (int axis = 0; axis < 2; axis++) /* which is turned over the centre: it shows at 0, 0 */
    normal[axis].off = INFINITY;
  return radius.v > 0.0 ? is_seen : -1;
}

/* Newton's steps to the angle of a radius, as the program takes them; how far rounding may lead them apart, *spread. */
static double step_to_angle(const oracle_gaussian_view *view, const lens_numbers *l, double radius, double unit,
                            double *step, double *spread) {
  const conic_camera *c = view->camera;
  double angle = radius * view->most_angle / oracle_max(0.5 * c->width / c->fx, 0.5 * c->height / c->fy), widest = 0.0;
  *step = 1.0;
  *spread = n_roundings * unit * angle;
  for (int i = 0; i < 20 && !(fabs(*step) < 1e-6); i++) {
    double size;
    const double out = angle * (1.0 + sum_of_powers(l->k, 4, angle * angle, 1.0, 0.0, &size)) - radius;
    const double slope = slope_of_fisheye(l, angle);
    const double bend = bend_of_fisheye(l, angle);
    *step = out / slope;
    *spread *= fabs(*step * bend / slope) + fabs(*spread * bend / slope);
    *spread += n_roundings * unit * (fabs(angle) * (1.0 + size) + radius) / fabs(slope);
    widest = oracle_max(widest, *spread);
    angle -= *step;
  }
  if (widest > 1e-3) /* they may end anywhere */
    *spread = INFINITY;
  return angle;
}

static void see_by_fisheye(const oracle_gaussian_view *view, const double wanted[2], double unit, oracle_sight *s) {
  const lens_numbers l = numbers_of(view->camera);
  const double radius = sqrt(wanted[0] * wanted[0] + wanted[1] * wanted[1]), most = view->most_angle;
  double step, spread, unused;
  const double angle = step_to_angle(view, &l, radius, unit, &step, &spread), slack = n_roundings * unit * most;
  const double most_radius = most * (1.0 + sum_of_powers(l.k, 4, most * most, 1.0, 0.0, &unused));
  s->is_there = fabs(step) < 1e-6 && angle >= 0.0 && angle < most;
  const int is_doubtful = !(spread < 3e-7) || fabs(angle - most) <= spread + slack;
  s->may_be_there = s->is_there || (is_doubtful && radius <= most_radius + slack);
  s->off = is_doubtful ? INFINITY : spread + 4.0 * unit;
  const double part = radius > 0.0 ? sine_of(angle) / radius : 1.0;
  s->direction[0] = part * wanted[0];
  s->direction[1] = part * wanted[1];
  s->direction[2] = 1.0 - 2.0 * sine_of(0.5 * angle) * sine_of(0.5 * angle);
}

/* --- lenses of OpenCV --- */

static bounded bounded_sum_of_powers(const double *k, bounded s, double unit) {
  bounded sum = bounded_of(0.0);
  for (int i = 2; i >= 0; i--)
    sum = bounded_multiply(s, bounded_add(bounded_rounded(bounded_of(k[i]), unit), sum, unit), unit);
  return bounded_add(bounded_of(1.0), sum, unit);
}

static int show_by_lens(const oracle_gaussian_view *view, const bounded at[3], double unit, bounded normal[2],
                        int *may_be) {
  const lens_numbers l = numbers_of(view->camera);
  const bounded a[2] = {bounded_divide(at[0], at[2], unit), bounded_divide(at[1], at[2], unit)};
  const bounded squares[2] = {bounded_multiply(a[0], a[0], unit), bounded_multiply(a[1], a[1], unit)};
  const bounded both = bounded_scale(2.0, bounded_multiply(a[0], a[1], unit), unit);
  const bounded s = bounded_add(squares[0], squares[1], unit);
  const bounded bottom = bounded_sum_of_powers(l.k + 3, s, unit);
  bounded growth = bounded_divide(bounded_sum_of_powers(l.k, s, unit), bottom, unit);
  if (!(fabs(bottom.v) - bottom.off > 1e-8))
    growth = (bounded){fabs(bottom.v) > 1e-8 ? growth.v : 0.0, INFINITY};
  for (int axis = 0; axis < 2; axis++) {
    const bounded own = bounded_add(s, bounded_scale(2.0, squares[axis], unit), unit);
    const bounded added =
        bounded_add(bounded_scale(l.p[axis], both, unit), bounded_scale(l.p[1 - axis], own, unit), unit);
    normal[axis] = bounded_add(bounded_multiply(growth, a[axis], unit), bounded_rounded(added, unit), unit);
  }
  *may_be = bounded_high(growth) > 0.8;
  return growth.v > 0.8;
}

/* The program's steps of Newton's, of which it takes 5. */
static void see_by_lens(const oracle_gaussian_view *view, const double wanted[2], double unit, oracle_sight *s) {
  const lens_numbers l = numbers_of(view->camera);
  double a = wanted[0], b = wanted[1], step = INFINITY, noise = 0.0;
  int is_lost = 0;
  for (int i = 0; i < 5 && !is_lost && !(step < 1e-6); i++) {
    const double q = a * a + b * b, p1 = l.p[0], p2 = l.p[1];
    double sizes[2], slopes[2], unused;
    const double top = 1.0 + sum_of_powers(l.k, 3, q, 1.0, 0.0, &sizes[0]);
    const double bottom = 1.0 + sum_of_powers(l.k + 3, 3, q, 1.0, 0.0, &sizes[1]), growth = top / bottom;
    for (int k = 0; k < 2; k++) /* of top and bottom by q, times q */
      slopes[k] = sum_of_powers(l.k + (ptrdiff_t)3 * k, 3, q, 1.0, 1.0, &unused);
    const double by_q = q > 0.0 ? (slopes[0] - growth * slopes[1]) / bottom / q : 0.0;
    const double out[2] = {growth * a + 2.0 * p1 * a * b + p2 * (q + 2.0 * a * a) - wanted[0],
                           growth * b + p1 * (q + 2.0 * b * b) + 2.0 * p2 * a * b - wanted[1]};
    const oracle_symmetric by = {growth + 2.0 * by_q * a * a + 2.0 * p1 * b + 6.0 * p2 * a,
                                 2.0 * by_q * a * b + 2.0 * p1 * a + 2.0 * p2 * b,
                                 growth + 2.0 * by_q * b * b + 6.0 * p1 * b + 2.0 * p2 * a};
    const double determinant = by.xx * by.yy - by.xy * by.xy;
    const double size = (fabs(a) + fabs(b)) * ((1.0 + sizes[0]) * (1.0 + sizes[1]) / (bottom * bottom)) +
                        4.0 * (fabs(p1) + fabs(p2)) * q + fabs(wanted[0]) + fabs(wanted[1]);
    noise = n_roundings * unit * size * (fabs(by.xx) + fabs(by.xy) + fabs(by.yy)) / fabs(determinant);
    is_lost = !(growth > 0.0) || fabs(determinant) < 1e-6;
    if (is_lost)
      break;
    const double by_a = (by.yy * out[0] - by.xy * out[1]) / determinant;
    const double by_b = (by.xx * out[1] - by.xy * out[0]) / determinant;
    step = oracle_max(fabs(by_a), fabs(by_b));
    a -= by_a;
    b -= by_b;
  }
  s->direction[0] = a;
  s->direction[1] = b;
  s->direction[2] = 1.0;
  s->is_there = !is_lost && step < 1e-6;
  s->may_be_there = s->is_there || (!is_lost && step < 1e-6 + 2.0 * noise);
  s->off = !s->is_there || !(noise < 3e-7) ? INFINITY : noise + 4.0 * unit * (1.0 + fabs(a) + fabs(b));
}

/* --- with the shutter all open --- */

static int show_still(const oracle_gaussian_view *view, const bounded at[3], double unit, bounded place[2],
                      int *may_be) {
  const double focal[2] = {view->camera->fx, view->camera->fy};
  int is_seen = at[2].v > 0.0, may_be_seen = bounded_high(at[2]) > 0.0, is_turned = 0;
  bounded normal[2];
  if (view->camera->kind == CONIC_CAMERA_FISHEYE) {
    const int seen = show_by_fisheye(view, at, unit, normal, &is_turned);
    may_be_seen &= is_turned || !(at[2].v > 0.0);
    is_turned = seen < 0;
    is_seen &= seen > 0;
  } else if (view->camera->lens) {
    is_seen &= show_by_lens(view, at, unit, normal, &is_turned);
    may_be_seen &= is_turned || !(at[2].v > 0.0);
    is_turned = 0;
  } else {
    for (int axis = 0; axis < 2; axis++)
      normal[axis] = bounded_divide(at[axis], at[2], unit);
  }
  for (int axis = 0; axis < 2; axis++) {
    const bounded from = bounded_scale(focal[axis], normal[axis], unit);
    place[axis] = bounded_add(from, bounded_of(view->center_px[axis]), unit);
    if (bounded_high(at[2]) <= 0.0)
      place[axis] = bounded_of(0.0);
    else if (!(at[2].v > 0.0))
      place[axis] = (bounded){0.0, INFINITY};
    else if (is_turned)
      place[axis].v = 0.0;
  }
  *may_be = may_be_seen;
  return is_seen;
}

static void see_still(const oracle_gaussian_view *view, double x_px, double y_px, double unit, oracle_sight *sight) {
  const conic_camera *c = view->camera;
  const double wanted[2] = {(x_px - c->cx) / c->fx, (y_px - c->cy) / c->fy};
  *sight = (oracle_sight){.direction = {wanted[0], wanted[1], 1.0},
                          .off = 4.0 * unit * (1.0 + fabs(wanted[0]) + fabs(wanted[1])),
                          .is_there = 1,
                          .may_be_there = 1};
  if (c->kind == CONIC_CAMERA_FISHEYE)
    see_by_fisheye(view, wanted, unit, sight);
  else if (c->lens)
    see_by_lens(view, wanted, unit, sight);
}

/* --- row by row, or column by column --- */

/* Turned by a share of the whole turn: 1 + sin·K + (1 − cos)·K², K the axis' cross product. */
static void turn_by(const conic_camera *camera, double share, double turn[3][3]) {
  const double length = oracle_length(camera->turn), part = oracle_min(length, 1.0);
  const double angle = share * 2.0 * angle_of(part, sqrt(1.0 - part * part)), half = sine_of(0.5 * angle);
  double k[3];
  for (int i = 0; i < 3; i++)
    k[i] = length > 0.0 ? camera->turn[i] / length : 0.0;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      const double cross = i == j ? 0.0 : (j == (i + 2) % 3 ? 1.0 : -1.0) * k[3 - i - j];
      const double square = k[i] * k[j] - (i == j ? oracle_dot(k, k) : 0.0);
      turn[i][j] = (i == j) + sine_of(angle) * cross + 2.0 * half * half * square;
    }
}

static void pose_of_begin(const conic_camera *camera, double share, double pose[3][4]) {
  double turn[3][3];
  turn_by(camera, share, turn);
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 4; j++) {
      pose[i][j] = j == 3 ? camera->cam_from_world[i][3] + share * camera->shift[i] : 0.0;
      for (int k = 0; k < 3 && j < 3; k++)
        pose[i][j] += turn[i][k] * camera->cam_from_world[k][j];
    }
}

void conic_oracle_middle(const conic_camera *camera, conic_camera *middle) {
  double pose[3][4];
  *middle = *camera;
  if (camera->shutter) {
    pose_of_begin(camera, 0.5, pose);
    memcpy(middle->cam_from_world, pose, sizeof pose);
  }
}

void conic_oracle_shutter_eye(const conic_camera *camera, double eye[3]) {
  double pose[3][4];
  for (int axis = 0; axis < 3; axis++)
    eye[axis] = 0.0;
  for (int end = 0; end < 2; end++) {
    pose_of_begin(camera, end, pose);
    for (int axis = 0; axis < 3; axis++)
      for (int row = 0; row < 3; row++)
        eye[axis] -= 0.5 * pose[row][axis] * pose[row][3];
  }
  for (int axis = 0; axis < 3; axis++)
    eye[axis] = (double)(float)eye[axis];
}

/* Of the camera in the middle, from whose time shares are counted: its space becomes S·p + moved. */
static void pose_of_middle(const conic_camera *camera, double share, double turn[3][3], double moved[3]) {
  turn_by(camera, share, turn);
  for (int i = 0; i < 3; i++) {
    moved[i] = camera->cam_from_world[i][3] + share * camera->shift[i];
    for (int k = 0; k < 3; k++)
      moved[i] -= turn[i][k] * camera->cam_from_world[k][3];
  }
}

static double share_at(const conic_camera *c, double place) {
  switch ((conic_shutter)c->shutter) {
  case CONIC_SHUTTER_TOP_TO_BOTTOM:
    return floor(place) / (c->height - 1.0) - 0.5;
  case CONIC_SHUTTER_LEFT_TO_RIGHT:
    return floor(place) / (c->width - 1.0) - 0.5;
  case CONIC_SHUTTER_BOTTOM_TO_TOP:
    return (c->height - ceil(place)) / (c->height - 1.0) - 0.5;
  case CONIC_SHUTTER_RIGHT_TO_LEFT:
    return (c->width - ceil(place)) / (c->width - 1.0) - 0.5;
  case CONIC_SHUTTER_GLOBAL:
  case CONIC_N_SHUTTERS:
    break;
  }
  return 0.0;
}

static int is_across(const conic_camera *c) {
  return c->shutter == CONIC_SHUTTER_LEFT_TO_RIGHT || c->shutter == CONIC_SHUTTER_RIGHT_TO_LEFT;
}

static bounded bounded_share_at(const conic_camera *c, const bounded place[2]) {
  const bounded at = place[!is_across(c)];
  if (!bounded_is_finite(at))
    return (bounded){oracle_is_finite(at.v) ? share_at(c, at.v) : 0.0, INFINITY};
  const double v = share_at(c, at.v), a = share_at(c, bounded_low(at)), b = share_at(c, bounded_high(at));
  return (bounded){v, oracle_max(fabs(a - v), fabs(b - v))};
}

static int show_at(const oracle_gaussian_view *view, const bounded at[3], bounded share, double unit, bounded place[2],
                   int *may_be) {
  const conic_camera *c = view->camera;
  const double p[3] = {at[0].v, at[1].v, at[2].v}, size[2] = {c->width, c->height};
  double turn[3][3], moved[3], far = oracle_length(p);
  bounded own[3];
  if (!(fabs(share.v) <= 4.0)) /* so far beside the picture that floats know nothing of it */
    share = (bounded){share.v > 0.0 ? 4.0 : -4.0, INFINITY};
  pose_of_middle(c, share.v, turn, moved);
  for (int i = 0; i < 3; i++)
    far += fabs(c->cam_from_world[i][3]);
  for (int i = 0; i < 3; i++) {
    own[i] = (bounded){oracle_dot(turn[i], p) + moved[i], 0.0};
    own[i].off = share.off * (4.0 * oracle_length(c->turn) * far + fabs(c->shift[i]));
    own[i].off += n_roundings * unit * (far + fabs(c->shift[i]));
    for (int k = 0; k < 3; k++)
      own[i].off += fabs(turn[i][k]) * at[k].off;
  }
  int is_in = show_still(view, own, unit, place, may_be);
  for (int axis = 0; axis < 2; axis++) {
    const double margin = view->rules->unscented_share * size[axis];
    is_in &= place[axis].v >= -margin && place[axis].v < size[axis] + margin;
    *may_be &= bounded_high(place[axis]) >= -margin && bounded_low(place[axis]) < size[axis] + margin;
    *may_be |= !bounded_is_finite(place[axis]);
  }
  return is_in;
}

/* What may be the one or the other. */
static bounded either(bounded a, bounded b) {
  return (bounded){a.v, oracle_max(a.off, fabs(a.v - b.v) + b.off)};
}

int conic_oracle_lens_show(const oracle_gaussian_view *view, const bounded at[3], double unit, bounded place[2],
                           int *may_be) {
  bounded first[2], last[2];
  int may_be_first, may_be_last;
  if (!view->camera->shutter)
    return show_still(view, at, unit, place, may_be);
  const int is_first = show_at(view, at, bounded_of(-0.5), unit, first, &may_be_first);
  const int is_last = show_at(view, at, bounded_of(0.5), unit, last, &may_be_last);
  for (int axis = 0; axis < 2; axis++)
    place[axis] = may_be_first && !is_first ? either(last[axis], first[axis])
                  : is_first                ? either(first[axis], may_be_first ? first[axis] : last[axis])
                                            : last[axis];
  *may_be = may_be_first || may_be_last;
  if (!is_first && !is_last) {
    for (int axis = 0; axis < 2 && *may_be; axis++)
      place[axis].off = INFINITY;
    return 0;
  }
  int is_in = 1;
  for (int round = 0; round < 10; round++)
    is_in = show_at(view, at, bounded_share_at(view->camera, place), unit, place, may_be);
  return is_in;
}

static void turn_back(const conic_camera *c, double share, double direction[3], double origin[3]) {
  double turn[3][3], moved[3], own[3] = {direction[0], direction[1], direction[2]};
  pose_of_middle(c, share, turn, moved);
  for (int i = 0; i < 3; i++) {
    const double column[3] = {turn[0][i], turn[1][i], turn[2][i]};
    direction[i] = oracle_dot(column, own);
    origin[i] = -oracle_dot(column, moved);
  }
}

void conic_oracle_lens_see(const oracle_gaussian_view *view, double x_px, double y_px, double unit,
                           oracle_sight *sight) {
  const conic_camera *c = view->camera;
  see_still(view, x_px, y_px, unit, sight);
  if (!c->shutter)
    return;
  double far = oracle_length(c->shift);
  for (int i = 0; i < 3; i++)
    far += fabs(c->cam_from_world[i][3]);
  turn_back(c, share_at(c, is_across(c) ? x_px : y_px), sight->direction, sight->origin);
  sight->off += n_roundings * unit * oracle_length(sight->direction);
  sight->origin_off = n_roundings * unit * far;
}

void conic_oracle_aim_in_time(const oracle_gaussian_view *view, const double at[3], double direction[3],
                              double origin[3]) {
  const bounded place[3] = {bounded_of(at[0]), bounded_of(at[1]), bounded_of(at[2])};
  const conic_camera *c = view->camera;
  bounded shown[2];
  double turn[3][3];
  int unused;
  conic_oracle_lens_show(view, place, 0.0, shown, &unused);
  const double share = oracle_min(oracle_max(share_at(c, shown[!is_across(c)].v), -1.0), 1.0);
  pose_of_middle(c, share, turn, direction);
  for (int i = 0; i < 3; i++)
    direction[i] += oracle_dot(turn[i], at);
  const double length = c->kind == CONIC_CAMERA_FISHEYE ? oracle_length(direction) : direction[2];
  for (int i = 0; i < 3; i++)
    direction[i] = length > 0.0 ? direction[i] / length : i == 2;
  turn_back(c, share, direction, origin);
}
