/* The derivative of a picture against central differences of this test's own picture, which is written in other
 * formulas and keeps to the decisions that conic explain tells of each pixel. */
#include "conic/gaussian_gradient.h"
#include "conic/gaussian_oracle.h"
#include "core/splats/gaussian_profile.h"
#include "tests/support/check.h"
#include "tests/support/gaussian_fixture.h"

enum { WIDTH = 11, HEIGHT = 9, N_PIXELS = WIDTH * HEIGHT, N = 8, MOST_SH = 75, ROW = 11 + MOST_SH, N_CAMERA = 16 };
enum { CAMERA_AT = N * ROW, N_NUMBERS = CAMERA_AT + N_CAMERA };
enum { MEAN = 0, SCALE = 3, TURN = 6, OPACITY = 10, SH = 11 };

/* What does not change while numbers do. */
typedef struct frozen {
  conic_gaussian_profile profile;
  int degree, n[N_PIXELS], order[N_PIXELS][N], is_most[N_PIXELS][N];
  int slope_side[N][2], is_dark[N][3], is_least[N];
  double eye_off[3], length[N], weights[N_PIXELS][5]; /* length: that quaternions are brought to */
  float background[3];
} frozen;

static int is_named(const frozen *f) {
  return f->profile != CONIC_PROFILE_EXACT;
}

static const conic_profile_row *row_of(const frozen *f) {
  return conic_profile_row_of(f->profile);
}

static double dilation_of(const frozen *f) {
  return row_of(f)->dilation;
}

/* Of x, y, z of unit length, as the usual tables have them. */
static void harmonic_table(int degree, const double d[3], double *y) {
  const double x = d[0], v = d[1], z = d[2], xx = x * x, yy = v * v, zz = z * z;
  const double all[25] = {0.28209479177387814,
                          -0.4886025119029199 * v,
                          0.4886025119029199 * z,
                          -0.4886025119029199 * x,
                          1.0925484305920792 * x * v,
                          -1.0925484305920792 * v * z,
                          0.31539156525252005 * (2.0 * zz - xx - yy),
                          -1.0925484305920792 * x * z,
                          0.5462742152960396 * (xx - yy),
                          -0.5900435899266435 * v * (3.0 * xx - yy),
                          2.890611442640554 * x * v * z,
                          -0.4570457994644658 * v * (4.0 * zz - xx - yy),
                          0.3731763325901154 * z * (2.0 * zz - 3.0 * xx - 3.0 * yy),
                          -0.4570457994644658 * x * (4.0 * zz - xx - yy),
                          1.445305721320277 * z * (xx - yy),
                          -0.5900435899266435 * x * (xx - 3.0 * yy),
                          2.5033429417967046 * x * v * (xx - yy),
                          -1.7701307697799304 * v * z * (3.0 * xx - yy),
                          0.9461746957575601 * x * v * (7.0 * zz - 1.0),
                          -0.6690465435572892 * v * z * (7.0 * zz - 3.0),
                          0.10578554691520431 * (zz * (35.0 * zz - 30.0) + 3.0),
                          -0.6690465435572892 * x * z * (7.0 * zz - 3.0),
                          0.47308734787878004 * (xx - yy) * (7.0 * zz - 1.0),
                          -1.7701307697799304 * x * z * (xx - 3.0 * yy),
                          0.6258357354491761 * (xx * (xx - 3.0 * yy) - yy * (3.0 * xx - yy))};
  memcpy(y, all, (size_t)((degree + 1) * (degree + 1)) * sizeof *y);
}

/* −M⁻¹t by Cramer's rule, M of the camera's rows. */
static void eye_of(const double *c, double eye[3]) {
  double cofactor[3][3], determinant = 0.0;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      cofactor[i][j] = c[4 * i1 + j1] * c[4 * i2 + j2] - c[4 * i1 + j2] * c[4 * i2 + j1];
    }
  for (int j = 0; j < 3; j++)
    determinant += c[j] * cofactor[0][j];
  for (int j = 0; j < 3; j++) {
    eye[j] = 0.0;
    for (int i = 0; i < 3; i++)
      eye[j] -= cofactor[i][j] * c[4 * i + 3] / determinant;
  }
}

