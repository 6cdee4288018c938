#include "core/image/camera_rays.h"

#include "core/base/base.h"
#include "core/base/trigonometry.h"

enum { TOP = 5, BOTTOM = 4, FOLD = TOP + BOTTOM - 1 };

const double conic_cube_sides[CONIC_CUBE_SIDES][3][3] = {
    {{0, 0, 1}, {0, 1, 0}, {-1, 0, 0}}, {{0, 0, -1}, {0, 1, 0}, {1, 0, 0}}, {{-1, 0, 0}, {0, 0, -1}, {0, -1, 0}},
    {{-1, 0, 0}, {0, 0, 1}, {0, 1, 0}}, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},  {{-1, 0, 0}, {0, 1, 0}, {0, 0, -1}},
};

/* Slopes over this are 89.94° from the axis. */
static const double greatest_slope = 1000.0;

static double polynomial_at(const double *coefficients, int n, double s) {
  double sum = 0.0;
  for (int k = n - 1; k >= 0; k--)
    sum = sum * s + coefficients[k];
  return sum;
}

static double polynomial_slope(const double *coefficients, int n, double s) {
  double sum = 0.0;
  for (int k = n - 1; k >= 1; k--)
    sum = sum * s + k * coefficients[k];
  return sum;
}

/* The places between 0 and the limit where a polynomial of n coefficients changes its sign, in order: at most one
 * between two turning points. */
static int find_sign_changes(const double *coefficients, int n, double limit, double *places) {
  double slope[FOLD], turns[FOLD + 1];
  int n_places = 0, n_turns = 0;
  if (n < 2)
    return 0;
  for (int k = 1; k < n; k++)
    slope[k - 1] = k * coefficients[k];
  n_turns = find_sign_changes(slope, n - 1, limit, turns);
  turns[n_turns] = limit;
  for (int i = 0; i <= n_turns; i++) {
    double low = i ? turns[i - 1] : 0.0, high = turns[i];
    int is_above = polynomial_at(coefficients, n, low) > 0.0;
    if ((polynomial_at(coefficients, n, high) > 0.0) == is_above)
      continue;
    for (int step = 0; step < 100; step++) {
      double middle = 0.5 * (low + high);
      *((polynomial_at(coefficients, n, middle) > 0.0) == is_above ? &low : &high) = middle;
    }
    places[n_places++] = low;
  }
  return n_places;
}

/* Finds the radius up to which radius·top/bottom grows: its slope is (top + 2s·top')·bottom − 2s·top·bottom' over
 * bottom². */
static void find_growth(conic_camera_rays *r, double limit) {
  double fold[FOLD] = {0.0}, places[FOLD + 1], s = limit * limit;
  for (int i = 0; i < TOP; i++)
    for (int k = 0; k < BOTTOM; k++)
      fold[i + k] += (1 + 2 * i - 2 * k) * r->top[i] * r->bottom[k];
  if (find_sign_changes(fold, FOLD, s, places) > 0)
    s = places[0];
  if (find_sign_changes(r->bottom, BOTTOM, s, places) > 0)
    s = places[0] * (1.0 - 1e-9);
  r->most_radius = sqrt(s);
  r->most_place = r->most_radius * (polynomial_at(r->top, TOP, s) / polynomial_at(r->bottom, BOTTOM, s));
}

void conic_camera_rays_init(const conic_camera *camera, conic_camera_rays *r) {
  const double *k = camera->distortion;
  int is_fisheye = camera->kind == CONIC_CAMERA_FISHEYE;
  memset(r, 0, sizeof *r);
  r->camera = camera;
  r->is_pinhole = camera->kind == CONIC_CAMERA_PERSPECTIVE && camera->lens == CONIC_LENS_NONE;
  r->top[0] = r->bottom[0] = 1.0;
  if (camera->lens == CONIC_LENS_RADIAL) {
    memcpy(r->top + 1, k, 4 * sizeof *k);
  } else if (camera->lens == CONIC_LENS_OPENCV || camera->lens == CONIC_LENS_THIN_PRISM) {
    int is_prism = camera->lens == CONIC_LENS_THIN_PRISM;
    memcpy(r->top + 1, k, 2 * sizeof *k);
    memcpy(r->top + 3, k + 4, (is_prism ? 2 : 1) * sizeof *k);
    memcpy(is_prism ? r->prism : r->bottom + 1, k + (is_prism ? 6 : 5), (is_prism ? 2 : 3) * sizeof *k);
    memcpy(r->tangential, k + 2, 2 * sizeof *k);
  }
  r->is_bent = r->tangential[0] != 0.0 || r->tangential[1] != 0.0 || r->prism[0] != 0.0 || r->prism[1] != 0.0;
  find_growth(r, is_fisheye ? CONIC_PI : greatest_slope);
}

