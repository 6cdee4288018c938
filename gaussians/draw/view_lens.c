#include "gaussians/draw/view_lens.h"

#include "core/base/base.h"
#include "core/base/trigonometry.h"
#include "core/image/camera_rays.h"

enum { PINHOLE_STEPS = 5, FISHEYE_STEPS = 20 };

static const double step_is_small = 1e-6, least_area = 1e-6, least_growth = 0.8, least_bottom = 1e-8;

/* 1 + a·s·k₁ + b·s²·k₂ + …, a, b, … from `first` on by `by`. */
static double series(const double *k, int n, double s, double first, double by) {
  double sum = 0.0;
  for (int i = n - 1; i >= 0; i--)
    sum = s * ((first + by * i) * k[i] + sum);
  return sum;
}

static double fisheye_radius(const conic_view_lens *lens, double angle) {
  return angle * (1.0 + series(lens->radial, 4, angle * angle, 1.0, 0.0));
}

static double fisheye_slope(const conic_view_lens *lens, double angle) {
  return 1.0 + series(lens->radial, 4, angle * angle, 3.0, 2.0);
}

/* Where the radius ceases to grow: with k4, by Newton's steps from 1.57; infinite where these find nothing. */
static double find_fold(const conic_view_lens *lens) {
  const double *k = lens->radial;
  double angle = 1.57;
  if (k[3] == 0.0) {
    conic_camera_rays rays;
    conic_camera_rays_init(lens->camera, &rays);
    return rays.most_radius;
  }
  for (int i = 0; i < FISHEYE_STEPS; i++) {
    const double s = angle * angle;
    const double bend = angle * (6.0 * k[0] + s * (20.0 * k[1] + s * (42.0 * k[2] + s * 72.0 * k[3])));
    const double step = fisheye_slope(lens, angle) / bend;
    angle -= step;
    if (fabs(step) < step_is_small)
      return angle > 0.0 ? angle : INFINITY;
  }
  return INFINITY;
}

static void take_fisheye(conic_view_lens *lens) {
  const conic_camera *c = lens->camera;
  const double x = c->width - c->cx > c->cx ? c->width - c->cx : c->cx;
  const double y = c->height - c->cy > c->cy ? c->height - c->cy : c->cy;
  const double focal = c->fx < c->fy ? c->fx : c->fy, corner = sqrt(x * x + y * y) / focal;
  const double across = 0.5 * c->width / c->fx, down = 0.5 * c->height / c->fy, fold = find_fold(lens);
  lens->most_angle = fold < corner ? fold : corner;
  lens->first_guess = lens->most_angle / (across > down ? across : down);
}

void conic_view_lens_init(const conic_camera *camera, conic_view_lens *lens) {
  static const int places[8] = {0, 1, 6, 7, 2, 3, 4, 5}; /* of OpenCV's numbers: k1 k2 p1 p2 k3 k4 k5 k6 */
  double numbers[8] = {0.0};
  for (int i = 0; i < 8 && camera->lens; i++)
    numbers[camera->lens == CONIC_LENS_OPENCV ? places[i] : i] = camera->distortion[i];
  *lens = (conic_view_lens){.camera = camera};
  memcpy(lens->radial, numbers, sizeof lens->radial);
  memcpy(lens->tangential, numbers + 6, sizeof lens->tangential);
  if (camera->kind == CONIC_CAMERA_FISHEYE)
    take_fisheye(lens);
}

static int show_by_fisheye(const conic_view_lens *lens, const double at[3], double normal[2]) {
  const double across = sqrt(at[0] * at[0] + at[1] * at[1]), angle = conic_angle(across, at[2]);
  const double seen = angle < lens->most_angle ? angle : lens->most_angle;
  const double radius = fisheye_radius(lens, seen);
  for (int axis = 0; axis < 2; axis++)
    normal[axis] = across > 0.0 ? radius * (at[axis] / across) : 0.0;
  return (across > 0.0 && !(radius > 0.0)) ? -1 : angle < lens->most_angle;
}

/* What a lens of OpenCV makes of a slope. `growth` is the part of its radius. */
static void distort(const conic_view_lens *lens, const double at[2], double *growth, double added[2]) {
  const double x = at[0], y = at[1], s = x * x + y * y, *p = lens->tangential;
  const double bottom = 1.0 + series(lens->radial + 3, 3, s, 1.0, 0.0);
  *growth = fabs(bottom) > least_bottom ? (1.0 + series(lens->radial, 3, s, 1.0, 0.0)) / bottom : 0.0;
  added[0] = 2.0 * p[0] * x * y + p[1] * (s + 2.0 * x * x);
  added[1] = p[0] * (s + 2.0 * y * y) + 2.0 * p[1] * x * y;
}