typedef struct seen {
  double place[2], form[3], opacity, color[3], z; /* form: 00, 01, 11 of the inverse covariance */
  double precision[3][3], mean[3];                /* in camera space */
} seen;

static double quaternion_length(const double q[4]) {
  return sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
}

static void covariance_by_turning(const frozen *f, int i_gaussian, const double *g, const double *c, double power,
                                  double spread[3][3]) {
  double q[4], r[3][3], turned[3][3];
  for (int k = 0; k < 4; k++)
    q[k] = g[TURN + k] / quaternion_length(g + TURN) * f->length[i_gaussian];
  for (int column = 0; column < 3; column++) { /* q e q*, e a unit vector */
    double e[3] = {0.0, 0.0, 0.0}, t[3];
    e[column] = 1.0;
    for (int k = 0; k < 3; k++)
      t[k] = 2.0 * (q[1 + (k + 1) % 3] * e[(k + 2) % 3] - q[1 + (k + 2) % 3] * e[(k + 1) % 3]);
    for (int k = 0; k < 3; k++)
      r[k][column] = e[k] + q[0] * t[k] + q[1 + (k + 1) % 3] * t[(k + 2) % 3] - q[1 + (k + 2) % 3] * t[(k + 1) % 3];
  }
  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++)
      turned[i][k] = c[4 * i] * r[0][k] + c[4 * i + 1] * r[1][k] + c[4 * i + 2] * r[2][k];
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      spread[i][j] = 0.0;
      for (int k = 0; k < 3; k++)
        spread[i][j] += turned[i][k] * turned[j][k] * pow(g[SCALE + k], power);
    }
}

static double clamped_slope(const frozen *f, const double *c, int axis, int side, double inside) {
  const double size = axis ? HEIGHT : WIDTH, focal = c[12 + axis], center = c[14 + axis];
  if (side == 0)
    return inside;
  if (row_of(f)->takes_middle)
    return side * 0.65 * size / focal;
  return side < 0 ? -(center + 0.15 * size) / focal : (size - center + 0.15 * size) / focal;
}

static void see_color(frozen *f, const double *g, const double *c, int i, int is_first, seen *s) {
  double eye[3], d[3], length = 0.0, y[25];
  eye_of(c, eye);
  for (int k = 0; k < 3; k++) {
    if (is_first)
      f->eye_off[k] = is_named(f) ? (double)(float)eye[k] - eye[k] : 0.0;
    d[k] = g[MEAN + k] - eye[k] - f->eye_off[k];
    length += d[k] * d[k];
  }
  for (int k = 0; k < 3; k++)
    d[k] /= sqrt(length);
  harmonic_table(f->degree, d, y);
  for (int channel = 0; channel < 3; channel++) {
    double sum = 0.5;
    for (int k = 0; k < (f->degree + 1) * (f->degree + 1); k++)
      sum += y[k] * g[SH + 3 * k + channel];
    if (is_first)
      f->is_dark[i][channel] = sum < 0.0;
    s->color[channel] = f->is_dark[i][channel] ? 0.0 : sum;
  }
}

