/* Confetti's own ellipses, around all k neighbours: no larger than they must be, with the covariance's axes; and what
 * they cover of patterns that scanners leave. */
#include "tests/support/outlines.h"

enum { N_POINTS = 400, MOST_NEIGHBOURS = 20 };

static void bound(conic_context *context, conic_model *model, int n_neighbours) {
  conic_estimate_options options;
  conic_estimate_options_init(&options);
  options.ellipse = CONIC_ELLIPSE_BOUNDING;
  options.n_neighbours = n_neighbours;
  CHECK_OK(conic_model_to_splats(context, &options, model, NULL));
}

/* The k nearest of point i in the plane, found one by one. */
static void find_nearest(const conic_splats *points, size_t i, int k, double nearest[][2]) {
  char is_taken[N_POINTS] = {0};
  is_taken[i] = 1;
  for (int n = 0; n < k; n++) {
    size_t best = i;
    double least = HUGE_VAL;
    for (size_t j = 0; j < points->count; j++) {
      double x = (double)points->position[0][j] - (double)points->position[0][i];
      double y = (double)points->position[1][j] - (double)points->position[1][i];
      if (!is_taken[j] && x * x + y * y < least) {
        least = x * x + y * y;
        nearest[n][0] = x;
        nearest[n][1] = y;
        best = j;
      }
    }
    is_taken[best] = 1;
  }
}

/* Whether the splat is the least ellipse of the covariance's axes that holds the neighbours. */
static int is_within_ellipse(const outlines_splat *s, double nearest[][2], int k) {
  double xx = 0.0, xy = 0.0, yy = 0.0, farthest = 0.0;
  for (int n = 0; n < k; n++) {
    double x = nearest[n][0], y = nearest[n][1];
    double u = x * s->u[0] + y * s->u[1], v = x * s->v[0] + y * s->v[1];
    double a2 = s->a * s->a / 2.25, b2 = s->b * s->b / 2.25; /* the squares of the axes' lengths */
    xx += x * x;
    xy += x * y;
    yy += y * y;
    farthest = fmax(farthest, sqrt(u * u / (a2 * a2) + v * v / (b2 * b2)));
  }
  double half = 0.5 * (xx - yy), root = sqrt(half * half + xy * xy), middle = 0.5 * (xx + yy);
  double ratio = fmax(sqrt((middle - root) / (middle + root)), 0.2);
  double along = xx * s->u[0] * s->u[0] + 2.0 * xy * s->u[0] * s->u[1] + yy * s->u[1] * s->u[1];
  return fabs(farthest - 1.5) < 1e-4 && fabs(s->b / s->a - ratio) < 1e-4 &&
         fabs(along / (s->a * s->a / 2.25) - (middle + root)) < 1e-3 * middle;
}

static void check_shapes(conic_context *context) {
  for (int k = 6; k <= MOST_NEIGHBOURS; k += 7) {
    conic_model model = outlines_model(context, N_POINTS, 0);
    double nearest[MOST_NEIGHBOURS][2];
    uint64_t state = 21;
    for (int i = 0; i < N_POINTS; i++)
      outlines_add(&model, 30.0 * random_unit(&state), 10.0 * random_unit(&state), 0.0);
    bound(context, &model, k);
    int n_wrong = 0, n_spread = 0;
    for (size_t i = 0; i < N_POINTS; i++) {
      outlines_splat s = outlines_get(&model.points, i);
      find_nearest(&model.points, i, k, nearest);
      n_wrong += !is_within_ellipse(&s, nearest, k);
      n_spread += s.a > 0.0;
    }
    CHECK(n_wrong == 0 && n_spread == N_POINTS);
    conic_model_release(context, &model);
  }
}

typedef struct pattern {
  const char *name;
  double across, step; /* lines so far apart, points so far on them */
  double jitter;
} pattern;

/* The share of 90 × 90 places that no outline covers, and how many lie on one. */
static double uncovered(const conic_splats *splats, double *overlap) {
  static const double along_z[3] = {0.0, 0.0, 1.0};
  int n_uncovered = 0, n_outlines = 0;
  for (int i = 0; i < 90; i++)
    for (int j = 0; j < 90; j++) {
      const double p[3] = {8.0 + 24.0 * (i + 0.5) / 90.0, 8.0 + 24.0 * (j + 0.5) / 90.0, 0.0};
      int n = outlines_count(splats, 0, splats->count, p, along_z, 0.2);
      n_uncovered += n == 0;
      n_outlines += n;
    }
  *overlap = n_outlines / 8100.0;
  return n_uncovered / 8100.0;
}

/* Few neighbours lie on one scan line, and tell nothing of the next: the Voronoi cell covers what is between. */
static void check_patterns(conic_context *context) {
  static const pattern patterns[] = {
      {"grid", 1.0, 1.0, 0.0}, {"random", 1.0, 1.0, 1.0}, {"lines 1 : 4", 4.0, 1.0, 0.0}};
  double share[3][4], overlap;
  for (int i = 0; i < 3; i++)
    for (int i_k = 0; i_k < 4; i_k++) {
      static const int counts[4] = {6, 8, 12, 20};
      const pattern *p = &patterns[i];
      conic_model model = outlines_model(context, 1681, 0);
      uint64_t state = 22;
      for (double y = 0.0; y <= 40.0; y += p->across)
        for (double x = 0.0; x <= 40.0; x += p->step)
          outlines_add(&model, x + p->jitter * (random_unit(&state) - 0.5), y + p->jitter * (random_unit(&state) - 0.5),
                       0.0);
      bound(context, &model, counts[i_k]);
      share[i][i_k] = uncovered(&model.points, &overlap);
      fprintf(stderr, "%s, k = %d: %.2f %% uncovered, %.1f outlines on each other\n", p->name, counts[i_k],
              100.0 * share[i][i_k], overlap);
      conic_model_release(context, &model);
    }
  CHECK(share[0][0] == 0.0 && share[1][3] == 0.0);
  CHECK(share[2][0] > 0.5 && share[2][3] == 0.0);
}

static void check_rule(conic_context *context) {
  conic_model model = outlines_model(context, 1, 0);
  conic_estimate_options options;
  conic_estimate_options_init(&options);
  CHECK(options.ellipse == CONIC_ELLIPSE_VORONOI);
  options.ellipse = (conic_ellipse_rule)2;
  CHECK(conic_model_to_splats(context, &options, &model, NULL) == CONIC_ERROR_ARGUMENT);
  conic_model_release(context, &model);
}

int main(void) {
  conic_context *context = check_context(2);
  check_shapes(context);
  check_patterns(context);
  check_rule(context);
  conic_context_destroy(context);
  return check_result();
}
