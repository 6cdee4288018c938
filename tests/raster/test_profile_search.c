/* A search for the largest error of a weight, kernel by kernel and method by method: random splats against the kernel
 * itself, exactly projected and convolved with the pixel's filter. docs/notes/kernels.md has the bounds.
 *
 *   test_profile_search [SPLATS [SEED]]
 *
 * draws so many splats of each kernel, prefilter and method (150 in the suite) and prints the worst error of each, over
 * the splat's peak, or over an eighth where the peak is lower. */
#include "tests/support/fixture.h"

static const double pi = 3.14159265358979323846;

enum { WINDOW = 12, N_PIXELS = 2 };

/* A splat and what it is seen by, in doubles. */
typedef struct setting {
  conic_kernel kernel;
  double prefilter, focal, p[3], t[2][3];
} setting;

/* --- the truth: the kernel is a stack of discs, each of which is an ellipse on the screen --- */

static double end_of(const conic_kernel *k) {
  return k->type == CONIC_KERNEL_CONFETTI ? (double)k->b : (double)k->cutoff;
}

/* Minus the derivative. */
static double slope_at(const conic_kernel *k, double r) {
  double end = end_of(k);
  if (k->type == CONIC_KERNEL_HAT)
    return 1.0 / end;
  double x = r / end, power = pow(x, k->n), rest = 1.0 - power, a = (double)k->a;
  if (!(rest > 1e-9))
    return 0.0;
  return exp(-a * power / rest) * a * k->n * power / x / (rest * rest) / end;
}

static double value_at(const conic_kernel *k, double r) {
  double x = r / end_of(k);
  if (!(x < 1.0))
    return 0.0;
  if (k->type == CONIC_KERNEL_HAT)
    return 1.0 - x;
  double power = pow(x, k->n);
  return k->type == CONIC_KERNEL_BOX ? 1.0 : exp(-(double)k->a * power / (1.0 - power));
}

enum { N_ALONG = 32, N_LEVELS = 6 };

/* Gauss and Legendre's places and weights over -1 to 1. */
static void find_rule(int n, double *places, double *weights) {
  for (int i = 0; i < n; i++) {
    double x = cos(pi * (i + 0.75) / (n + 0.5)), slope = 1.0;
    for (int step = 0; step < 50; step++) {
      double before = 1.0, value = x;
      for (int k = 2; k <= n; k++) {
        double next = ((2.0 * k - 1.0) * x * value - (k - 1.0) * before) / k;
        before = value;
        value = next;
      }
      slope = n * (x * value - before) / (x * x - 1.0);
      x -= value / slope;
    }
    places[i] = x;
    weights[i] = 2.0 / ((1.0 - x * x) * slope * slope);
  }
}

static double along_places[N_ALONG], along_weights[N_ALONG], level_places[N_LEVELS], level_weights[N_LEVELS];

/* What the pixel's filter at (x, y) from the principal point sees of the disc of radius r. */
static double seen_of_disc(const setting *s, double r, const double x[2]) {
  double dual[3][3], f = s->focal, h = sqrt(s->prefilter);
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      dual[i][j] = r * r * (s->t[0][i] * s->t[0][j] + s->t[1][i] * s->t[1][j]) - s->p[i] * s->p[j];
  double cx = dual[0][2] / dual[2][2], cy = dual[1][2] / dual[2][2];
  double xx = cx * cx - dual[0][0] / dual[2][2], xy = cx * cy - dual[0][1] / dual[2][2];
  double yy = cy * cy - dual[1][1] / dual[2][2];
  double half = 0.5 * (xx - yy), spread = hypot(half, xy), high = 0.5 * (xx + yy) + spread;
  double low = high > 0.0 ? (xx * yy - xy * xy) / high : 0.0, turn = 0.5 * atan2(xy, half);
  double a = f / h * sqrt(high), b = f / h * sqrt(low > 0.0 ? low : 0.0);
  double dx = (x[0] - f * cx) / h, dy = (x[1] - f * cy) / h, c = cos(turn), e = sin(turn);
  double along = c * dx + e * dy, across = c * dy - e * dx, reach = 7.0, sum = 0.0;
  double from = along - reach > -a ? asin((along - reach) / a) : -0.5 * pi;
  double to = along + reach < a ? asin((along + reach) / a) : 0.5 * pi;
  if (!(along - reach < a && along + reach > -a) || fabs(across) > b + reach)
    return 0.0;
  for (int i = 0; i < N_ALONG; i++) {
    double angle = 0.5 * (from + to) + 0.5 * (to - from) * along_places[i];
    double place = a * sin(angle) - along, chord = b * cos(angle);
    double part = 0.5 * (erf((chord - across) * sqrt(0.5)) + erf((chord + across) * sqrt(0.5)));
    sum += along_weights[i] * exp(-0.5 * place * place) * a * cos(angle) * part;
  }
  return sum * 0.5 * (to - from) / sqrt(2.0 * pi);
}