static void see_ellipse(frozen *f, const double *g, const double *c, int i, int is_first, seen *s) {
  const double z = s->mean[2], h = dilation_of(f);
  double spread[3][3], jacobian[2][3], cov[2][2] = {{h, 0.0}, {0.0, h}};
  covariance_by_turning(f, i, g, c, 2.0, spread);
  for (int axis = 0; axis < 2; axis++) {
    const double slope = s->mean[axis] / z,
                 center = row_of(f)->takes_middle ? 0.5 * (axis ? HEIGHT : WIDTH) : c[14 + axis];
    s->place[axis] = c[12 + axis] * slope + center;
    if (is_first && h > 0.0)
      f->slope_side[i][axis] = slope > clamped_slope(f, c, axis, 1, 0.0)    ? 1
                               : slope < clamped_slope(f, c, axis, -1, 0.0) ? -1
                                                                            : 0;
    for (int k = 0; k < 3; k++)
      jacobian[axis][k] = k == axis ? c[12 + axis] / z : 0.0;
    jacobian[axis][2] = -c[12 + axis] / z * clamped_slope(f, c, axis, f->slope_side[i][axis], slope);
  }
  for (int a = 0; a < 2; a++)
    for (int b = 0; b < 2; b++)
      for (int k = 0; k < 3; k++)
        for (int l = 0; l < 3; l++)
          cov[a][b] += jacobian[a][k] * spread[k][l] * jacobian[b][l];
  const double det = cov[0][0] * cov[1][1] - cov[0][1] * cov[0][1];
  const double bare = (cov[0][0] - h) * (cov[1][1] - h) - cov[0][1] * cov[0][1];
  s->form[0] = cov[1][1] / det;
  s->form[1] = -cov[0][1] / det;
  s->form[2] = cov[0][0] / det;
  const double least = row_of(f)->compensation_least;
  if (least < 0.0)
    return;
  if (is_first)
    f->is_least[i] = bare / det < least;
  s->opacity *= sqrt(f->is_least[i] ? least : bare / det);
}

static void see_gaussian(frozen *f, const double *p, int i, int is_first, seen *s) {
  const double *g = p + i * ROW, *c = p + CAMERA_AT;
  for (int k = 0; k < 3; k++)
    s->mean[k] = c[4 * k] * g[0] + c[4 * k + 1] * g[1] + c[4 * k + 2] * g[2] + c[4 * k + 3];
  if (is_first) /* inria's program takes what is nearly a unit as it is */
    f->length[i] = row_of(f)->takes_rotation_as_is ? quaternion_length(g + TURN) : 1.0;
  s->opacity = g[OPACITY];
  s->z = s->mean[2];
  see_color(f, g, c, i, is_first, s);
  if (f->profile == CONIC_PROFILE_EXACT)
    covariance_by_turning(f, i, g, c, -2.0, s->precision);
  else
    see_ellipse(f, g, c, i, is_first, s);
}

/* q and z where the ray's response is greatest. */
static double along_ray(const seen *s, const double *c, double x, double y, double *z) {
  const double d[3] = {(x - c[14]) / c[12], (y - c[15]) / c[13], 1.0};
  double dd = 0.0, dm = 0.0, mm = 0.0;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      dd += d[i] * s->precision[i][j] * d[j];
      dm += d[i] * s->precision[i][j] * s->mean[j];
      mm += s->mean[i] * s->precision[i][j] * s->mean[j];
    }
  *z = dm / dd;
  return mm - dm * dm / dd;
}

static double frozen_alpha(const frozen *f, const seen *s, const double *c, int pixel, int k, double *z) {
  const double x = pixel % WIDTH + 0.5, y = pixel / WIDTH + 0.5, dx = x - s->place[0], dy = y - s->place[1];
  double q;
  *z = s->z;
  if (f->profile == CONIC_PROFILE_EXACT)
    q = along_ray(s, c, x, y, z);
  else
    q = s->form[0] * dx * dx + 2.0 * s->form[1] * dx * dy + s->form[2] * dy * dy;
  return f->is_most[pixel][k] ? row_of(f)->alpha_most : s->opacity * exp(-0.5 * q);
}

static double loss_of(frozen *f, const double *p, int is_first) {
  seen all[N];
  double loss = 0.0;
  for (int i = 0; i < N; i++)
    see_gaussian(f, p, i, is_first, &all[i]);
  for (int pixel = 0; pixel < N_PIXELS; pixel++) {
    const double *w = f->weights[pixel];
    double T = 1.0, sum = 0.0, sum_of_z = 0.0, rgb[3] = {0.0, 0.0, 0.0}, z;
    for (int k = 0; k < f->n[pixel]; k++) {
      const seen *s = &all[f->order[pixel][k]];
      double alpha = frozen_alpha(f, s, p + CAMERA_AT, pixel, k, &z);
      for (int c = 0; c < 3; c++)
        rgb[c] += alpha * T * s->color[c];
      sum += alpha * T;
      sum_of_z += alpha * T * z;
      T *= 1.0 - alpha;
    }
    for (int c = 0; c < 3; c++)
      loss += w[c] * (rgb[c] + T * (double)f->background[c]);
    loss += w[3] * (1.0 - T) + (sum > 0.0 ? w[4] * sum_of_z / sum : 0.0);
  }
  return loss;
}

