/* A renderer of a single pixel of Gaussians whose floats round, fuse and order at random: every operation is off by up
 * to the unit roundoff, in a direction that chance or malice chooses. It shares no code with the library. */
#pragma once

#include "conic/gaussian_judge.h"
#include "tests/support/random_numbers.h"

typedef struct random_floats {
  uint64_t state;
  int manner; /* 0: nearest; 1: any within the unit; 2: the unit, up or down; 3: always up; 4: always down */
  int is_fused, is_setup_in_float;
  double exp_off; /* error of eˣ as a share, for x = 0; */
  double exp_by_argument;
} random_floats;

/* What one pixel came to. */
typedef struct random_pixel {
  double rgb[3], T, z, inverse_z;
  int count;
} random_pixel;

static inline double random_rounding(random_floats *f, double v, double unit) {
  switch (f->manner) {
  case 0:
    return unit > 1e-10 ? (double)(float)v : v;
  case 1:
    return v * (1.0 + unit * (2.0 * random_unit(&f->state) - 1.0));
  case 2:
    return v * (1.0 + (random_unit(&f->state) < 0.5 ? unit : -unit));
  default:
    return v * (1.0 + (f->manner == 3 ? unit : -unit));
  }
}
/* Of the set-up, and of a pixel. */
static inline double rs(random_floats *f, double v) {
  return random_rounding(f, v, f->is_setup_in_float ? 0x1p-24 : 0x1p-53);
}
static inline double rp(random_floats *f, double v) {
  return random_rounding(f, v, 0x1p-24);
}
static inline double r_stored(random_floats *f, double v) {
  return rp(f, v);
}
/* A product that is added to something: perhaps fused. */
static inline double r_product(random_floats *f, double v) {
  return f->is_fused && random_unit(&f->state) < 0.5 ? v : rp(f, v);
}

static inline double random_sum3(random_floats *f, double a, double b, double c) {
  switch ((int)(3.0 * random_unit(&f->state))) {
  case 0:
    return rp(f, rp(f, a + b) + c);
  case 1:
    return rp(f, a + rp(f, b + c));
  default:
    return rp(f, rp(f, a + c) + b);
  }
}

static inline double random_dot(random_floats *f, const double a[3], const double b[3]) {
  return rs(f, rs(f, rs(f, a[0] * b[0]) + rs(f, a[1] * b[1])) + rs(f, a[2] * b[2]));
}

static inline double random_exp(random_floats *f, double x) {
  double off = f->exp_off + f->exp_by_argument * fabs(x);
  double share = f->manner == 3 ? 1.0 : f->manner == 4 ? -1.0 : 2.0 * random_unit(&f->state) - 1.0;
  return exp(x) * (1.0 + off * share);
}

/* A Gaussian as it is set up. */
typedef struct random_gaussian {
  double place[2], form[3], opacity, color[3], z, key;
  double g[3][3], c[3][3], e[3], pixel[2]; /* of rays */
} random_gaussian;

static inline void random_rotation(random_floats *f, const conic_gaussians *set, size_t i, double r[3][3]) {
  double q[4], squares = 0.0;
  for (int k = 0; k < 4; k++) {
    q[k] = (double)set->rotation[k][i];
    squares = rs(f, squares + rs(f, q[k] * q[k]));
  }
  double one_over = rs(f, 1.0 / rs(f, sqrt(squares)));
  for (int k = 0; k < 4; k++)
    q[k] = rs(f, q[k] * one_over);
  double w = q[0], x = q[1], y = q[2], z = q[3];
  const double doubles[3][3] = {
      {rs(f, rs(f, y * y) + rs(f, z * z)), rs(f, rs(f, x * y) - rs(f, w * z)), rs(f, rs(f, x * z) + rs(f, w * y))},
      {rs(f, rs(f, x * y) + rs(f, w * z)), rs(f, rs(f, x * x) + rs(f, z * z)), rs(f, rs(f, y * z) - rs(f, w * x))},
      {rs(f, rs(f, x * z) - rs(f, w * y)), rs(f, rs(f, y * z) + rs(f, w * x)), rs(f, rs(f, x * x) + rs(f, y * y))}};
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 3; b++)
      r[a][b] = a == b ? rs(f, 1.0 - 2.0 * doubles[a][b]) : 2.0 * doubles[a][b];
}