/* u and v at a place, and the deviation of r under the filter there; the square of r. */
static double radius_at(const setting *s, const double x[2], double *deviation) {
  const double *p = s->p, *u = s->t[0], *v = s->t[1];
  double d[3] = {x[0] / s->focal, x[1] / s->focal, 1.0}, m[3][3], value[3] = {0.0};
  for (int i = 0; i < 3; i++) {
    int j = (i + 1) % 3, k = (i + 2) % 3;
    m[0][i] = v[j] * p[k] - v[k] * p[j];
    m[1][i] = p[j] * u[k] - p[k] * u[j];
    m[2][i] = u[j] * v[k] - u[k] * v[j];
    for (int row = 0; row < 3; row++)
      value[row] += d[i] * m[row][i];
  }
  double a = value[0] / value[2], b = value[1] / value[2], r = hypot(a, b), squared = 0.0;
  for (int i = 0; i < 2; i++) {
    double by_u = (m[0][i] - a * m[2][i]) / value[2], by_v = (m[1][i] - b * m[2][i]) / value[2];
    double by = r > 1e-6 ? (a * by_u + b * by_v) / r : hypot(by_u, by_v);
    squared += by * by / (s->focal * s->focal) * s->prefilter;
  }
  *deviation = sqrt(squared);
  return r;
}