/* The radius that is distorted to `place`: by Newton's steps, or by halving the bracket where these leave it. */
static double undistort_radius(const conic_camera_rays *r, double place) {
  double low = 0.0, high = r->most_radius, radius = place < high ? place : high;
  for (int step = 0; step < 100; step++) {
    double s = radius * radius, top = polynomial_at(r->top, TOP, s), bottom = polynomial_at(r->bottom, BOTTOM, s);
    double slope_top = polynomial_slope(r->top, TOP, s), slope_bottom = polynomial_slope(r->bottom, BOTTOM, s);
    double slope = ((top + 2.0 * s * slope_top) * bottom - 2.0 * s * top * slope_bottom) / (bottom * bottom);
    double beyond = radius * (top / bottom) - place, next = radius - beyond / slope;
    *(beyond > 0.0 ? &high : &low) = radius;
    if (!(next > low && next < high))
      next = next == radius ? radius : 0.5 * (low + high);
    if (fabs(next - radius) <= 0x1p-52 * radius)
      return next;
    radius = next;
  }
  return radius;
}

/* What the lens makes of a place, minus the wanted one; and the four derivatives. */
static void distort_place(const conic_camera_rays *r, const double at[2], const double wanted[2], double apart[2],
                          double by[2][2]) {
  double a = at[0], b = at[1], s = a * a + b * b, p1 = r->tangential[0], p2 = r->tangential[1];
  double top = polynomial_at(r->top, TOP, s), bottom = polynomial_at(r->bottom, BOTTOM, s), grown = top / bottom;
  double slope = (polynomial_slope(r->top, TOP, s) - grown * polynomial_slope(r->bottom, BOTTOM, s)) / bottom;
  apart[0] = a * grown + 2.0 * p1 * a * b + p2 * (s + 2.0 * a * a) + r->prism[0] * s - wanted[0];
  apart[1] = b * grown + p1 * (s + 2.0 * b * b) + 2.0 * p2 * a * b + r->prism[1] * s - wanted[1];
  double mixed = 2.0 * a * b * slope + 2.0 * p1 * a + 2.0 * p2 * b;
  by[0][0] = grown + 2.0 * a * a * slope + 2.0 * p1 * b + 6.0 * p2 * a + 2.0 * r->prism[0] * a;
  by[0][1] = mixed + 2.0 * r->prism[0] * b;
  by[1][0] = mixed + 2.0 * r->prism[1] * a;
  by[1][1] = grown + 2.0 * b * b * slope + 6.0 * p1 * b + 2.0 * p2 * a + 2.0 * r->prism[1] * b;
}

/* Newton's steps, starting from the solution for the lens without its tangential part. */
static int undistort_bent(const conic_camera_rays *r, const double wanted[2], double at[2]) {
  enum { STEPS = 20 };
  double apart[2], by[2][2], area = 0.0, size = 1.0 + fabs(wanted[0]) + fabs(wanted[1]);
  for (int step = 0; step < STEPS; step++) {
    distort_place(r, at, wanted, apart, by);
    area = by[0][0] * by[1][1] - by[0][1] * by[1][0];
    if (!(area > 0.0))
      return 0;
    at[0] -= (by[1][1] * apart[0] - by[0][1] * apart[1]) / area;
    at[1] -= (by[0][0] * apart[1] - by[1][0] * apart[0]) / area;
  }
  distort_place(r, at, wanted, apart, by);
  return fabs(apart[0]) + fabs(apart[1]) <= 1e-13 * size &&
         at[0] * at[0] + at[1] * at[1] <= r->most_radius * r->most_radius;
}