/* Degree 0 and 1, which is enough for a direction to matter. */
static inline void random_color(random_floats *f, const conic_gaussians *set, size_t i, const double eye[3],
                                double color[3]) {
  double d[3], length;
  for (int k = 0; k < 3; k++)
    d[k] = rs(f, set->origin[k] + (double)set->position[k][i] - eye[k]);
  length = rs(f, sqrt(random_dot(f, d, d)));
  for (int k = 0; k < 3; k++)
    d[k] = rs(f, d[k] / length);
  const double y[4] = {0.28209479177387814, -0.48860251190291992 * d[1], 0.48860251190291992 * d[2],
                       -0.48860251190291992 * d[0]};
  for (size_t c = 0; c < 3; c++) {
    double sum = 0.0;
    for (size_t k = 0; k < (size_t)(set->sh_degree + 1) * (size_t)(set->sh_degree + 1); k++)
      sum = rp(f, sum + r_product(f, rp(f, y[k]) * (double)set->sh[(i * 4 + k) * 3 + c]));
    sum = rp(f, sum + 0.5);
    color[c] = sum > 0.0 ? sum : 0.0;
  }
}

/* By way of the covariance in space, as programs in float do; with a set-up in double, that is no matter. */
static inline void random_ellipse(random_floats *f, const conic_gaussians *set, size_t i, const conic_camera *camera,
                                  const double p[3], int is_khr, int is_compensated, random_gaussian *g) {
  const double focal[2] = {camera->fx, camera->fy}, size[2] = {camera->width, camera->height};
  const double center[2] = {camera->cx, camera->cy}, h = is_khr ? 0.0 : 0.3;
  double r[3][3], sigma[3][3], half[3][3], view[3][3], rows[2][3], c[2][2];
  random_rotation(f, set, i, r);
  for (int a = 0; a < 3; a++)
    for (int k = 0; k < 3; k++)
      half[a][k] = rs(f, r[a][k] * (double)set->scale[k][i]);
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 3; b++)
      sigma[a][b] = random_dot(f, half[a], half[b]);
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 3; b++)
      half[a][b] = random_dot(f, camera->cam_from_world[a], sigma[b]);
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 3; b++)
      view[a][b] = random_dot(f, half[a], camera->cam_from_world[b]);
  for (int axis = 0; axis < 2; axis++) {
    double slope = rs(f, p[axis] / p[2]), limit = 0.15 * size[axis] / focal[axis];
    g->place[axis] = rs(f, rs(f, focal[axis] * slope) + center[axis]);
    double low = -(center[axis] / focal[axis] + limit), high = (size[axis] - center[axis]) / focal[axis] + limit;
    if (!is_khr)
      slope = slope < low ? rs(f, low) : slope > high ? rs(f, high) : slope;
    double gain = rs(f, focal[axis] / p[2]);
    rows[axis][0] = axis == 0 ? gain : 0.0;
    rows[axis][1] = axis == 1 ? gain : 0.0;
    rows[axis][2] = rs(f, -gain * slope);
  }
  for (int a = 0; a < 2; a++)
    for (int b = 0; b < 2; b++) {
      double column[3];
      for (int k = 0; k < 3; k++)
        column[k] = random_dot(f, view[k], rows[b]);
      c[a][b] = random_dot(f, rows[a], column);
    }
  double bare = rs(f, rs(f, c[0][0] * c[1][1]) - rs(f, c[0][1] * c[0][1]));
  c[0][0] = rs(f, c[0][0] + h);
  c[1][1] = rs(f, c[1][1] + h);
  double wide = rs(f, rs(f, c[0][0] * c[1][1]) - rs(f, c[0][1] * c[0][1]));
  double share = rs(f, bare / wide);
  if (is_compensated)
    g->opacity = rs(f, g->opacity * rs(f, sqrt(share > 2.5e-5 ? share : 2.5e-5)));
  g->form[0] = r_stored(f, c[1][1] / wide);
  g->form[1] = r_stored(f, -c[0][1] / wide);
  g->form[2] = r_stored(f, c[0][0] / wide);
}

