/* What is broken gets repaired, what is good stays bit for bit; threads and scale change nothing. */
#include "tests/support/outlines.h"

static float *const *array_of(const conic_splats *splats, int i) {
  return i < 3 ? &splats->tangent_u[i] : &splats->tangent_v[i - 3];
}

static int same_axes(const conic_splats *a, size_t i, const conic_splats *b, size_t j) {
  for (int k = 0; k < 6; k++)
    if (memcmp(*array_of(a, k) + i, *array_of(b, k) + j, sizeof(float)) != 0)
      return 0;
  return 1;
}

/* A bumpy disc of random points with normals and duplicates, all positions times `scale`. */
static conic_model bumpy(conic_context *context, double scale, unsigned fields) {
  conic_model model = outlines_model(context, 3000, fields);
  uint64_t state = 21;
  for (int i = 0; i < 3000; i++) {
    double x = 10.0 * random_unit(&state), y = 10.0 * random_unit(&state);
    outlines_add(&model, scale * x, scale * y, scale * 0.5 * sin(x) * cos(y));
    if (i % 100 == 99)
      for (int axis = 0; axis < 3; axis++)
        model.points.position[axis][i] = model.points.position[axis][i - 50];
    for (int axis = 0; axis < 3 && model.points.color[0]; axis++)
      model.points.color[axis][i] = (float)random_unit(&state);
  }
  return model;
}

static void check_threads(void) {
  conic_context *contexts[3] = {check_context(1), check_context(2), check_context(7)};
  conic_model models[3];
  for (int i = 0; i < 3; i++) {
    models[i] = bumpy(contexts[i], 1.0, 0);
    outlines_estimate(contexts[i], &models[i]);
  }
  for (size_t j = 0; j < 3000; j++)
    CHECK(same_axes(&models[0].points, j, &models[1].points, j) &&
          same_axes(&models[0].points, j, &models[2].points, j));
  for (int i = 0; i < 3; i++) {
    conic_model_release(contexts[i], &models[i]);
    conic_context_destroy(contexts[i]);
  }
}

static void check_scales(conic_context *context) {
  const double scales[] = {1e-6, 1e6, 1e-20, 1e20};
  conic_model model = bumpy(context, 1.0, 0);
  conic_repairs repairs = outlines_estimate(context, &model);
  CHECK(repairs.duplicate == 30);
  for (int i = 0; i < 4; i++) {
    conic_model scaled = bumpy(context, scales[i], 0);
    conic_repairs scaled_repairs = outlines_estimate(context, &scaled);
    CHECK(memcmp(&repairs, &scaled_repairs, sizeof repairs) == 0);
    size_t n_different = 0;
    for (size_t j = 0; j < 3000; j++) {
      double size = fabs(outlines_get(&model.points, j).a);
      for (int k = 0; k < 6; k++)
        n_different += (size_t) !(fabs((double)(*array_of(&model.points, k))[j] -
                                       (double)(*array_of(&scaled.points, k))[j] / scales[i]) <= 1e-3 * size);
    }
    /* Rounded positions may turn a near-circular cell's direction. */
    CHECK(n_different <= 3000 * 6 / 500);
    conic_model_release(context, &scaled);
  }
  conic_model_release(context, &model);
}

/* Splats that came with axes, some of them broken. */
static void check_axes_kept(conic_context *context) {
  conic_model model = bumpy(context, 1.0, 0), broken = bumpy(context, 1.0, CONIC_SPLATS_TANGENTS);
  outlines_estimate(context, &model);
  for (size_t i = 0; i < 3000; i++)
    for (int k = 0; k < 6; k++)
      (*array_of(&broken.points, k))[i] = (*array_of(&model.points, k))[i] * 0.7f;
  conic_repairs repairs = outlines_estimate(context, &broken);
  CHECK(repairs.nan + repairs.zero + repairs.duplicate + repairs.isolated + repairs.failed == 0);
  for (size_t i = 0; i < 3000; i++)
    for (int k = 0; k < 6; k++)
      CHECK((*array_of(&broken.points, k))[i] == (*array_of(&model.points, k))[i] * 0.7f);

  broken.points.tangent_u[1][77] = NAN;
  for (int k = 3; k < 6; k++)
    (*array_of(&broken.points, k))[1500] = 0.0f;
  broken.points.position[2][2000] = HUGE_VALF;
  repairs = outlines_estimate(context, &broken);
  CHECK(repairs.nan == 1 && repairs.zero == 2 && repairs.failed == 0);
  CHECK(isnan(broken.points.tangent_u[0][2000]));
  for (size_t i = 0; i < 3000; i++) {
    outlines_splat s = outlines_get(&broken.points, i), whole = outlines_get(&model.points, i);
    if (i == 77 || i == 1500) {
      /* As it would be among points without axes: of the same size and side. */
      CHECK(s.a > 0.5 * whole.a && s.a < 2.0 * whole.a);
      CHECK(s.normal[0] * whole.normal[0] + s.normal[1] * whole.normal[1] + s.normal[2] * whole.normal[2] > 0.8);
    } else if (i != 2000)
      for (int k = 0; k < 6; k++)
        CHECK((*array_of(&broken.points, k))[i] == (*array_of(&model.points, k))[i] * 0.7f);
  }
  conic_model_release(context, &model);
  conic_model_release(context, &broken);
}