/* --- the scenes --- */

static conic_camera tilted_camera(void) {
  const double a = 0.3, b = -0.2, ca = cos(a), sa = sin(a), cb = cos(b), sb = sin(b);
  conic_camera camera = {.width = WIDTH, .height = HEIGHT, .fx = 12.5, .fy = 11.25, .cx = 5.75, .cy = 4.25};
  const double rows[3][4] = {{ca, 0.0, sa, 0.125}, {sa * sb, cb, -ca * sb, -0.25}, {-sa * cb, sb, ca * cb, 3.5}};
  memcpy(camera.cam_from_world, rows, sizeof rows);
  return camera;
}

/* One is opaque, one dark, one far to the side, one a speck that compensation leaves its least; one stands in two. */
static conic_gaussians clamped_scene(conic_context *context, conic_gaussian_profile profile, int degree,
                                     const conic_camera *camera) {
  conic_gaussians scene = gaussians_random(context, N, degree, 0);
  const size_t n_sh = conic_harmonics_of_degree(degree);
  for (size_t i = 0; i < N; i++)
    for (int k = 0; k < 3; k++) {
      scene.position[k][i] *= k == 2 ? 0.5f : 0.3f;
      scene.scale[k][i] += 0.1f;
      scene.rotation[k][i] *= conic_profile_row_of(profile)->takes_rotation_as_is ? 1.0f : 1.5f;
    }
  scene.opacity[0] = 1.0f;
  for (int k = 0; k < 3; k++)
    scene.position[k][0] = 0.1f;
  scene.sh[n_sh] = scene.sh[n_sh + 1] = -3.0f;
  for (int k = 0; k < 3; k++) { /* in camera space (3.2, −2.4, 3.6) */
    const double at[3] = {3.2 - camera->cam_from_world[0][3], -2.4 - camera->cam_from_world[1][3],
                          3.6 - camera->cam_from_world[2][3]};
    double place = 0.0;
    for (int row = 0; row < 3; row++)
      place += camera->cam_from_world[row][k] * at[row];
    scene.position[k][2] = (float)place;
    scene.scale[k][2] = 0.9f;
    if (profile == CONIC_PROFILE_GSPLAT_1_6_AA)
      scene.scale[k][3] = k ? 0.001f : 0.05f;
  }
  scene.opacity[3] = 0.99f;
  return scene;
}

static void list_numbers(const conic_gaussians *scene, const conic_camera *camera, double *p) {
  const size_t n_sh = conic_harmonics_of_degree(scene->sh_degree);
  memset(p, 0, N_NUMBERS * sizeof *p);
  for (size_t i = 0; i < N; i++) {
    for (int k = 0; k < 4; k++) {
      p[i * ROW + TURN + (size_t)k] = (double)scene->rotation[k][i];
      if (k == 3)
        continue;
      p[i * ROW + MEAN + (size_t)k] = (double)scene->position[k][i];
      p[i * ROW + SCALE + (size_t)k] = (double)scene->scale[k][i];
    }
    p[i * ROW + OPACITY] = (double)scene->opacity[i];
    for (size_t k = 0; k < n_sh; k++)
      p[i * ROW + SH + k] = (double)scene->sh[i * n_sh + k];
  }
  memcpy(p + CAMERA_AT, camera->cam_from_world, 12 * sizeof *p);
  const double numbers[4] = {camera->fx, camera->fy, camera->cx, camera->cy};
  memcpy(p + CAMERA_AT + 12, numbers, sizeof numbers);
}