/* The ray, set up in double about the pixel that holds the mean. */
static inline void random_ray(random_floats *f, const conic_gaussians *set, size_t i, const conic_camera *camera,
                              const double p[3], random_gaussian *g) {
  double r[3][3], m[3], steps[3][3], rows[3][3], longest = 0.0;
  random_rotation(f, set, i, r);
  g->pixel[0] = floor(camera->fx * p[0] / p[2] + camera->cx) + 0.5;
  g->pixel[1] = floor(camera->fy * p[1] / p[2] + camera->cy) + 0.5;
  const double rays[3][3] = {{(g->pixel[0] - camera->cx) / camera->fx, (g->pixel[1] - camera->cy) / camera->fy, 1.0},
                             {1.0 / camera->fx, 0.0, 0.0},
                             {0.0, 1.0 / camera->fy, 0.0}};
  for (int k = 0; k < 3; k++) {
    double axis[3];
    for (int row = 0; row < 3; row++) {
      const double column[3] = {r[0][k], r[1][k], r[2][k]};
      axis[row] = random_dot(f, camera->cam_from_world[row], column);
    }
    m[k] = rs(f, random_dot(f, axis, p) / (double)set->scale[k][i]);
    for (int step = 0; step < 3; step++)
      rows[step][k] = rs(f, random_dot(f, axis, rays[step]) / (double)set->scale[k][i]);
  }
  for (int step = 0; step < 3; step++) {
    for (int k = 0; k < 3; k++)
      steps[step][k] = rows[step][(k + 1) % 3] * m[(k + 2) % 3] - rows[step][(k + 2) % 3] * m[(k + 1) % 3];
    double length = sqrt(rows[step][0] * rows[step][0] + rows[step][1] * rows[step][1] + rows[step][2] * rows[step][2]);
    longest = length > longest ? length : longest;
  }
  for (int step = 0; step < 3; step++) {
    for (int k = 0; k < 3; k++) {
      g->g[step][k] = r_stored(f, rows[step][k] / longest);
      g->c[step][k] = r_stored(f, steps[step][k] / longest);
    }
    g->e[step] = r_stored(f, random_dot(f, rows[step], m) / longest / longest);
  }
}

static inline double random_affine(random_floats *f, double at, double by_x, double by_y, double dx, double dy) {
  return random_sum3(f, at, r_product(f, by_x * dx), r_product(f, by_y * dy));
}

static inline void random_meet(random_floats *f, int is_ray, const random_gaussian *g, double x, double y,
                               double *half_q, double *z) {
  if (is_ray) {
    double dx = x - g->pixel[0], dy = y - g->pixel[1], a[3], b[3];
    for (int k = 0; k < 3; k++) {
      a[k] = random_affine(f, g->g[0][k], g->g[1][k], g->g[2][k], dx, dy);
      b[k] = random_affine(f, g->c[0][k], g->c[1][k], g->c[2][k], dx, dy);
    }
    double one_over = rp(f, 1.0 / random_sum3(f, r_product(f, a[0] * a[0]), r_product(f, a[1] * a[1]), a[2] * a[2]));
    *half_q = 0.5 * rp(f, random_sum3(f, b[0] * b[0], r_product(f, b[1] * b[1]), b[2] * b[2]) * one_over);
    *z = rp(f, random_affine(f, g->e[0], g->e[1], g->e[2], dx, dy) * one_over);
    return;
  }
  double dx = rp(f, x - g->place[0]), dy = rp(f, y - g->place[1]);
  *half_q = random_sum3(f, 0.5 * r_product(f, rp(f, g->form[0] * dx) * dx),
                        0.5 * r_product(f, g->form[2] * rp(f, dy * dy)), r_product(f, rp(f, g->form[1] * dx) * dy));
  *z = g->z;
}

enum { MOST_RANDOM_GAUSSIANS = 64 };

typedef struct random_hit {
  double key, z, alpha;
  size_t index;
} random_hit;

static inline int random_compare(const void *a, const void *b) {
  const random_hit *x = a, *y = b;
  if (x->key != y->key)
    return x->key > y->key ? 1 : -1;
  return (x->index > y->index) - (x->index < y->index);
}

