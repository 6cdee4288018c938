/* A search for the largest error of a weight, kernel by kernel: random splats, and uphill from the worst of them,
 * against the kernel itself, exactly projected and convolved with the pixel's filter. docs/notes/kernels.md has the
 * bounds.
 *
 *   test_profile_search [SPLATS [SEED]]
 *
 * draws so many random splats of each kernel and case (150 in the suite), climbs from the worst eight, and prints the
 * worst error of each, over the splat's peak, or over an eighth where the peak is lower. */
#include "tests/support/fixture.h"

static const double pi = 3.14159265358979323846;

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

/* The projected disc of a radius: its centre and half axes over the focal length, and the longer one's angle. */
typedef struct ellipse {
  double center[2], axes[2], turn;
} ellipse;

static ellipse outline_of(const setting *s, double r) {
  double dual[3][3];
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      dual[i][j] = r * r * (s->t[0][i] * s->t[0][j] + s->t[1][i] * s->t[1][j]) - s->p[i] * s->p[j];
  double cx = dual[0][2] / dual[2][2], cy = dual[1][2] / dual[2][2];
  double xx = cx * cx - dual[0][0] / dual[2][2], xy = cx * cy - dual[0][1] / dual[2][2];
  double yy = cy * cy - dual[1][1] / dual[2][2];
  double half = 0.5 * (xx - yy), spread = hypot(half, xy), high = 0.5 * (xx + yy) + spread;
  double low = high > 0.0 ? (xx * yy - xy * xy) / high : 0.0;
  return (ellipse){{cx, cy}, {sqrt(high), sqrt(low > 0.0 ? low : 0.0)}, 0.5 * atan2(xy, half)};
}