static double gradient_number(const conic_gaussian_gradient *g, size_t at) {
  const size_t n_sh = conic_harmonics_of_degree(g->sh_degree), i = at / ROW, k = at % ROW;
  if (at >= CAMERA_AT) {
    const size_t c = at - CAMERA_AT;
    const double rest[4] = {g->fx, g->fy, g->cx, g->cy};
    return c < 12 ? g->cam_from_world[c / 4][c % 4] : rest[c - 12];
  }
  return k < SCALE     ? g->mean[k][i]
         : k < TURN    ? g->scale[k - SCALE][i]
         : k < OPACITY ? g->rotation[k - TURN][i]
         : k < SH      ? g->opacity[i]
                       : g->sh[i * n_sh + k - SH];
}

static void freeze(conic_context *context, const conic_gaussians *scene, const conic_camera *camera,
                   const conic_gaussian_options *options, frozen *f) {
  for (int pixel = 0; pixel < N_PIXELS; pixel++) {
    conic_gaussian_listing listing;
    CHECK_OK(
        conic_gaussian_explain(context, scene, camera, options, NULL, NULL, pixel % WIDTH, pixel / WIDTH, &listing));
    f->n[pixel] = 0;
    for (size_t k = 0; k < listing.n; k++)
      if (listing.entries[k].part == CONIC_PART_COMPOSITED) {
        f->is_most[pixel][f->n[pixel]] = listing.entries[k].alpha == (double)(float)listing.entries[k].alpha;
        f->order[pixel][f->n[pixel]++] = (int)listing.entries[k].index;
      }
    conic_gaussian_listing_release(context, &listing);
  }
}

static conic_gaussian_gradient gradient_of(conic_context *context, const conic_gaussians *scene,
                                           const conic_camera *camera, const conic_gaussian_options *options,
                                           const frozen *f, int is_raw) {
  double rgb[3 * N_PIXELS], alpha[N_PIXELS], z[N_PIXELS];
  const conic_gaussian_weights weights = {.width = WIDTH, .height = HEIGHT, .rgb = rgb, .alpha = alpha, .z = z};
  conic_gradient_options how;
  conic_gaussian_gradient gradient;
  for (int i = 0; i < N_PIXELS; i++) {
    memcpy(rgb + 3 * i, f->weights[i], 3 * sizeof *rgb);
    alpha[i] = f->weights[i][3];
    z[i] = f->weights[i][4];
  }
  conic_gradient_options_init(&how);
  how.is_raw = (uint32_t)is_raw;
  CHECK_OK(conic_gaussian_gradient_find(context, scene, camera, options, &weights, &how, &gradient));
  return gradient;
}

/* Central differences of two steps, freed of their second order. */
static double central_difference(frozen *f, double *p, size_t at) {
  const double kept = p[at], h = 4e-4;
  double slopes[2];
  for (int k = 0; k < 2; k++) {
    const double step = k ? 0.5 * h : h;
    p[at] = kept + step;
    double above = loss_of(f, p, 0);
    p[at] = kept - step;
    slopes[k] = (above - loss_of(f, p, 0)) / (2.0 * step);
    p[at] = kept;
  }
  return slopes[1] + (slopes[1] - slopes[0]) / 3.0;
}

static const char *const kinds[] = {"mean", "scale", "rotation", "opacity", "sh", "camera"};

static int parameter_kind(size_t at) {
  const size_t k = at % ROW;
  return at >= CAMERA_AT ? 5 : k < SCALE ? 0 : k < TURN ? 1 : k < OPACITY ? 2 : k < SH ? 3 : 4;
}

static void compare_differences(frozen *f, double *p, const conic_gaussian_gradient *g) {
  double greatest[6] = {0.0}, worst[6] = {0.0};
  for (size_t at = 0; at < N_NUMBERS; at++)
    if (at >= CAMERA_AT || at % ROW < SH + conic_harmonics_of_degree(f->degree))
      greatest[parameter_kind(at)] = fmax(greatest[parameter_kind(at)], fabs(gradient_number(g, at)));
  for (size_t at = 0; at < N_NUMBERS; at++) {
    if (at < CAMERA_AT && at % ROW >= SH + conic_harmonics_of_degree(f->degree))
      continue;
    const int kind = parameter_kind(at);
    const double own = gradient_number(g, at), other = central_difference(f, p, at);
    const double off = fabs(own - other) / (fabs(own) + 1e-3 * greatest[kind]);
    worst[kind] = fmax(worst[kind], off);
    if (!(off <= 1e-6)) {
      fprintf(stderr, "  %s of Gaussian %zu, number %zu: %.12g, by differences %.12g\n", kinds[kind], at / ROW,
              at % ROW, own, other);
      check_failures++;
    }
  }
  printf("%-14s degree %d:", conic_gaussian_profile_name(f->profile), f->degree);
  for (int k = 0; k < 6; k++)
    printf(" %s %.1e of %.3g", kinds[k], worst[k], greatest[k]);
  putchar('\n');
}