/* The radius that a lens with a closed form distorts to `place`; negative where there is none. */
static double radius_of_place(const conic_camera *camera, double place) {
  const double *k = camera->distortion, s = place * place;
  if (camera->lens == CONIC_LENS_DIVISION)
    return fabs(k[0] * s) < 1.0 ? place / (1.0 + k[0] * s) : -1.0;
  if (camera->lens == CONIC_LENS_EUCM) {
    double root = 1.0 - (2.0 * k[0] - 1.0) * k[1] * s;
    double depth = (1.0 - k[0] * k[0] * k[1] * s) / (k[0] * sqrt(root > 0.0 ? root : 0.0) + 1.0 - k[0]);
    return root >= 0.0 && depth > 0.0 ? place / depth : -1.0;
  }
  if (!(fabs(place * k[0]) < 0.5 * CONIC_PI))
    return -1.0;
  return k[0] == 0.0 ? place : conic_tan(place * k[0]) / (2.0 * conic_tan(0.5 * k[0]));
}

static int undistort(const conic_camera_rays *r, double at[2]) {
  const double wanted[2] = {at[0], at[1]}, place = sqrt(at[0] * at[0] + at[1] * at[1]);
  if (r->camera->lens == CONIC_LENS_NONE || !(place > 0.0))
    return 1;
  const double radius = r->camera->lens >= CONIC_LENS_FOV ? radius_of_place(r->camera, place)
                        : place <= r->most_place          ? undistort_radius(r, place)
                                                          : -1.0;
  if (!(radius >= 0.0))
    return 0;
  for (int axis = 0; axis < 2; axis++)
    at[axis] = wanted[axis] * (radius / place);
  return !r->is_bent || undistort_bent(r, wanted, at);
}

/* Six pinholes, one below the other. */
static void ray_of_cube(const conic_camera *camera, double x_px, double y_px, double direction[3]) {
  int side = y_px > 0.0 ? (int)(y_px / camera->width) : 0;
  side = side < 5 ? side : 5;
  const double(*axes)[3] = conic_cube_sides[side];
  const double at[2] = {(x_px - camera->cx) / camera->fx,
                        (y_px - (double)side * camera->width - camera->cy) / camera->fy};
  for (int axis = 0; axis < 3; axis++)
    direction[axis] = (at[0] * axes[0][axis] + at[1] * axes[1][axis]) + axes[2][axis];
}

int conic_camera_ray_bent(const conic_camera_rays *r, double x_px, double y_px, double origin[3], double direction[3]) {
  const conic_camera *camera = r->camera;
  double at[2] = {(x_px - camera->cx) / camera->fx, (y_px - camera->cy) / camera->fy};
  origin[0] = origin[1] = origin[2] = direction[0] = direction[1] = 0.0;
  direction[2] = 1.0;
  if (camera->kind == CONIC_CAMERA_CUBE) {
    ray_of_cube(camera, x_px, y_px, direction);
    return 1;
  }
  if (!undistort(r, at))
    return 0;
  double radius = sqrt(at[0] * at[0] + at[1] * at[1]);
  if (camera->kind == CONIC_CAMERA_ORTHOGRAPHIC) {
    memcpy(origin, at, sizeof at);
  } else if (camera->kind == CONIC_CAMERA_PERSPECTIVE) {
    memcpy(direction, at, sizeof at);
  } else if (camera->kind == CONIC_CAMERA_FISHEYE) {
    double part = radius > 0.0 ? conic_sin(radius) / radius : 1.0;
    direction[0] = part * at[0];
    direction[1] = part * at[1];
    direction[2] = conic_cos(radius);
    return radius <= CONIC_PI;
  } else {
    direction[0] = conic_cos(at[1]) * conic_sin(at[0]);
    direction[1] = conic_sin(at[1]);
    direction[2] = conic_cos(at[1]) * conic_cos(at[0]);
    return fabs(at[0]) <= CONIC_PI && fabs(at[1]) <= 0.5 * CONIC_PI;
  }
  return 1;
}
