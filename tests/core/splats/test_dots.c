/* Which points become dots: those that fill a space or make a wire, and none of a surface, however sharp, thin, noisy
 * or unevenly sampled; and how dots turn to the camera. */
#include "tests/support/outlines.h"

static double uniform(uint64_t *state, double from, double to) {
  return from + (to - from) * random_unit(state);
}

static conic_repairs find_dots(conic_context *context, conic_model *model) {
  conic_estimate_options options;
  conic_repairs repairs;
  int is_raw = !model->points.tangent_u[0];
  conic_estimate_options_init(&options);
  CHECK(!options.finds_dots);
  options.finds_dots = 1;
  CHECK_OK(conic_model_to_splats(context, &options, model, &repairs));
  CHECK(repairs.dots == (is_raw ? conic_splats_count_dots(&model->points) : 0));
  return repairs;
}

/* Finds the dots among [begin, end), and releases the model. */
static void check_share(conic_context *context, const char *name, conic_model *model, size_t begin, size_t end,
                        double least, double greatest) {
  size_t n = 0;
  find_dots(context, model);
  for (size_t i = begin; i < end; i++)
    n += model->points.dot && model->points.dot[i] != 0.0f;
  double share = (double)n / (double)(end - begin);
  fprintf(stderr, "%s: %.2f %% dots\n", name, 100.0 * share);
  CHECK(share >= least && share <= greatest);
  conic_model_release(context, model);
}

enum { N = 8000 };

/* --- surfaces --- */

static void add_in_plane(conic_model *model, uint64_t *state, size_t n, double height, double noise) {
  for (size_t i = 0; i < n; i++)
    outlines_add(model, uniform(state, 0, 80), uniform(state, 0, 100), height + noise * uniform(state, -1, 1));
}

/* A cube's faces meet in sharp edges and corners. */
static void check_cube(conic_context *context) {
  conic_model model = outlines_model(context, N, 0);
  uint64_t state = 1;
  for (int i = 0; i < N; i++) {
    double a = uniform(&state, 0, 36), b = uniform(&state, 0, 36), c = i % 2 ? 36 : 0;
    int axis = i / 2 % 3;
    outlines_add(&model, axis == 0 ? c : a, axis == 1 ? c : axis == 0 ? a : b, axis == 2 ? c : b);
  }
  check_share(context, "cube", &model, 0, N, 0.0, 0.001);
}

static void check_sphere(conic_context *context, size_t n, double noise) {
  conic_model model = outlines_model(context, n, 0);
  uint64_t state = 2;
  for (size_t i = 0; i < n; i++) {
    double p[3], r2, radius = sqrt((double)n / 12.566) + noise * uniform(&state, -1, 1);
    do {
      for (int axis = 0; axis < 3; axis++)
        p[axis] = uniform(&state, -1, 1);
      r2 = p[0] * p[0] + p[1] * p[1] + p[2] * p[2];
    } while (!(r2 > 0.01 && r2 < 1.0));
    outlines_add(&model, radius * p[0] / sqrt(r2), radius * p[1] / sqrt(r2), radius * p[2] / sqrt(r2));
  }
  check_share(context, "sphere", &model, 0, n, 0.0, 0.01);
}

/* Two sheets one spacing apart, each noisy by a fifth; scan lines fifteen times as far apart as their points. */
static void check_sheets_and_lines(conic_context *context) {
  conic_model model = outlines_model(context, N, 0);
  uint64_t state = 3;
  add_in_plane(&model, &state, N / 2, 0.0, 0.2);
  add_in_plane(&model, &state, N / 2, 1.0, 0.2);
  check_share(context, "two sheets", &model, 0, N, 0.0, 0.01);
  model = outlines_model(context, N, 0);
  for (int i = 0; i < N; i++)
    outlines_add(&model, (i % 400 + 0.4 * uniform(&state, 0, 1)) / 15.0, i / 400, 0.0);
  check_share(context, "scan lines", &model, 0, N, 0.0, 0.01);
}

/* --- no surfaces --- */

static void add_in_ball(conic_model *model, uint64_t *state, size_t n, double height) {
  for (size_t i = 0; i < n; i++) {
    double x, y, z;
    do {
      x = uniform(state, -1, 1);
      y = uniform(state, -1, 1);
      z = uniform(state, -1, 1);
    } while (x * x + y * y + z * z > 1.0);
    outlines_add(model, 40 + 8 * x, 50 + 8 * y, height + 8 * z);
  }
}