static void test_differences(conic_context *context, conic_gaussian_profile profile, int degree) {
  static frozen f;
  double p[N_NUMBERS];
  uint64_t state = 7;
  conic_camera camera = tilted_camera();
  conic_gaussian_options options;
  conic_gaussian_options_init(&options);
  options.profile = profile;
  options.background[0] = 0.5f;
  options.background[2] = 0.25f;
  memset(&f, 0, sizeof f);
  f.profile = profile;
  f.degree = degree;
  memcpy(f.background, options.background, sizeof f.background);
  for (int i = 0; i < N_PIXELS; i++)
    for (int k = 0; k < 5; k++)
      f.weights[i][k] = i % 13 == 5 ? 0.0 : 2.0 * random_unit(&state) - 1.0;
  conic_gaussians scene = clamped_scene(context, profile, degree, &camera);
  list_numbers(&scene, &camera, p);
  freeze(context, &scene, &camera, &options, &f);
  conic_gaussian_gradient g = gradient_of(context, &scene, &camera, &options, &f, 0);
  CHECK_NEAR(g.loss, loss_of(&f, p, 1), 1e-11);
  compare_differences(&f, p, &g);
  conic_gaussian_gradient_release(context, &g);
  conic_gaussians_release(context, &scene);
}

/* --- what else it is to be --- */

static void fill_weights(frozen *f, uint64_t state) {
  memset(f, 0, sizeof *f);
  for (int i = 0; i < N_PIXELS; i++)
    for (int k = 0; k < 5; k++)
      f->weights[i][k] = 2.0 * random_unit(&state) - 1.0;
}

static int is_same_gradient(const conic_gaussian_gradient *a, const conic_gaussian_gradient *b) {
  const size_t n = a->count * sizeof(double);
  int is_same = a->loss == b->loss && memcmp(a->cam_from_world, b->cam_from_world, sizeof a->cam_from_world) == 0 &&
                a->fx == b->fx && a->fy == b->fy && a->cx == b->cx && a->cy == b->cy &&
                memcmp(a->opacity, b->opacity, n) == 0 && a->n_doubtful == b->n_doubtful &&
                memcmp(a->sh, b->sh, n * conic_harmonics_of_degree(a->sh_degree)) == 0 &&
                memcmp(a->doubt, b->doubt, a->count * sizeof *a->doubt) == 0;
  for (int k = 0; k < 4; k++)
    is_same &= memcmp(a->rotation[k], b->rotation[k], n) == 0 && (k == 3 || memcmp(a->mean[k], b->mean[k], n) == 0) &&
               (k == 3 || memcmp(a->scale[k], b->scale[k], n) == 0) &&
               (k > 1 || memcmp(a->place[k], b->place[k], n) == 0);
  return is_same;
}