static int compare_doubles(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static double true_weight(const setting *s, const double x[2], int n_finer) {
  static const double parts[] = {0.0, 0.15, 0.3, 0.45, 0.6, 0.7, 0.8, 0.9, 1.0}, offsets[] = {-6, -2.5, 0, 2.5, 6};
  enum { N_PARTS = sizeof parts / sizeof *parts, N_BORDERS = N_PARTS + 5 };
  double borders[N_BORDERS], deviation, end = end_of(&s->kernel), sum = 0.0;
  double r = radius_at(s, x, &deviation);
  if (s->kernel.type == CONIC_KERNEL_BOX)
    return seen_of_disc(s, end, x);
  for (int i = 0; i < N_PARTS; i++)
    borders[i] = parts[i] * end;
  for (int i = 0; i < 5; i++)
    borders[N_PARTS + i] = fmax(0.0, fmin(end, r + offsets[i] * deviation));
  qsort(borders, N_BORDERS, sizeof *borders, compare_doubles);
  for (int i = 0; i + 1 < N_BORDERS; i++)
    for (int part = 0; part < n_finer; part++) {
      double low = borders[i] + (borders[i + 1] - borders[i]) * part / n_finer;
      double high = borders[i] + (borders[i + 1] - borders[i]) * (part + 1) / n_finer, seen = 0.0, all = 0.0;
      if (!(high - low > 1e-9 * end))
        continue;
      for (int j = 0; j < N_LEVELS; j++) {
        double at = 0.5 * (low + high) + 0.5 * (high - low) * level_places[j];
        double slope = level_weights[j] * slope_at(&s->kernel, at);
        all += slope;
        if (slope > 0.0)
          seen += slope * seen_of_disc(s, at, x);
      }
      if (all > 0.0)
        sum += (value_at(&s->kernel, low) - value_at(&s->kernel, high)) * (seen / all);
    }
  return sum;
}

/* --- random splats --- */

static double random_between(uint64_t *state, double low, double high) {
  return low + (high - low) * fixture_random(state);
}

static double random_power(uint64_t *state, double low, double high) {
  return low * pow(high / low, fixture_random(state));
}

static void cross(const double a[3], const double b[3], double c[3]) {
  for (int i = 0; i < 3; i++)
    c[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

static double length_of(const double v[3]) {
  return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

static void random_direction(uint64_t *state, double v[3]) {
  double z = random_between(state, -1.0, 1.0), angle = random_between(state, 0.0, 2.0 * pi), r = sqrt(1.0 - z * z);
  v[0] = r * cos(angle);
  v[1] = r * sin(angle);
  v[2] = z;
}

/* Up to 50° off the axis, at distance 1, of any attitude, from 0.1 to 100 deviations of the filter across, as far as
 * the disc stays before the eye. */
static setting random_setting(uint64_t *state, const conic_kernel *kernel, const double prefilter[2]) {
  setting s = {.kernel = *kernel};
  double turn, off = random_between(state, 0.0, pi * 50.0 / 180.0), around = random_between(state, 0.0, 2.0 * pi),
               nearest;
  do {
    double normal[3], helper[3], size;
    s.prefilter = random_power(state, prefilter[0], prefilter[1]);
    s.focal = random_power(state, 100.0, 4000.0);
    s.p[0] = sin(off) * cos(around);
    s.p[1] = sin(off) * sin(around);
    s.p[2] = cos(off);
    random_direction(state, normal);
    random_direction(state, helper);
    cross(normal, helper, s.t[0]);
    cross(normal, s.t[0], s.t[1]);
    size = random_power(state, 0.1, 100.0) * sqrt(s.prefilter) / s.focal;
    turn = random_power(state, 0.02, 1.0);
    double first = length_of(s.t[0]), second = length_of(s.t[1]);
    for (int i = 0; i < 3; i++) {
      s.t[0][i] = (double)(float)(s.t[0][i] * size / first);
      s.t[1][i] = (double)(float)(s.t[1][i] * size * turn / second);
      s.p[i] = (double)(float)s.p[i];
    }
    nearest = s.p[2] - fmax((double)kernel->cutoff, end_of(kernel)) * hypot(s.t[0][2], s.t[1][2]);
  } while (nearest < 0.3 * s.p[2]);
  return s;
}

/* --- the search --- */

static const conic_method methods[] = {CONIC_METHOD_AUTO, CONIC_METHOD_CONIC, CONIC_METHOD_RAY};
/* Of the prefilter, in px². */
static const double ranges[][2] = {{0.05, 0.3}, {0.3, 1.0}, {1.0, 4.0}};

enum { N_METHODS = sizeof methods / sizeof *methods, N_RANGES = sizeof ranges / sizeof *ranges };

/* What is asked of a kernel, by the prefilter and the method. */
typedef struct kind {
  conic_kernel kernel;
  double bounds[N_RANGES][N_METHODS];
} kind;

#define ANY                                                                                                            \
  {                                                                                                                    \
    {9, 9, 9}, {9, 9, 9}, {                                                                                            \
      9, 9, 9                                                                                                          \
    }                                                                                                                  \
  }
static const kind kinds[] = {
    {{CONIC_KERNEL_HAT, 1.0f, 0, 0, 0}, {{0.03, 0.29, 0.23}, {0.09, 0.40, 0.24}, {0.13, 0.50, 0.50}}},
    {{CONIC_KERNEL_HAT, 1.5f, 0, 0, 0}, {{0.11, 0.29, 0.17}, {0.05, 0.61, 0.33}, {0.16, 0.72, 0.58}}},
    {{CONIC_KERNEL_HAT, 3.0f, 0, 0, 0}, {{0.08, 0.39, 0.44}, {0.25, 0.57, 0.43}, {0.34, 0.52, 0.43}}},
    {{CONIC_KERNEL_CONFETTI, 1.5f, 6.0f, 1.5f, 3}, {{0.09, 0.39, 0.30}, {0.07, 0.62, 0.73}, {0.33, 0.51, 0.65}}},
    {{CONIC_KERNEL_CONFETTI, 1.5f, 4.0f, 1.5f, 5}, {{0.11, 0.44, 0.52}, {0.08, 0.43, 0.24}, {0.25, 0.47, 0.37}}},
    {{CONIC_KERNEL_CONFETTI, 3.0f, 4.0f, 3.0f, 5}, {{0.11, 0.65, 0.50}, {0.12, 0.70, 0.40}, {0.32, 0.74, 0.67}}},
    {{CONIC_KERNEL_BOX, 1.0f, 0, 0, 0}, {{0.04, 0.02, 0.04}, {0.03, 0.15, 0.07}, {0.03, 0.13, 0.59}}},
    {{CONIC_KERNEL_BOX, 1.5f, 0, 0, 0}, {{0.03, 0.05, 0.05}, {0.04, 0.09, 0.08}, {0.06, 0.36, 0.15}}},
    {{CONIC_KERNEL_BOX, 3.0f, 0, 0, 0}, {{0.10, 0.05, 0.11}, {0.11, 0.08, 0.06}, {0.05, 0.19, 0.57}}}};

static const double least_peak = 0.125;

typedef struct found {
  double worst;
  long n_pixels;
  setting setting;
} found;

/* Draws the splat in a small window somewhere on its outline's box, and compares some pixels. */
static void try_splat(fixture *f, const setting *s, uint64_t *state, found *worst) {
  double x[2], offset[2], t_px[2], peak, place[2] = {s->focal * s->p[0] / s->p[2], s->focal * s->p[1] / s->p[2]};
  int is_central = fixture_random(state) < 0.25;
  for (int c = 0; c < 2; c++) {
    t_px[c] = 0.0;
    for (int i = 0; i < 2; i++)
      t_px[c] += pow(s->focal * (s->t[i][c] - s->p[c] / s->p[2] * s->t[i][2]) / s->p[2], 2.0);
    t_px[c] = (double)s->kernel.cutoff * sqrt(t_px[c] + s->prefilter);
  }
  fixture_camera(f, WINDOW, WINDOW, s->focal);
  for (int c = 0; c < 2; c++)
    offset[c] = (is_central ? 0.0 : random_between(state, -1.0, 1.0) * t_px[c]) + random_between(state, -0.5, 0.5);
  f->camera.cx = 0.5 * WINDOW - floor(place[0] + offset[0]) + random_between(state, 0.0, 1.0);
  f->camera.cy = 0.5 * WINDOW - floor(place[1] + offset[1]) + random_between(state, 0.0, 1.0);
  fixture_set(f, 0, s->p, s->t[0], s->t[1], 1.0f, 1.0f, 1.0f);
  f->options.near_z = 1e-3;
  f->options.prefilter = (float)s->prefilter;
  f->options.kernel = s->kernel;
  CHECK_OK(conic_render(f->renderer, &f->splats, &f->camera, &f->options, &f->image, &f->statistics));
  const float *weights = f->image.planes[CONIC_PLANE_WEIGHT];
  setting exact = *s;
  exact.prefilter = (double)f->options.prefilter;
  peak = -1.0;
  for (int i = 0; i < N_PIXELS; i++) {
    int column = (int)random_between(state, 0.0, WINDOW), row = (int)random_between(state, 0.0, WINDOW);
    if (is_central && i == 0)
      column = row = WINDOW / 2;
    double weight = (double)weights[row * WINDOW + column];
    if (!(weight > 1e-15))
      continue;
    if (peak < 0.0)
      peak = true_weight(&exact, place, 1);
    x[0] = column + 0.5 - f->camera.cx;
    x[1] = row + 0.5 - f->camera.cy;
    double truth = true_weight(&exact, x, 1), error = fabs(weight - truth) / fmax(peak, least_peak);
    worst->n_pixels++;
    if (error > worst->worst) {
      worst->worst = fabs(weight - true_weight(&exact, x, 4)) / fmax(peak, least_peak);
      worst->setting = exact;
    }
  }
}

static void print_worst(const found *worst, conic_method method) {
  const setting *s = &worst->setting;
  const double filter = s->focal / sqrt(s->prefilter);
  printf("%s, cutoff %g, %s: %.4f in %ld pixels; the worst has %.3g and %.3g deviations of the filter, h %.3g\n",
         conic_kernel_type_name(s->kernel.type), (double)s->kernel.cutoff, conic_method_name(method), worst->worst,
         worst->n_pixels, length_of(s->t[0]) * filter, length_of(s->t[1]) * filter, s->prefilter);
  fflush(stdout);
}

/* One kernel under one range of the prefilter by one method. */
static void search(fixture *f, const kind *of, int i_range, int i_method, long n, uint64_t *state) {
  found worst = {0.0};
  f->options.method = methods[i_method];
  for (long i = 0; i < n; i++) {
    setting s = random_setting(state, &of->kernel, ranges[i_range]);
    try_splat(f, &s, state, &worst);
  }
  print_worst(&worst, methods[i_method]);
  CHECK(worst.n_pixels > n / 20);
  CHECK(worst.worst <= of->bounds[i_range][i_method]);
}

int main(int argc, char **argv) {
  long n = argc > 1 ? strtol(argv[1], NULL, 10) : 0; /* the suite names a folder */
  uint64_t state = argc > 2 ? (uint64_t)strtol(argv[2], NULL, 10) : 1;
  n = n > 0 ? n : 150;
  find_rule(N_ALONG, along_places, along_weights);
  find_rule(N_LEVELS, level_places, level_weights);
  fixture f = fixture_open(1);
  fixture_splats(&f, 1);
  fixture_camera(&f, WINDOW, WINDOW, 100.0);
  CHECK_OK(conic_image_allocate(f.context, WINDOW, WINDOW, 1u << CONIC_PLANE_WEIGHT, &f.image));
  for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
    for (int range = 0; range < N_RANGES; range++)
      for (int method = 0; method < N_METHODS; method++)
        search(&f, &kinds[i], range, method, n, &state);
  fixture_close(&f);
  return check_result();
}
