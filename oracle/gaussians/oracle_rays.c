/* Which ray goes through a pixel, for any camera: conic/camera.h once more, by halves of brackets. */
#include "oracle/gaussians/oracle_gaussian.h"
#include "oracle/gaussians/oracle_lens.h"
#include "oracle/oracle_math.h"

#define ORACLE_PI 3.14159265358979323846

/* Sine and cosine by their series of an eighth of the angle, which is then doubled. */
static void turn_angle(double angle, double *sine, double *cosine) {
  double x = angle / 8.0, term = x, s = x, versine = 0.0;
  for (int n = 1; n < 14; n++) {
    term *= -x * x / (2 * n * (2 * n + 1));
    s += term;
  }
  term = 1.0;
  for (int n = 1; n < 14; n++) {
    term *= -x * x / ((2 * n - 1) * (2 * n));
    versine -= term;
  }
  for (int k = 0; k < 3; k++) { /* sin 2x = 2·sin x·(1 − v), 1 − cos 2x = 2·sin² x */
    double square = 2.0 * s * s;
    s = 2.0 * s * (1.0 - versine);
    versine = square;
  }
  *sine = s;
  *cosine = 1.0 - versine;
}

/* The factor r of the lens at a squared radius; 0 beyond a pole. */
static double factor_of(const conic_camera *camera, double s) {
  const double *k = camera->distortion;
  if (camera->lens == CONIC_LENS_RADIAL)
    return 1.0 + s * k[0] + s * s * k[1] + s * s * s * k[2] + s * s * s * s * k[3];
  if (camera->lens == CONIC_LENS_THIN_PRISM)
    return 1.0 + s * k[0] + s * s * k[1] + s * s * s * k[4] + s * s * s * s * k[5];
  if (camera->lens == CONIC_LENS_DIVISION)
    return 4.0 * k[0] * s <= 1.0 ? 2.0 / (1.0 + sqrt(1.0 - 4.0 * k[0] * s)) : 0.0;
  if (camera->lens == CONIC_LENS_EUCM)
    return k[1] * s >= -1.0 ? 1.0 / (k[0] * sqrt(1.0 + k[1] * s) + 1.0 - k[0]) : 0.0;
  double below = 1.0 + s * k[5] + s * s * k[6] + s * s * s * k[7];
  return below > 0.0 ? (1.0 + s * k[0] + s * s * k[1] + s * s * s * k[4]) / below : 0.0;
}

/* The least radius that is distorted to `place`, as long as distorted radii grow; below 0 where there is none. Steps
 * outwards, each step a part of the way so far, then halves. */
static double find_radius(const conic_camera *camera, double place, double most) {
  double low = 0.0, step = place / 1024.0;
  for (double at_low = 0.0; low<most; step = low / 256.0> step ? low / 256.0 : step) {
    double high = oracle_min(low + step, most), at_high = high * factor_of(camera, high * high);
    if (!(at_high > at_low))
      return -1.0;
    if (at_high >= place) {
      for (int k = 0; k < 80; k++) {
        double middle = 0.5 * (low + high);
        *(middle * factor_of(camera, middle * middle) >= place ? &high : &low) = middle;
      }
      return high;
    }
    low = high;
    at_low = at_high;
  }
  return -1.0;
}

/* What else the lens adds, tangentially and as a prism. */
static void bend(const conic_camera *camera, const double at[2], double added[2]) {
  const double *k = camera->distortion, a = at[0], b = at[1], s = a * a + b * b;
  int is_prism = camera->lens == CONIC_LENS_THIN_PRISM;
  added[0] = 2.0 * k[2] * a * b + k[3] * (s + 2.0 * a * a) + (is_prism ? k[6] * s : 0.0);
  added[1] = k[2] * (s + 2.0 * b * b) + 2.0 * k[3] * a * b + (is_prism ? k[7] * s : 0.0);
}