/* One set of bits, and L that of the oracle's picture, whose Gaussians are in thousands and cells many. */
static void test_gradient_threads(conic_gaussian_profile profile) {
  enum { SIDE = 75 };
  static double rgb[3 * SIDE * SIDE];
  conic_gaussian_gradient gradients[3];
  conic_context *contexts[3];
  conic_camera camera = tilted_camera();
  conic_gaussian_options options;
  uint64_t state = 3;
  camera.width = camera.height = SIDE;
  camera.fx = camera.fy = 70.0;
  camera.cx = camera.cy = 0.5 * SIDE;
  for (size_t i = 0; i < 3 * SIDE * SIDE; i++)
    rgb[i] = 2.0 * random_unit(&state) - 1.0;
  const conic_gaussian_weights weights = {.width = SIDE, .height = SIDE, .rgb = rgb};
  conic_gaussian_options_init(&options);
  options.profile = profile;
  for (int k = 0; k < 3; k++) {
    static const int threads[] = {1, 2, 7};
    contexts[k] = check_context(threads[k]);
    conic_gaussians scene = gaussians_random(contexts[k], 1500, 1, 0);
    CHECK_OK(conic_gaussian_gradient_find(contexts[k], &scene, &camera, &options, &weights, NULL, &gradients[k]));
    if (k == 0) {
      conic_gaussian_reference r;
      double loss = 0.0;
      CHECK_OK(conic_gaussian_oracle_render(contexts[k], &scene, &camera, &options, CONIC_GAUSSIAN_PROFILE, &r));
      for (size_t i = 0; i < 3 * SIDE * SIDE; i++)
        loss += rgb[i] * r.rgb[i];
      CHECK_NEAR(loss, gradients[0].loss, 1e-10);
      conic_gaussian_reference_release(contexts[k], &r);
    }
    conic_gaussians_release(contexts[k], &scene);
  }
  CHECK(gradients[0].n_shown > 700);
  CHECK(is_same_gradient(&gradients[0], &gradients[1]) && is_same_gradient(&gradients[0], &gradients[2]));
  for (int k = 0; k < 3; k++) {
    conic_gaussian_gradient_release(contexts[k], &gradients[k]);
    conic_context_destroy(contexts[k]);
  }
}

/* By what files store. */
static void test_raw(conic_context *context) {
  static frozen f;
  const conic_camera camera = tilted_camera();
  conic_gaussians scene = gaussians_random(context, N, 1, CONIC_GAUSSIANS_HALF);
  fill_weights(&f, 11);
  conic_gaussian_gradient a = gradient_of(context, &scene, &camera, NULL, &f, 0);
  conic_gaussian_gradient b = gradient_of(context, &scene, &camera, NULL, &f, 1);
  CHECK(!a.is_raw && b.is_raw && a.count == N && a.sh_degree == 1);
  for (size_t i = 0; i < N; i++) {
    const double o = (double)scene.opacity[i];
    CHECK_NEAR(b.opacity[i], a.opacity[i] * o * (1.0 - o), 1e-15);
    CHECK_NEAR(b.scale[1][i], a.scale[1][i] * (double)scene.scale[1][i], 1e-15);
    CHECK(a.mean[0][i] == b.mean[0][i] && a.rotation[3][i] == b.rotation[3][i] && a.sh[12 * i] == b.sh[12 * i]);
  }
  conic_gaussian_gradient_release(context, &a);
  conic_gaussian_gradient_release(context, &b);
  conic_gaussians_release(context, &scene);
}

