/* A search for the greatest error of a weight, by kernel, cutoff, prefilter and method: random splats against the
 * kernel itself, exactly projected and convolved with the pixel's filter. docs/reference/picture.md (Profile) has the
 * bounds.
 *
 *   test_profile_search [SPLATS [SEED]]
 *
 * tries so many splats in all (8,400 in the suite; the bounds are of 1000000) and prints a table of the greatest
 * errors, over the peak of the splat. It fails where one is above its bound. */
#include "tests/support/fixture.h"

static const double pi = 3.14159265358979323846;

enum { WINDOW = 12, N_PIXELS = 2, N_KERNELS = 7, N_FILTERS = 3, N_RANGES = 2, N_METHODS = 3 };

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

/* The disc's lesser standard deviation on the screen, as seen at its centre, over the filter's. */
static double thickness_of(const setting *s) {
  double xx = 0.0, xy = 0.0, yy = 0.0, scale = s->focal / s->p[2];
  for (int i = 0; i < 2; i++) {
    double x = scale * (s->t[i][0] - s->p[0] / s->p[2] * s->t[i][2]);
    double y = scale * (s->t[i][1] - s->p[1] / s->p[2] * s->t[i][2]);
    xx += x * x;
    xy += x * y;
    yy += y * y;
  }
  double greater = 0.5 * (xx + yy) + hypot(0.5 * (xx - yy), xy);
  return sqrt(fmax(xx * yy - xy * xy, 0.0) / greater / s->prefilter);
}

/* Up to 50° off the axis, at distance 1, of any attitude, from 0.1 to 100 deviations of the filter large and up to 50
 * times as long as wide, as far as they are as deep and as thin as that (struct range). */
static setting random_setting(uint64_t *state, const conic_kernel *kernel, double prefilter, double most_depth,
                              double least_thick) {
  setting s = {.kernel = *kernel, .prefilter = prefilter};
  double off = random_between(state, 0.0, pi * 50.0 / 180.0), around = random_between(state, 0.0, 2.0 * pi);
  double turn, nearest;
  do {
    double normal[3], helper[3], size;
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
  } while (nearest < (1.0 - most_depth) * s.p[2] || thickness_of(&s) < least_thick);
  return s;
}

/* --- the search --- */

/* A kernel, and its bounds for each prefilter and range of splats, by each method. */
typedef struct kind {
  const char *name;
  conic_kernel kernel;
  double bounds[N_FILTERS][N_RANGES][N_METHODS];
} kind;

static const conic_method methods[N_METHODS] = {CONIC_METHOD_CONIC, CONIC_METHOD_RAY, CONIC_METHOD_AUTO};
static const float filters[N_FILTERS] = {0.1f, 0.3f, 1.0f};
/* Within the disc depth differs by up to most_depth of the middle's; the disc's lesser standard deviation on the screen
 * is least_thick of the filter's or more. */
static const struct range { double most_depth, least_thick; } ranges[N_RANGES] = {{0.1, 0.5}, {0.7, 0.0}};
static const kind kinds[N_KERNELS] = {
    {"hat, 1.5",
     {CONIC_KERNEL_HAT, 1.5f, 0, 0, 0},
     {{{1, 1, 1}, {1, 1, 1}}, {{1, 1, 1}, {1, 1, 1}}, {{1, 1, 1}, {1, 1, 1}}}},
    {"hat, 3",
     {CONIC_KERNEL_HAT, 3.0f, 0, 0, 0},
     {{{1, 1, 1}, {1, 1, 1}}, {{1, 1, 1}, {1, 1, 1}}, {{1, 1, 1}, {1, 1, 1}}}},
    {"confetti:6,1.5,3, 1.5",
     {CONIC_KERNEL_CONFETTI, 1.5f, 6.0f, 1.5f, 3},
     {{{1, 1, 1}, {1, 1, 1}}, {{1, 1, 1}, {1, 1, 1}}, {{1, 1, 1}, {1, 1, 1}}}},
    {"confetti:4,1.5,5, 1.5",
     {CONIC_KERNEL_CONFETTI, 1.5f, 4.0f, 1.5f, 5},
     {{{1, 1, 1}, {1, 1, 1}}, {{1, 1, 1}, {1, 1, 1}}, {{1, 1, 1}, {1, 1, 1}}}},
    {"confetti:4,3,5, 3",
     {CONIC_KERNEL_CONFETTI, 3.0f, 4.0f, 3.0f, 5},
     {{{1, 1, 1}, {1, 1, 1}}, {{1, 1, 1}, {1, 1, 1}}, {{1, 1, 1}, {1, 1, 1}}}},
    {"box, 1.5",
     {CONIC_KERNEL_BOX, 1.5f, 0, 0, 0},
     {{{1, 1, 1}, {1, 1, 1}}, {{1, 1, 1}, {1, 1, 1}}, {{1, 1, 1}, {1, 1, 1}}}},
    {"box, 3",
     {CONIC_KERNEL_BOX, 3.0f, 0, 0, 0},
     {{{1, 1, 1}, {1, 1, 1}}, {{1, 1, 1}, {1, 1, 1}}, {{1, 1, 1}, {1, 1, 1}}}},
};

/* The greatest error found, and how far the truth itself moves there with twice as many discs. */
typedef struct found {
  double error, of_truth;
} found;