int conic_view_lens_show(const conic_view_lens *lens, const double at[3], double place[2]) {
  const conic_camera *c = lens->camera;
  double normal[2] = {0.0, 0.0}, growth, added[2];
  int is_seen = -1;
  if (at[2] > 0.0 && c->kind == CONIC_CAMERA_FISHEYE)
    is_seen = show_by_fisheye(lens, at, normal);
  else if (at[2] > 0.0) {
    const double slope[2] = {at[0] / at[2], at[1] / at[2]};
    distort(lens, slope, &growth, added);
    for (int axis = 0; axis < 2; axis++)
      normal[axis] = growth * slope[axis] + added[axis];
    is_seen = growth > least_growth;
  }
  place[0] = is_seen < 0 ? 0.0 : c->fx * normal[0] + c->cx;
  place[1] = is_seen < 0 ? 0.0 : c->fy * normal[1] + c->cy;
  return is_seen > 0;
}

static int ray_of_fisheye(const conic_view_lens *lens, const double at[2], double direction[3]) {
  const double radius = sqrt(at[0] * at[0] + at[1] * at[1]);
  double angle = lens->first_guess * radius, step = INFINITY;
  for (int i = 0; i < FISHEYE_STEPS && !(fabs(step) < step_is_small); i++) {
    step = (fisheye_radius(lens, angle) - radius) / fisheye_slope(lens, angle);
    angle -= step;
  }
  if (!(angle >= 0.0 && angle < lens->most_angle && fabs(step) < step_is_small))
    return 0;
  const double part = radius > 0.0 ? conic_sin(angle) / radius : 1.0;
  direction[0] = part * at[0];
  direction[1] = part * at[1];
  direction[2] = conic_cos(angle);
  return 1;
}

/* A step of Newton's towards what is distorted to `wanted`. Returns 0 where there is none. */
static int step_back(const conic_view_lens *lens, const double wanted[2], double at[2], double step[2]) {
  const double x = at[0], y = at[1], s = x * x + y * y, *k = lens->radial, *p = lens->tangential;
  const double top = 1.0 + series(k, 3, s, 1.0, 0.0), bottom = 1.0 + series(k + 3, 3, s, 1.0, 0.0);
  const double growth = top / bottom, by_top = k[0] + s * (2.0 * k[1] + s * 3.0 * k[2]);
  const double by_s = (by_top - growth * (k[3] + s * (2.0 * k[4] + s * 3.0 * k[5]))) / bottom;
  double added[2], unused;
  if (!(growth > 0.0))
    return 0;
  distort(lens, at, &unused, added);
  const double apart[2] = {growth * x + added[0] - wanted[0], growth * y + added[1] - wanted[1]};
  const double mixed = 2.0 * x * y * by_s + 2.0 * p[0] * x + 2.0 * p[1] * y;
  const double xx = growth + 2.0 * x * x * by_s + 2.0 * p[0] * y + 6.0 * p[1] * x;
  const double yy = growth + 2.0 * y * y * by_s + 2.0 * p[1] * x + 6.0 * p[0] * y;
  const double area = xx * yy - mixed * mixed;
  if (fabs(area) < least_area)
    return 0;
  step[0] = (mixed * apart[1] - yy * apart[0]) / area;
  step[1] = (mixed * apart[0] - xx * apart[1]) / area;
  at[0] += step[0];
  at[1] += step[1];
  return 1;
}

int conic_view_lens_ray(const conic_view_lens *lens, double x_px, double y_px, double direction[3]) {
  const conic_camera *c = lens->camera;
  const double wanted[2] = {(x_px - c->cx) / c->fx, (y_px - c->cy) / c->fy};
  double at[2] = {wanted[0], wanted[1]}, step[2] = {0.0, 0.0};
  int is_found = !c->lens;
  if (c->kind == CONIC_CAMERA_FISHEYE)
    return ray_of_fisheye(lens, wanted, direction);
  for (int i = 0; i < PINHOLE_STEPS && !is_found && step_back(lens, wanted, at, step); i++)
    is_found = fabs(step[0]) < step_is_small && fabs(step[1]) < step_is_small;
  direction[0] = at[0];
  direction[1] = at[1];
  direction[2] = 1.0;
  return is_found;
}