static inline void random_composite(random_floats *f, const random_hit *hits, size_t n, const random_gaussian *all,
                                    double stop, int is_left_out, random_pixel *pixel) {
  double T = 1.0, sum = 0.0, sum_z = 0.0, weights[MOST_RANDOM_GAUSSIANS];
  *pixel = (random_pixel){.T = 1.0};
  for (size_t i = 0; i < n; i++) {
    double after = rp(f, T * rp(f, 1.0 - hits[i].alpha));
    if (stop > 0.0 && (after < stop || (is_left_out && after == stop)))
      break;
    weights[pixel->count++] = rp(f, hits[i].alpha * T);
    T = after;
  }
  for (int k = 0; k < pixel->count; k++) {
    const int i = f->is_setup_in_float && !f->is_fused ? pixel->count - 1 - k : k; /* others may sum from the back */
    const double w = weights[i];
    for (int c = 0; c < 3; c++)
      pixel->rgb[c] = rp(f, pixel->rgb[c] + r_product(f, w * all[hits[i].index].color[c]));
    sum = rp(f, sum + w);
    sum_z = rp(f, sum_z + r_product(f, w * hits[i].z));
    pixel->inverse_z = rp(f, pixel->inverse_z + rp(f, w / hits[i].z));
  }
  pixel->T = T;
  pixel->z = sum > 0.0 ? rp(f, sum_z / sum) : 0.0;
}

/* Draws a pixel's centre (x, y) of the profiles exact, gsplat-1.6, gsplat-1.6-aa and khr-2026. */
static inline random_pixel random_draw(random_floats *f, const conic_gaussians *set, const conic_camera *camera,
                                       conic_gaussian_profile profile, double x, double y) {
  const int is_ray = profile == CONIC_PROFILE_EXACT, is_khr = profile == CONIC_PROFILE_KHR_2026;
  const double most = is_khr ? 1.0 : (double)0.99f, least = is_khr ? 0.0 : (double)(1.0f / 255.0f);
  random_gaussian all[MOST_RANDOM_GAUSSIANS];
  random_hit hits[MOST_RANDOM_GAUSSIANS];
  random_pixel pixel;
  double eye[3];
  size_t n = 0;
  for (int axis = 0; axis < 3; axis++) {
    eye[axis] = 0.0;
    for (int row = 0; row < 3; row++)
      eye[axis] -= camera->cam_from_world[row][axis] * camera->cam_from_world[row][3];
    eye[axis] = is_ray ? eye[axis] : (double)(float)eye[axis];
  }
  for (size_t i = 0; i < set->count; i++) {
    random_gaussian *g = &all[i];
    double p[3], mean[3], half_q, z;
    for (int axis = 0; axis < 3; axis++)
      mean[axis] = set->origin[axis] + (double)set->position[axis][i];
    for (int row = 0; row < 3; row++)
      p[row] = rs(f, random_dot(f, camera->cam_from_world[row], mean) + camera->cam_from_world[row][3]);
    g->opacity = (double)set->opacity[i];
    if (is_ray)
      random_ray(f, set, i, camera, p, g);
    else
      random_ellipse(f, set, i, camera, p, is_khr, profile == CONIC_PROFILE_GSPLAT_1_6_AA, g);
    g->opacity = r_stored(f, g->opacity);
    g->z = r_stored(f, p[2]);
    random_color(f, set, i, eye, g->color);
    random_meet(f, is_ray, g, x, y, &half_q, &z);
    double alpha = rp(f, g->opacity * random_exp(f, -half_q));
    alpha = alpha < most ? alpha : most;
    if (z <= 0.0 || half_q < 0.0 || alpha < least || (is_khr && half_q > 4.5))
      continue;
    double distance = rs(f, sqrt(random_dot(f, p, p)));
    hits[n++] = (random_hit){(double)(float)(is_ray ? z : is_khr ? distance : p[2]), z, alpha, i};
  }
  qsort(hits, n, sizeof *hits, random_compare);
  random_composite(f, hits, n, all, is_khr ? 0.0 : (double)1e-4f, !is_ray, &pixel);
  return pixel;
}