/* Puts a small window somewhere on the box of the splat's outline, or about its centre. */
static void place_window(fixture *f, const setting *s, const double center[2], int is_central, uint64_t *state) {
  double middle[2];
  for (int c = 0; c < 2; c++) {
    double variance = s->prefilter, reach;
    for (int i = 0; i < 2; i++)
      variance += pow(s->focal * (s->t[i][c] - s->p[c] / s->p[2] * s->t[i][2]) / s->p[2], 2.0);
    reach = is_central ? 0.0 : (double)s->kernel.cutoff * sqrt(variance);
    middle[c] = center[c] + random_between(state, -1.0, 1.0) * reach + random_between(state, -0.5, 0.5);
  }
  fixture_camera(f, WINDOW, WINDOW, s->focal);
  f->camera.cx = 0.5 * WINDOW - floor(middle[0]) + random_between(state, 0.0, 1.0);
  f->camera.cy = 0.5 * WINDOW - floor(middle[1]) + random_between(state, 0.0, 1.0);
}

static void draw(fixture *f, const setting *s, float weights[N_METHODS][WINDOW * WINDOW]) {
  fixture_set(f, 0, s->p, s->t[0], s->t[1], 1.0f, 1.0f, 1.0f);
  f->options.near_z = 1e-3;
  f->options.prefilter = (float)s->prefilter;
  f->options.kernel = s->kernel;
  for (int i = 0; i < N_METHODS; i++) {
    f->options.method = methods[i];
    CHECK_OK(conic_render(f->renderer, &f->splats, &f->camera, &f->options, &f->image, &f->statistics));
    memcpy(weights[i], f->image.planes[CONIC_PLANE_WEIGHT], sizeof weights[i]);
  }
}

/* Compares some pixels, by all methods. */
static void try_splat(fixture *f, const setting *s, uint64_t *state, found worst[N_METHODS]) {
  float weights[N_METHODS][WINDOW * WINDOW];
  double center[2] = {s->focal * s->p[0] / s->p[2], s->focal * s->p[1] / s->p[2]}, peak = -1.0;
  int is_central = fixture_random(state) < 0.25;
  place_window(f, s, center, is_central, state);
  draw(f, s, weights);
  for (int i = 0; i < N_PIXELS; i++) {
    int column = (int)random_between(state, 0.0, WINDOW), row = (int)random_between(state, 0.0, WINDOW);
    const double x[2] = {column + 0.5 - f->camera.cx, row + 0.5 - f->camera.cy};
    double truth = -1.0, finer = -1.0;
    for (int j = 0; j < N_METHODS; j++) {
      double weight = (double)weights[j][row * WINDOW + column];
      if (!(weight > 1e-15)) /* not covered: outlines are not of the profile's making */
        continue;
      peak = peak < 0.0 ? true_weight(s, center, 1) : peak;
      truth = truth < 0.0 ? true_weight(s, x, 1) : truth;
      if (fabs(weight - truth) <= worst[j].error * peak)
        continue;
      finer = finer < 0.0 ? true_weight(s, x, 4) : finer;
      if (fabs(weight - finer) > worst[j].error * peak)
        worst[j] = (found){fabs(weight - finer) / peak, fabs(true_weight(s, x, 8) - finer) / peak};
    }
  }
}

/* The table's columns: conic, ray and auto of the first range, and of the second. */
static void print_and_check(found worst[N_KERNELS][N_FILTERS][N_RANGES][N_METHODS]) {
  printf("| kernel, cutoff | h | conic | ray | auto | conic | ray | auto |\n|---|---|---|---|---|---|---|---|\n");
  for (int i = 0; i < N_KERNELS; i++)
    for (int j = 0; j < N_FILTERS; j++) {
      printf("| %s | %g |", kinds[i].name, (double)filters[j]);
      for (int k = 0; k < N_RANGES * N_METHODS; k++) {
        const found *f = &worst[i][j][k / N_METHODS][k % N_METHODS];
        printf(" %.4f |", f->error);
        CHECK(f->error > 1e-4 && f->error <= kinds[i].bounds[j][k / N_METHODS][k % N_METHODS]);
        CHECK(f->of_truth < 1e-3);
      }
      printf("\n");
    }
}

int main(int argc, char **argv) {
  static found worst[N_KERNELS][N_FILTERS][N_RANGES][N_METHODS];
  long n_splats = argc > 1 ? atol(argv[1]) : 8400;
  uint64_t state = argc > 2 ? (uint64_t)atol(argv[2]) : 1;
  find_rule(N_ALONG, along_places, along_weights);
  find_rule(N_LEVELS, level_places, level_weights);
  fixture f = fixture_open(1);
  fixture_splats(&f, 1);
  CHECK_OK(conic_image_allocate(f.context, WINDOW, WINDOW, 1u << CONIC_PLANE_WEIGHT, &f.image));
  for (long n = 0; n < n_splats; n++) {
    long i = n % N_KERNELS, j = n / N_KERNELS % N_FILTERS, k = n / (N_KERNELS * N_FILTERS) % N_RANGES;
    setting s =
        random_setting(&state, &kinds[i].kernel, (double)filters[j], ranges[k].most_depth, ranges[k].least_thick);
    try_splat(&f, &s, &state, worst[i][j][k]);
  }
  print_and_check(worst);
  fixture_close(&f);
  return check_result();
}