static void check_tree(conic_context *context) {
  conic_model model = outlines_model(context, N + 2000, 0), other = outlines_model(context, N + 2000, 0);
  uint64_t state = 4;
  add_in_plane(&model, &state, N, 0.0, 0.1);
  add_in_ball(&model, &state, 2000, 16.0);
  CHECK_OK(conic_splats_append(context, &other.points, &model.points));
  check_share(context, "ground", &model, 0, N, 0.0, 0.001);
  check_share(context, "tree", &other, N, N + 2000, 0.98, 1.0);
}

static void check_wire(conic_context *context) {
  conic_model model = outlines_model(context, 500, 0);
  uint64_t state = 5;
  for (int i = 0; i < 500; i++)
    outlines_add(&model, i + uniform(&state, -0.2, 0.2), uniform(&state, -0.2, 0.2), 1e-4 * (i - 250) * (i - 250));
  check_share(context, "wire", &model, 0, 500, 0.99, 1.0);
}

/* A dot is round, has the size of its neighbourhood, and points out of it; a normal of the file's stays. */
static void check_what_dots_get(conic_context *context) {
  conic_model model = outlines_model(context, 2000, CONIC_SPLATS_NORMALS);
  uint64_t state = 6;
  add_in_ball(&model, &state, 2000, 0.0);
  for (int i = 0; i < 2000; i++)
    for (int axis = 0; axis < 3; axis++)
      model.points.normal[axis][i] = i % 2 && axis == i / 2 % 3 ? 2.0f : 0.0f;
  CHECK(find_dots(context, &model).dots > 1900);
  double sum = 0.0, greatest = 0.0, least = 1e9, outwards = 0.0;
  for (size_t i = 0; i < 2000; i++) {
    outlines_splat s = outlines_get(&model.points, i);
    if (!(model.points.dot[i] != 0.0f))
      continue;
    CHECK_NEAR(s.a, s.b, 1e-5);
    sum += s.a / 2000.0;
    greatest = s.a > greatest ? s.a : greatest;
    least = s.a < least ? s.a : least;
    const double from[3] = {s.center[0] - 40, s.center[1] - 50, s.center[2]};
    double distance = sqrt(from[0] * from[0] + from[1] * from[1] + from[2] * from[2]);
    if (i % 2)
      CHECK(s.normal[i / 2 % 3] > 1.0 - 1e-6);
    else if (distance > 7.0)
      outwards += (from[0] * s.normal[0] + from[1] * s.normal[1] + from[2] * s.normal[2]) / distance > 0.7 ? 1 : -1;
  }
  /* A point has a cube of edge 1.02 to itself: its second neighbour is at 0.75 of that. */
  CHECK(sum > 0.4 && sum < 0.6 && least > 0.25 && greatest < 1.0);
  CHECK(outwards > 100.0);
  conic_model_release(context, &model);
}

static double largest(const conic_splats *points, size_t begin, size_t end) {
  double greatest = 0.0;
  for (size_t i = begin; i < end; i++) {
    double a = outlines_get(points, i).a;
    greatest = a > greatest ? a : greatest;
  }
  return greatest;
}

/* A tree's sparse top is no heap of blobs; nor are a few points, as if of a surface, among its leaves. */
static void check_sizes_are_alike(conic_context *context) {
  conic_model model = outlines_model(context, N + 400, 0);
  uint64_t state = 9;
  add_in_ball(&model, &state, N, 0.0);
  for (int i = 0; i < 400; i++)
    outlines_add(&model, 40 + 12.0 * (i % 20), 50 + 12.0 * (i / 20), 60.0 + (i < 200 ? 0.0 : uniform(&state, 0, 60)));
  find_dots(context, &model);
  double usual = largest(&model.points, 0, N);
  CHECK(usual > 0.3 && usual < 1.0);
  CHECK(largest(&model.points, N, N + 400) < 3.1 * 0.4);
  conic_model_release(context, &model);
}

/* Where ground reaches into a denser bush, what is larger than twice the middle of those around it is cut to that. */
static void check_ground_in_a_bush(conic_context *context) {
  conic_model model = outlines_model(context, N + 6000, 0);
  uint64_t state = 10;
  int n_small = 0;
  add_in_plane(&model, &state, N, 0.0, 0.1);
  add_in_ball(&model, &state, 6000, 6.0);
  find_dots(context, &model);
  for (size_t i = 0; i < N; i++) {
    outlines_splat s = outlines_get(&model.points, i);
    int is_near = hypot(s.center[0] - 40, s.center[1] - 50) < 9.0 && model.points.dot[i] == 0.0f;
    n_small += is_near && s.a < 1.1;
  }
  CHECK(n_small >= 4);
  conic_model_release(context, &model);
}