static int straighten(const conic_camera *camera, double at[2]) {
  enum { ROUNDS = 400 };
  const double wanted[2] = {at[0], at[1]}, most = camera->kind == CONIC_CAMERA_FISHEYE ? ORACLE_PI : 1000.0;
  double target[2] = {at[0], at[1]}, added[2], sine, cosine, half_sine, half_cosine;
  if (camera->lens == CONIC_LENS_FOV) {
    double omega = camera->distortion[0], place = sqrt(at[0] * at[0] + at[1] * at[1]);
    turn_angle(place * omega, &sine, &cosine);
    turn_angle(0.5 * omega, &half_sine, &half_cosine);
    double radius = omega == 0.0 ? place : sine / cosine / (2.0 * (half_sine / half_cosine));
    for (int axis = 0; axis < 2 && place > 0.0; axis++)
      at[axis] *= radius / place;
    return fabs(place * omega) < 0.5 * ORACLE_PI;
  }
  int rounds = camera->lens == CONIC_LENS_OPENCV || camera->lens == CONIC_LENS_THIN_PRISM ? ROUNDS : 1;
  for (int round = 0; round < rounds; round++) { /* what is not radial, taken from the target again and again */
    double place = sqrt(target[0] * target[0] + target[1] * target[1]), change = 0.0;
    double radius = camera->lens && place > 0.0 ? find_radius(camera, place, most) : place;
    if (radius < 0.0)
      return 0;
    for (int axis = 0; axis < 2; axis++)
      at[axis] = place > 0.0 ? target[axis] / place * radius : 0.0;
    if (rounds == 1)
      return 1;
    bend(camera, at, added);
    for (int axis = 0; axis < 2; axis++) {
      change += fabs(wanted[axis] - added[axis] - target[axis]);
      target[axis] = wanted[axis] - added[axis];
    }
    if (change < 1e-15)
      return 1;
  }
  return 0;
}

int conic_oracle_pixel_ray(const conic_camera *camera, double x, double y, double origin[3], double direction[3]) {
  double at[2] = {(x - camera->cx) / camera->fx, (y - camera->cy) / camera->fy}, sine, cosine, sine_b, cosine_b;
  for (int axis = 0; axis < 3; axis++)
    origin[axis] = direction[axis] = 0.0;
  direction[2] = 1.0;
  if (!straighten(camera, at))
    return 0;
  double radius = sqrt(at[0] * at[0] + at[1] * at[1]);
  switch (camera->kind) {
  case CONIC_CAMERA_ORTHOGRAPHIC:
    origin[0] = at[0];
    origin[1] = at[1];
    return 1;
  case CONIC_CAMERA_FISHEYE:
    turn_angle(radius, &sine, &cosine);
    direction[0] = radius > 0.0 ? sine * at[0] / radius : 0.0;
    direction[1] = radius > 0.0 ? sine * at[1] / radius : 0.0;
    direction[2] = cosine;
    return radius <= ORACLE_PI;
  case CONIC_CAMERA_EQUIRECTANGULAR:
    turn_angle(at[0], &sine, &cosine);
    turn_angle(at[1], &sine_b, &cosine_b);
    direction[0] = cosine_b * sine;
    direction[1] = sine_b;
    direction[2] = cosine_b * cosine;
    return fabs(at[0]) <= ORACLE_PI && fabs(at[1]) <= 0.5 * ORACLE_PI;
  default:
    direction[0] = at[0];
    direction[1] = at[1];
    return 1;
  }
}

void conic_oracle_ray_row(const oracle_gaussian_view *view, size_t row, oracle_ray *rays) {
  for (int column = 0; column < view->camera->width; column++) {
    const double x = column + 0.5, y = (double)row + 0.5;
    oracle_ray *ray = &rays[column];
    oracle_sight sight;
    if (view->rules->shape != CONIC_SHAPE_SOLID) {
      ray->is_there = conic_oracle_pixel_ray(view->camera, x, y, ray->origin, ray->direction);
      continue;
    }
    conic_oracle_lens_see(view, x, y, 0.0, &sight);
    *ray = (oracle_ray){.is_there = sight.is_there};
    memcpy(ray->direction, sight.direction, sizeof ray->direction);
    memcpy(ray->origin, sight.origin, sizeof ray->origin);
  }
}