/* What rounding may decide either way is told of the Gaussians that it is about, and of these only. */
static void test_gradient_doubts(conic_context *context) {
  static frozen f;
  const conic_camera camera = {.width = WIDTH,
                               .height = HEIGHT,
                               .fx = 32.0,
                               .fy = 32.0,
                               .cx = 5.5,
                               .cy = 4.5,
                               .cam_from_world = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
  conic_gaussian_options options;
  conic_gaussian_options_init(&options);
  options.profile = CONIC_PROFILE_KHR_2026;
  conic_gaussians scene = gaussians_random(context, N, 0, 0);
  for (size_t i = 0; i < N; i++) {
    for (int k = 0; k < 3; k++) {
      scene.position[k][i] = k == 2 ? 4.0f + (float)i : 0.01f * (float)i;
      scene.scale[k][i] = 0.25f + 0.0625f * (float)k;
      scene.sh[3 * i + (size_t)k] = 0.5f;
    }
    scene.opacity[i] = 0.25f;
  }
  scene.sh[3 * 4 + 1] = (float)(-0.5 / 0.28209479177387814);
  fill_weights(&f, 5);
  conic_gaussian_gradient g = gradient_of(context, &scene, &camera, &options, &f, 0);
  CHECK(g.doubt[4] == 1u << CONIC_DOUBT_COLOR && g.doubt[5] == 0);
  CHECK(g.n_doubtful == 1 && g.doubtful[CONIC_DOUBT_COLOR] == 1 && g.doubtful[CONIC_DOUBT_ORDER] == 0);
  conic_gaussian_gradient_release(context, &g);
  scene.position[0][3] = scene.position[0][2];
  scene.position[1][3] = scene.position[1][2];
  scene.position[2][3] = nextafterf(scene.position[2][2], 0.0f);
  g = gradient_of(context, &scene, &camera, &options, &f, 0);
  CHECK(g.doubt[2] == 1u << CONIC_DOUBT_ORDER && g.doubt[3] == 1u << CONIC_DOUBT_ORDER && g.n_doubtful == 3);
  conic_gaussian_gradient_release(context, &g);
  for (int i = 0; i < N_PIXELS; i++) /* where there is no weight, nothing matters */
    memset(f.weights[i], 0, sizeof f.weights[i]);
  g = gradient_of(context, &scene, &camera, &options, &f, 0);
  CHECK(g.n_doubtful == 0 && g.n_shown == 0 && g.loss == 0.0);
  conic_gaussian_gradient_release(context, &g);
  conic_gaussians_release(context, &scene);
}

static void test_gradient_refusals(conic_context *context) {
  double rgb[3 * N_PIXELS] = {0.0};
  conic_gaussian_weights weights = {.width = WIDTH, .height = HEIGHT, .rgb = rgb};
  conic_camera camera = tilted_camera();
  conic_gaussians scene = gaussians_random(context, N, 1, 0);
  conic_gaussian_options options;
  conic_gaussian_gradient g;
  conic_gaussian_options_init(&options);
  CHECK_OK(conic_gaussian_gradient_find(context, &scene, &camera, NULL, &weights, NULL, &g));
  CHECK(g.n_shown == 0 && g.opacity[N - 1] == 0.0);
  conic_gaussian_gradient_release(context, &g);
  options.profile = CONIC_PROFILE_2DGS_2024;
  CHECK(!conic_gradient_has_profile(options.profile));
  CHECK(conic_gaussian_gradient_find(context, &scene, &camera, &options, &weights, NULL, &g) ==
        CONIC_ERROR_UNSUPPORTED);
  rgb[N_PIXELS] = INFINITY;
  CHECK(conic_gaussian_gradient_find(context, &scene, &camera, NULL, &weights, NULL, &g) == CONIC_ERROR_ARGUMENT);
  rgb[N_PIXELS] = 0.0;
  weights.width--;
  CHECK(conic_gaussian_gradient_find(context, &scene, &camera, NULL, &weights, NULL, &g) == CONIC_ERROR_ARGUMENT);
  weights.width++;
  camera.kind = CONIC_CAMERA_FISHEYE;
  CHECK(conic_gaussian_gradient_find(context, &scene, &camera, NULL, &weights, NULL, &g) == CONIC_ERROR_ARGUMENT);
  CHECK(g.count == 0 && !g.doubt);
  CHECK(strcmp(conic_gradient_doubt_name(CONIC_DOUBT_SLOPE), "slope") == 0 &&
        strcmp(conic_gradient_doubt_name(CONIC_DOUBT_END), "end") == 0 &&
        !conic_gradient_doubt_name(CONIC_N_GRADIENT_DOUBTS) && !conic_gradient_doubt_name(-1));
  conic_gaussians_release(context, &scene);
}

int main(void) {
  conic_context *context = check_context(2);
  int degree = 0;
  test_gradient_threads(CONIC_PROFILE_GSPLAT_1_6_AA);
  test_gradient_threads(CONIC_PROFILE_EXACT);
  test_raw(context);
  test_gradient_doubts(context);
  test_gradient_refusals(context);
  for (int profile = 0; profile < CONIC_N_GAUSSIAN_PROFILES; profile++)
    if (conic_gradient_has_profile((conic_gaussian_profile)profile))
      for (int k = 0; k < 2; k++)
        test_differences(context, (conic_gaussian_profile)profile, degree++ % (CONIC_MAX_SH_DEGREE + 1));
  conic_context_destroy(context);
  return check_result();
}