/* The same for any number of threads; a point far from all is one; nothing is without the option. */
static void check_option(conic_context *context) {
  conic_context *alone = check_context(1);
  conic_model models[3];
  for (int k = 0; k < 3; k++) {
    uint64_t state = 7;
    models[k] = outlines_model(context, N, 0);
    add_in_ball(&models[k], &state, N - 1, 20.0);
    outlines_add(&models[k], 40, 50, 1000);
  }
  find_dots(context, &models[0]);
  find_dots(alone, &models[1]);
  CHECK(outlines_estimate(context, &models[2]).dots == 0 && !models[2].points.dot);
  for (int axis = 0; axis < 3; axis++)
    CHECK(memcmp(models[0].points.tangent_u[axis], models[1].points.tangent_u[axis], N * sizeof(float)) == 0);
  CHECK(memcmp(models[0].points.dot, models[1].points.dot, N * sizeof(float)) == 0);
  CHECK(models[0].points.dot[N - 1] == 1.0f);
  /* Who has axes stays what it is. */
  models[2].points.dot = models[0].points.dot;
  models[0].points.dot = NULL;
  models[2].points.dot[5] = 0.0f;
  find_dots(context, &models[2]);
  CHECK(models[2].points.dot[5] == 0.0f && models[2].points.dot[N - 1] == 1.0f);
  for (int k = 0; k < 3; k++)
    conic_model_release(k == 1 ? alone : context, &models[k]);
  conic_context_destroy(alone);
}

/* --- facing --- */

static void check_facing(conic_context *context) {
  static float packed[4][13]; /* position, u, v, dot and room */
  float faced[6][4] = {{0.0f}};
  float *const u[3] = {faced[0], faced[1], faced[2]}, *const v[3] = {faced[3], faced[4], faced[5]};
  const size_t stride = sizeof packed[0];
  conic_splats splats = {.count = 4,
                         .strides = {.position = stride, .tangent_u = stride, .tangent_v = stride, .dot = stride}};
  conic_camera camera = {.width = 64, .height = 64, .fx = 64, .fy = 64, .cx = 32, .cy = 32};
  for (int axis = 0; axis < 3; axis++) {
    splats.position[axis] = &packed[0][axis];
    splats.tangent_u[axis] = &packed[0][3 + axis];
    splats.tangent_v[axis] = &packed[0][6 + axis];
    splats.origin[axis] = 100.0 * (axis + 1);
    camera.cam_from_world[axis][axis] = 1.0;
  }
  splats.dot = &packed[0][9];
  /* At (7, 8, 0) from the origin, looking along z; one splat is none, one's normal is across the line of sight. */
  const double eye[3] = {107, 208, 300};
  for (int axis = 0; axis < 3; axis++)
    camera.cam_from_world[axis][3] = -eye[axis];
  for (int i = 0; i < 4; i++) {
    const float at[10] = {(float)(6 + i), (float)(9 - i), 10, 0, 0.5f, 0, 0, 0, 0.5f, i != 3};
    memcpy(packed[i], at, sizeof at);
  }
  packed[1][3 + 0] = packed[2][6 + 0] = 0.4f;
  CHECK(conic_splats_count_dots(&splats) == 3);
  CHECK_OK(conic_splats_face(context, &splats, &camera, u, v));
  for (int i = 0; i < 3; i++) {
    double uu = 0, vv = 0, uv = 0, ub = 0, vb = 0, bb = 0, sigma2 = 0, other2 = 0, back[3], normal[3], own[3];
    for (int axis = 0; axis < 3; axis++) {
      back[axis] = eye[axis] - splats.origin[axis] - (double)packed[i][axis];
      int next = (axis + 1) % 3, last = (axis + 2) % 3;
      normal[axis] = (double)u[next][i] * (double)v[last][i] - (double)u[last][i] * (double)v[next][i];
      own[axis] = (double)packed[i][3 + next] * (double)packed[i][6 + last] -
                  (double)packed[i][3 + last] * (double)packed[i][6 + next];
      uu += (double)u[axis][i] * (double)u[axis][i];
      vv += (double)v[axis][i] * (double)v[axis][i];
      uv += (double)u[axis][i] * (double)v[axis][i];
      ub += (double)u[axis][i] * back[axis];
      vb += (double)v[axis][i] * back[axis];
      bb += back[axis] * back[axis];
      sigma2 += (double)packed[i][3 + axis] * (double)packed[i][3 + axis];
      other2 += (double)packed[i][6 + axis] * (double)packed[i][6 + axis];
    }
    sigma2 = sigma2 > other2 ? sigma2 : other2;
    double nn = 0, nb = 0, no = 0, oo = 0, ob = 0;
    for (int axis = 0; axis < 3; axis++) {
      nn += normal[axis] * normal[axis];
      nb += normal[axis] * back[axis];
      no += normal[axis] * own[axis];
      oo += own[axis] * own[axis];
      ob += own[axis] * back[axis];
    }
    /* Across the line of sight both are one radius long, and at right angles; the second leans along it. */
    CHECK_NEAR(uv, 0.0, 1e-6);
    CHECK_NEAR(ub, 0.0, 1e-5);
    CHECK_NEAR(uu, sigma2, 1e-6);
    CHECK_NEAR(vv - vb * vb / bb, sigma2, 1e-6);
    double cosine = nb / sqrt(nn * bb), before = fabs(ob) / sqrt(oo * bb);
    CHECK(cosine >= 0.5 - 1e-6);
    if (before >= 0.5)
      CHECK_NEAR(fabs(no) / sqrt(nn * oo), 1.0, 1e-6); /* about its own normal */
    else
      CHECK_NEAR(cosine, 0.5, 1e-6);
  }
  for (int k = 0; k < 6; k++)
    CHECK(faced[k][3] == 0.0f);
  splats.tangent_u[0] = splats.tangent_u[1] = splats.tangent_u[2] = NULL;
  splats.tangent_v[0] = splats.tangent_v[1] = splats.tangent_v[2] = NULL;
  CHECK(conic_splats_face(context, &splats, &camera, u, v) == CONIC_ERROR_ARGUMENT);
}