/* What the pixel's filter at (x, y) from the principal point sees of the disc of radius r. */
static double seen_of_disc(const setting *s, double r, const double x[2]) {
  const ellipse at = outline_of(s, r);
  double f = s->focal, h = sqrt(s->prefilter), a = f / h * at.axes[0], b = f / h * at.axes[1];
  double dx = (x[0] - f * at.center[0]) / h, dy = (x[1] - f * at.center[1]) / h, c = cos(at.turn), e = sin(at.turn);
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

/* --- splats as points of a cube --- */

/* The prefilter, the focal length, the direction to the splat, its normal, its turn about that, its size, its width
 * over its length, and the pixel's place about its outline, as the radius and the angle: each 0 to 1. */
enum { N_PARTS_OF_GUESS = 11 };
typedef struct guess {
  double parts[N_PARTS_OF_GUESS];
} guess;

static double power_between(double part, double low, double high) {
  return low * pow(high / low, part);
}

static void cross(const double a[3], const double b[3], double c[3]) {
  for (int i = 0; i < 3; i++)
    c[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

static double length_of(const double v[3]) {
  return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

static void direction_of(double z, double angle, double v[3]) {
  double r = sqrt(fmax(0.0, 1.0 - z * z));
  v[0] = r * cos(angle);
  v[1] = r * sin(angle);
  v[2] = z;
}

/* By how much of its depth the disc comes nearer. */
static double reach_of(const setting *s) {
  return fmax((double)s->kernel.cutoff, end_of(&s->kernel)) * hypot(s->t[0][2], s->t[1][2]) / s->p[2];
}

/* By how much of itself the plane's inverse depth changes over the filter's deviation. */
static double change_of(const setting *s) {
  double n[3], facing = 0.0;
  cross(s->t[0], s->t[1], n);
  for (int i = 0; i < 3; i++)
    facing += n[i] * s->p[i];
  return hypot(n[0], n[1]) * sqrt(s->prefilter) / s->focal * s->p[2] / fabs(facing);
}

/* The lesser deviation on the screen, over the filter's. */
static double thickness_of(const setting *s) {
  return outline_of(s, 1.0).axes[1] * s->focal / sqrt(s->prefilter);
}

/* Up to 50° off the axis, at distance 1, of any attitude, from 0.1 to 100 deviations of the filter across and up to 50
 * times as long as wide. Returns 0 where the disc comes nearer to the eye than 0.3 of its centre's depth. */
static int setting_of(const guess *g, const conic_kernel *kernel, setting *s) {
  const double *part = g->parts;
  double normal[3], any[3] = {0.0}, axes[2][3];
  s->kernel = *kernel;
  s->prefilter = (double)(float)power_between(part[0], 0.05, 4.0);
  s->focal = power_between(part[1], 100.0, 4000.0);
  direction_of(cos(part[2] * pi * 50.0 / 180.0), part[3] * 2.0 * pi, s->p);
  direction_of(2.0 * part[4] - 1.0, part[5] * 2.0 * pi, normal);
  any[fabs(normal[0]) < 0.6 ? 0 : 1] = 1.0;
  cross(normal, any, axes[0]);
  cross(normal, axes[0], axes[1]);
  double size = power_between(part[7], 0.1, 100.0) * sqrt(s->prefilter) / s->focal / length_of(axes[0]);
  double width = power_between(part[8], 0.02, 1.0), c = cos(part[6] * pi), e = sin(part[6] * pi);
  for (int i = 0; i < 3; i++) {
    s->t[0][i] = (double)(float)(size * (c * axes[0][i] + e * axes[1][i]));
    s->t[1][i] = (double)(float)(size * width * (c * axes[1][i] - e * axes[0][i]));
    s->p[i] = (double)(float)s->p[i];
  }
  return reach_of(s) <= 0.7;
}

/* Where the pixel's centre lies, from the principal point: in the widened outline or a little beside it. */
static void place_of(const guess *g, const setting *s, double x[2]) {
  ellipse e = outline_of(s, (double)s->kernel.cutoff);
  double f = s->focal, growth = (double)s->kernel.cutoff * sqrt(s->prefilter), angle = g->parts[10] * 2.0 * pi;
  double along = 1.05 * g->parts[9] * (f * e.axes[0] + growth) * cos(angle);
  double across = 1.05 * g->parts[9] * (f * e.axes[1] + growth) * sin(angle);
  x[0] = f * e.center[0] + cos(e.turn) * along - sin(e.turn) * across;
  x[1] = f * e.center[1] + sin(e.turn) * along + cos(e.turn) * across;
}

/* --- the search --- */

/* What a bound is for: a method, and the splats that it holds for. */
typedef struct search_case {
  conic_method method;
  double most_change, most_reach, least_thickness;
} search_case;

static const search_case cases[] = {{CONIC_METHOD_AUTO, 0.05, 0.7, 0.0},     {CONIC_METHOD_AUTO, 0.1, 0.7, 0.0},
                                    {CONIC_METHOD_AUTO, HUGE_VAL, 0.7, 0.0}, {CONIC_METHOD_CONIC, 0.05, 0.01, 0.0},
                                    {CONIC_METHOD_CONIC, 0.05, 0.05, 0.0},   {CONIC_METHOD_RAY, 0.01, 0.7, 2.5}};

enum { N_CASES = sizeof cases / sizeof *cases };

/* A kernel, and its bound in each case. */
typedef struct kind {
  conic_kernel kernel;
  double bounds[N_CASES];
} kind;

static const kind kinds[] = {{{CONIC_KERNEL_HAT, 1.0f, 0, 0, 0}, {0.045, 0.07, 0.85, 0.026, 0.065, 0.018}},
                             {{CONIC_KERNEL_HAT, 1.5f, 0, 0, 0}, {0.025, 0.045, 0.65, 0.026, 0.065, 0.018}},
                             {{CONIC_KERNEL_HAT, 3.0f, 0, 0, 0}, {0.04, 0.045, 0.45, 0.026, 0.065, 0.018}},
                             {{CONIC_KERNEL_CONFETTI, 1.5f, 6.0f, 1.5f, 3}, {0.055, 0.06, 0.5, 0.03, 0.125, 0.018}},
                             {{CONIC_KERNEL_CONFETTI, 1.5f, 4.0f, 1.5f, 5}, {0.045, 0.05, 0.5, 0.03, 0.11, 0.026}},
                             {{CONIC_KERNEL_CONFETTI, 3.0f, 4.0f, 3.0f, 5}, {0.035, 0.045, 0.45, 0.033, 0.11, 0.026}},
                             {{CONIC_KERNEL_BOX, 1.0f, 0, 0, 0}, {0.1, 0.1, 0.1, 0.035, 0.04, 0.45}},
                             {{CONIC_KERNEL_BOX, 1.5f, 0, 0, 0}, {0.1, 0.1, 0.1, 0.07, 0.07, 0.45}},
                             {{CONIC_KERNEL_BOX, 3.0f, 0, 0, 0}, {0.18, 0.18, 0.18, 0.07, 0.14, 0.5}}};

static const double least_peak = 0.125;

typedef struct found {
  double error;
  guess at;
} found;

/* The error of the pixel's weight over the splat's peak. A pixel beside the splat counts as right, one well within it
 * that is not covered does not. */
static double error_of(fixture *f, const setting *s, const double x[2], int is_within, int n_finer) {
  f->camera.fx = f->camera.fy = s->focal;
  f->camera.cx = 0.5 - x[0];
  f->camera.cy = 0.5 - x[1];
  fixture_set(f, 0, s->p, s->t[0], s->t[1], 1.0f, 1.0f, 1.0f);
  f->options.prefilter = (float)s->prefilter;
  f->options.kernel = s->kernel;
  CHECK_OK(conic_render(f->renderer, &f->splats, &f->camera, &f->options, &f->image, &f->statistics));
  const float *weights = f->image.planes[CONIC_PLANE_WEIGHT];
  double weight = (double)weights[0];
  if (!(weight > 1e-15) && !is_within)
    return 0.0;
  const double middle[2] = {s->focal * s->p[0] / s->p[2], s->focal * s->p[1] / s->p[2]};
  double peak = true_weight(s, middle, n_finer);
  return fabs(weight - true_weight(s, x, n_finer)) / fmax(peak, least_peak);
}

/* Below 0 where the splat is none of the case's. */
static double try_guess(fixture *f, const conic_kernel *kernel, const search_case *of, const guess *g, int n_finer) {
  setting s;
  double x[2];
  if (!setting_of(g, kernel, &s) || change_of(&s) > of->most_change || reach_of(&s) > of->most_reach ||
      thickness_of(&s) < of->least_thickness)
    return -1.0;
  place_of(g, &s, x);
  return error_of(f, &s, x, g->parts[9] < 0.6, n_finer);
}

/* From one of the worst of the random splats uphill. */
static void climb(fixture *f, const conic_kernel *kernel, const search_case *of, long n_steps, uint64_t *state,
                  found *best) {
  double step = 0.1;
  for (long i = 0; i < n_steps; i++) {
    guess next = best->at;
    for (int part = 0; part < N_PARTS_OF_GUESS; part++) {
      double value = next.parts[part];
      if (fixture_random(state) < 0.5)
        value += step * (2.0 * fixture_random(state) - 1.0);
      next.parts[part] = value < 0.0 ? 0.0 : value > 1.0 ? 1.0 : value;
    }
    double error = try_guess(f, kernel, of, &next, 1);
    step *= error > best->error ? 1.3 : 0.98;
    step = step < 1e-4 ? 0.1 : step > 0.3 ? 0.3 : step;
    if (error > best->error)
      *best = (found){error, next};
  }
}

enum { N_STARTS = 8 };

/* Keeps the worst, in order. */
static void keep_found(found starts[N_STARTS], const found *one) {
  for (int i = 0; i < N_STARTS; i++)
    if (one->error > starts[i].error) {
      memmove(starts + i + 1, starts + i, (size_t)(N_STARTS - 1 - i) * sizeof *starts);
      starts[i] = *one;
      return;
    }
}

static void print_found(const conic_kernel *kernel, const search_case *of, const found *best, double random) {
  setting s;
  setting_of(&best->at, kernel, &s);
  const double filter = s.focal / sqrt(s.prefilter);
  printf("%s, cutoff %g, %s, change up to %g, reach up to %g: %.4f, of random ones %.4f; the worst has %.3g and %.3g "
         "deviations of the filter, on the screen %.3g of them, h %.3g, change %.3g, reach %.3g\n",
         conic_kernel_type_name(kernel->type), (double)kernel->cutoff, conic_method_name(of->method), of->most_change,
         of->most_reach, best->error, random, length_of(s.t[0]) * filter, length_of(s.t[1]) * filter, thickness_of(&s),
         s.prefilter, change_of(&s), reach_of(&s));
  fflush(stdout);
}

static void search(fixture *f, const kind *asked, int i_case, long n, uint64_t *state) {
  const search_case *of = &cases[i_case];
  found starts[N_STARTS] = {{0.0}}, best = {0.0};
  f->options.method = of->method;
  for (long i = 0; i < n;) {
    found one;
    for (int part = 0; part < N_PARTS_OF_GUESS; part++)
      one.at.parts[part] = fixture_random(state);
    one.error = try_guess(f, &asked->kernel, of, &one.at, 1);
    i += one.error >= 0.0;
    keep_found(starts, &one);
  }
  const double random = starts[0].error;
  for (int i = 0; i < N_STARTS; i++) {
    climb(f, &asked->kernel, of, n / 10, state, &starts[i]);
    double surely = try_guess(f, &asked->kernel, of, &starts[i].at, 4);
    if (surely >= best.error)
      best = (found){surely, starts[i].at};
  }
  print_found(&asked->kernel, of, &best, random);
  CHECK(random > 1e-4);
  CHECK(best.error <= asked->bounds[i_case]);
}

int main(int argc, char **argv) {
  long n = argc > 1 ? strtol(argv[1], NULL, 10) : 0; /* the suite names a folder */
  uint64_t state = argc > 2 ? (uint64_t)strtol(argv[2], NULL, 10) : 1;
  n = n > 0 ? n : 150;
  find_rule(N_ALONG, along_places, along_weights);
  find_rule(N_LEVELS, level_places, level_weights);
  fixture f = fixture_open(1);
  fixture_splats(&f, 1);
  fixture_camera(&f, 1, 1, 100.0);
  f.options.near_z = 1e-3;
  CHECK_OK(conic_image_allocate(f.context, 1, 1, 1u << CONIC_PLANE_WEIGHT, &f.image));
  for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
    for (int i_case = 0; i_case < N_CASES; i_case++)
      search(&f, &kinds[i], i_case, n, &state);
  fixture_close(&f);
  return check_result();
}
