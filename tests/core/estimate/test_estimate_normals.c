/* Normals of raw points: across the surface, and all outwards where it is closed. */
#include "tests/support/outlines.h"

static const double turn = 6.283185307179586;

/* How many of the splats have a normal that points with `normals[i]`, and the least cosine's magnitude. */
static size_t count_outward(const conic_model *model, const double (*normals)[3], double *least) {
  size_t n = 0;
  *least = 1.0;
  for (size_t i = 0; i < model->points.count; i++) {
    outlines_splat s = outlines_get(&model->points, i);
    double cosine = 0.0;
    for (int axis = 0; axis < 3; axis++)
      cosine += s.normal[axis] * normals[i][axis];
    n += cosine > 0.0;
    *least = fmin(*least, fabs(cosine));
  }
  return n;
}

enum { N = 4000 };
static double normals[N][3];

static void fill_sphere(conic_model *model, double radius, double x, uint64_t seed) {
  uint64_t state = seed;
  while (model->points.count < N) {
    double p[3], length2 = 0.0;
    for (int axis = 0; axis < 3; axis++) {
      p[axis] = 2.0 * random_unit(&state) - 1.0;
      length2 += p[axis] * p[axis];
    }
    if (length2 > 1.0 || length2 < 0.01)
      continue;
    size_t i = outlines_add(model, x + radius * p[0] / sqrt(length2), radius * p[1] / sqrt(length2),
                            radius * p[2] / sqrt(length2));
    for (int axis = 0; axis < 3; axis++)
      normals[i][axis] = p[axis] / sqrt(length2);
  }
}

static void check_sphere(conic_context *context) {
  conic_model model = outlines_model(context, N, 0);
  double least;
  fill_sphere(&model, 2.0, 1000.0, 1);
  conic_repairs repairs = outlines_estimate(context, &model);
  CHECK(count_outward(&model, (const double(*)[3])normals, &least) == N);
  CHECK(least > 0.97);
  CHECK(repairs.zero == 0 && repairs.isolated == 0);
  conic_model_release(context, &model);
}

/* A torus with a thin tube: neighbours through the wall are not far. */
static void check_torus(conic_context *context) {
  conic_model model = outlines_model(context, N, 0);
  uint64_t state = 2;
  double least;
  for (int i = 0; i < N; i++) {
    double a = turn * random_unit(&state), b = turn * random_unit(&state), r = 1.0 + 0.3 * cos(b);
    outlines_add(&model, r * cos(a), 0.3 * sin(b), r * sin(a));
    normals[i][0] = cos(a) * cos(b);
    normals[i][1] = sin(b);
    normals[i][2] = sin(a) * cos(b);
  }
  outlines_estimate(context, &model);
  CHECK(count_outward(&model, (const double(*)[3])normals, &least) == N);
  conic_model_release(context, &model);
}

/* A box: sharp edges of 90°. */
static void check_box(conic_context *context) {
  conic_model model = outlines_model(context, N, 0);
  uint64_t state = 3;
  double least;
  memset(normals, 0, sizeof normals);
  for (int i = 0; i < N; i++) {
    int axis = i % 3, side = i / 3 % 2;
    double p[3];
    for (int j = 0; j < 3; j++)
      p[j] = random_unit(&state) - 0.5;
    p[axis] = side - 0.5;
    normals[i][axis] = side ? 1.0 : -1.0;
    outlines_add(&model, p[0], p[1], p[2]);
  }
  outlines_estimate(context, &model);
  CHECK(count_outward(&model, (const double(*)[3])normals, &least) == N);
  conic_model_release(context, &model);
}

/* A wall whose two sides are two spacings apart. */
static void check_wall(conic_context *context) {
  conic_model model = outlines_model(context, N, 0);
  uint64_t state = 4;
  double least;
  int side = 36;
  memset(normals, 0, sizeof normals);
  for (int i = 0; i < 2 * side * side; i++) {
    int is_upper = i >= side * side, at = i % (side * side);
    outlines_add(&model, at % side + 0.4 * random_unit(&state), at / side + 0.4 * random_unit(&state),
                 is_upper ? 2.0 : 0.0);
    normals[i][2] = is_upper ? 1.0 : -1.0;
  }
  outlines_estimate(context, &model);
  size_t n = count_outward(&model, (const double(*)[3])normals, &least);
  /* Each side is one-sided; along the open rim the neighbours are of both, so that few may differ. */
  CHECK(n > 2 * (size_t)(side * side) * 98 / 100);
  conic_model_release(context, &model);
}

/* Where some points have normals, even inward ones, the others follow. */
static void check_partly_given(conic_context *context) {
  conic_model model = outlines_model(context, N, CONIC_SPLATS_NORMALS);
  double least;
  fill_sphere(&model, 1.0, 0.0, 5);
  for (size_t i = 0; i < N; i++)
    for (int axis = 0; axis < 3; axis++)
      model.points.normal[axis][i] = i % 50 ? (i % 3 ? 0.0f : NAN) : (float)(-7.0 * normals[i][axis]);
  conic_repairs repairs = outlines_estimate(context, &model);
  CHECK(repairs.zero == N - N / 50);
  CHECK(count_outward(&model, (const double(*)[3])normals, &least) == 0);
  CHECK(least > 0.97);
  conic_model_release(context, &model);
}

int main(void) {
  conic_context *context = check_context(2);
  check_sphere(context);
  check_torus(context);
  check_box(context);
  check_wall(context);
  check_partly_given(context);
  conic_context_destroy(context);
  return check_result();
}