/* Sets that are joined, thinned and written keep which ones are dots. */
static void check_column(conic_context *context) {
  conic_model first = outlines_model(context, 3, CONIC_SPLATS_TANGENTS), read;
  conic_splats second;
  CHECK_OK(conic_splats_allocate(context, 2, CONIC_SPLATS_TANGENTS | CONIC_SPLATS_DOTS, &second));
  for (int i = 0; i < 3; i++)
    outlines_add(&first, i, 0, 0);
  for (int k = 0; k < 3; k++)
    for (int i = 0; i < 3; i++) {
      first.points.tangent_u[k][i] = k == 0;
      first.points.tangent_v[k][i] = k == 1;
      if (i < 2) {
        second.position[k][i] = (float)i;
        second.tangent_u[k][i] = k == 0;
        second.tangent_v[k][i] = k == 1;
      }
    }
  second.dot[0] = 0.0f;
  second.dot[1] = 3.0f;
  CHECK_OK(conic_splats_append(context, &first.points, &second));
  CHECK(conic_splats_fields(&first.points) & CONIC_SPLATS_DOTS);
  for (int i = 0; i < 5; i++)
    CHECK(first.points.dot[i] == (i == 4 ? 3.0f : 0.0f));
  for (int is_text = 0; is_text < 2; is_text++) {
    conic_write_options options;
    conic_write_options_init(&options);
    options.encoding = is_text ? CONIC_PLY_ASCII : CONIC_PLY_BINARY;
    options.circles = is_text;
    CHECK_OK(conic_splats_write(context, "dots.ply", &first.points, &options));
    CHECK_OK(conic_model_read(context, "dots.ply", NULL, &read));
    CHECK(read.points.count == 5 && read.points.dot && conic_splats_count_dots(&read.points) == 1);
    CHECK(read.points.dot && read.points.dot[4] == 1.0f);
    conic_model_release(context, &read);
  }
  for (uint64_t seed = 0; seed < 8; seed++) {
    conic_splats some = {0};
    CHECK_OK(conic_splats_append(context, &some, &first.points));
    CHECK_OK(conic_splats_thin(context, &some, 3, seed));
    for (int i = 0; i < 3; i++)
      CHECK((some.dot[i] != 0.0f) == (some.position[1][i] == 1.0f));
    conic_splats_release(context, &some);
  }
  conic_splats_release(context, &second);
  conic_model_release(context, &first);
}

int main(void) {
  conic_context *context = check_context(3);
  check_cube(context);
  check_sphere(context, 500, 0.0);
  check_sphere(context, N, 0.4);
  check_sheets_and_lines(context);
  check_tree(context);
  check_wire(context);
  check_what_dots_get(context);
  check_sizes_are_alike(context);
  check_ground_in_a_bush(context);
  check_option(context);
  check_facing(context);
  check_column(context);
  conic_context_destroy(context);
  return check_result();
}