static void check_nowhere_and_colors(conic_context *context) {
  conic_model model = bumpy(context, 1.0, CONIC_SPLATS_COLORS);
  float green = model.points.color[1][9];
  model.points.position[0][5] = NAN;
  model.points.position[1][6] = -HUGE_VALF;
  model.points.color[0][8] = NAN;
  conic_repairs repairs = outlines_estimate(context, &model);
  CHECK(repairs.nan == 2 && repairs.failed == 0);
  for (int k = 0; k < 6; k++)
    CHECK(isnan((*array_of(&model.points, k))[5]) && isnan((*array_of(&model.points, k))[6]));
  for (int channel = 0; channel < 3; channel++)
    CHECK(model.points.color[channel][8] == 1.0f);
  CHECK(model.points.color[1][9] == green);
  conic_model_release(context, &model);
}

/* Sets too small for a neighbourhood: something small and positive for each. */
static void check_tiny(conic_context *context) {
  for (size_t n = 0; n <= 8; n++)
    for (int is_one_place = 0; is_one_place < 2; is_one_place++) {
      conic_model model = outlines_model(context, 8, 0);
      for (size_t i = 0; i < n; i++)
        outlines_add(&model, 5.0 + (is_one_place ? 0.0 : (double)i), 6.0, 7.0);
      conic_repairs repairs = outlines_estimate(context, &model);
      CHECK(repairs.duplicate == (is_one_place && n ? n - 1 : 0) && repairs.failed == 0);
      for (size_t i = 0; i < n; i++) {
        outlines_splat s = outlines_get(&model.points, i);
        CHECK(s.b > 0.0 && s.a < (is_one_place ? 0.1 : 4.0));
      }
      conic_model_release(context, &model);
    }
}

static int cancel_late(void *cookie, const char *task, double fraction) {
  int *n_left = cookie;
  CHECK(strcmp(task, "estimate") == 0 && fraction >= 0.0 && fraction <= 1.0);
  return --*n_left < 0;
}

/* Cancelled at any of its reports, or out of memory at any allocation, the model is as it was. */
static void check_cancelled(void) {
  conic_context_options options;
  conic_estimate_options estimate;
  conic_context *context;
  int n_left = 0, n_cancelled = 0;
  conic_context_options_init(&options);
  conic_estimate_options_init(&estimate);
  options.progress = cancel_late;
  options.progress_cookie = &n_left;
  CHECK_OK(conic_context_create(&options, &context));
  conic_model model = bumpy(context, 1.0, 0);
  for (int n = 0; n < 100; n++) {
    n_left = n;
    conic_status status = conic_model_to_splats(context, &estimate, &model, NULL);
    if (status == CONIC_OK)
      break;
    CHECK(status == CONIC_ERROR_CANCELLED && !model.points.tangent_u[0]);
    n_cancelled++;
  }
  CHECK(n_cancelled > 3 && n_cancelled < 100 && model.points.tangent_u[0]);
  conic_model_release(context, &model);
  conic_context_destroy(context);
}

typedef struct failing_allocator {
  int n_left; /* allocations until one fails */
  long n_held;
} failing_allocator;

static void *allocate_or_fail(void *cookie, size_t bytes) {
  failing_allocator *allocator = cookie;
  if (--allocator->n_left < 0)
    return NULL;
  allocator->n_held++;
  return malloc(bytes);
}

static void release_counted(void *cookie, void *pointer) {
  failing_allocator *allocator = cookie;
  allocator->n_held--;
  free(pointer);
}

static void check_out_of_memory(void) {
  conic_context_options options;
  conic_estimate_options estimate;
  conic_context *context;
  failing_allocator allocator = {1000, 0};
  int n_failed = 0;
  conic_context_options_init(&options);
  conic_estimate_options_init(&estimate);
  options.allocate = allocate_or_fail;
  options.release = release_counted;
  options.allocator_cookie = &allocator;
  options.threads = 1;
  CHECK_OK(conic_context_create(&options, &context));
  conic_model model = bumpy(context, 1.0, 0);
  long n_held = allocator.n_held;
  for (int n = 0; n < 100; n++) {
    allocator.n_left = n;
    if (conic_model_to_splats(context, &estimate, &model, NULL) == CONIC_OK)
      break;
    CHECK(allocator.n_held == n_held && !model.points.tangent_u[0]);
    n_failed++;
  }
  CHECK(n_failed > 10 && n_failed < 100 && allocator.n_held == n_held + 6);
  allocator.n_left = 1000;
  conic_model_release(context, &model);
  conic_context_destroy(context);
  CHECK(allocator.n_held == 0);
}

static void check_options(conic_context *context) {
  conic_model model = outlines_model(context, 1, 0);
  conic_estimate_options options;
  outlines_add(&model, 0, 0, 0);
  const int wrong_k[] = {5, 65, -1};
  const float wrong_cutoff[] = {0.0f, -1.0f, NAN, HUGE_VALF};
  for (int i = 0; i < 3; i++) {
    conic_estimate_options_init(&options);
    options.n_neighbours = wrong_k[i];
    CHECK(conic_model_to_splats(context, &options, &model, NULL) == CONIC_ERROR_ARGUMENT);
  }
  for (int i = 0; i < 4; i++) {
    conic_estimate_options_init(&options);
    options.cutoff = wrong_cutoff[i];
    CHECK(conic_model_to_splats(context, &options, &model, NULL) == CONIC_ERROR_ARGUMENT);
  }
  conic_model_release(context, &model);
}

int main(void) {
  conic_context *context = check_context(2);
  check_threads();
  check_scales(context);
  check_axes_kept(context);
  check_nowhere_and_colors(context);
  check_tiny(context);
  check_cancelled();
  check_out_of_memory();
  check_options(context);
  conic_context_destroy(context);
  return check_result();
}
