/* What stands behind a picture's pixels: added up, it is the picture, bit for bit; and the deep file holds it. */
#include <unistd.h>

#include "tests/support/deep_file.h"

enum { NEAR_KNOT, INSIDE_TORUS, SHARP_CUBE, N_SCENES };

static void fill(fixture *f, int scene) {
  fixture_camera(f, 90, 70, 60.0);
  f->options.near_z = 1e-3;
  f->camera.cam_from_world[2][3] = scene == INSIDE_TORUS ? 1.2 : 2.2;
  if (scene == SHARP_CUBE)
    fixture_scene(f, CONIC_SCENE_CUBE, 3000);
  else
    fixture_scene(f, scene == NEAR_KNOT ? CONIC_SCENE_KNOT : CONIC_SCENE_TORUS, scene == NEAR_KNOT ? 6000 : 1500);
}

static conic_contributions *contributions_of(const fixture *f) {
  conic_contributions *c;
  if (conic_contributions_create(f->context, &f->splats, &f->camera, &f->options, &c) != CONIC_OK)
    exit(1);
  return c;
}

/* A pixel's sums, as the picture's are formed: float, in the order of the set. */
typedef struct sums {
  float weight, color[3], heaviest, z, nearest_iz;
  uint32_t count, id;
} sums;

static sums add_up(const fixture *f, const conic_contribution *list, size_t n, size_t counts[4]) {
  sums s = {.id = CONIC_NO_ID};
  for (size_t i = 0; i < n; i++) {
    const conic_contribution *c = &list[i];
    counts[c->verdict]++;
    if (c->verdict != CONIC_CONTRIBUTION_VISIBLE)
      continue;
    s.weight += c->weight;
    s.count++;
    for (int axis = 0; axis < 3; axis++)
      s.color[axis] += c->weight * f->splats.color[axis][c->splat];
    if (s.heaviest < c->weight) {
      s.heaviest = c->weight;
      s.z = c->depth;
    }
    if (s.nearest_iz < c->inverse_depth) {
      s.nearest_iz = c->inverse_depth;
      s.id = c->splat;
    }
  }
  return s;
}

static void check_pixel(const fixture *f, const sums *s, int x, int y) {
  const float *albedo = fixture_pixel(f, CONIC_PLANE_ALBEDO, x, y);
  CHECK(*fixture_pixel(f, CONIC_PLANE_WEIGHT, x, y) == s->weight);
  CHECK(fixture_index(f, CONIC_PLANE_COUNT, x, y) == s->count);
  CHECK(fixture_index(f, CONIC_PLANE_ID, x, y) == s->id);
  CHECK(*fixture_pixel(f, CONIC_PLANE_Z, x, y) == s->z);
  for (int axis = 0; axis < 3; axis++)
    CHECK_NEAR((double)albedo[axis], s->count ? (double)(s->color[axis] / s->weight) : 0.0, 1e-6);
}

/* The picture from its contributions; what there was of each verdict is added to `counts`. */
static void test_sums(fixture *f, size_t counts[4]) {
  size_t n_fragments = 0;
  fixture_render(f);
  conic_contributions *c = contributions_of(f);
  for (int y = 0; y < f->camera.height; y++)
    for (int x = 0; x < f->camera.width; x++) {
      const conic_contribution *list;
      size_t n, here[4] = {0};
      CHECK_OK(conic_contributions_at(c, x, y, &list, &n));
      sums s = add_up(f, list, n, here);
      check_pixel(f, &s, x, y);
      for (size_t i = 1; i < n; i++)
        CHECK(list[i].splat > list[i - 1].splat);
      for (int i = 0; i < 4; i++)
        counts[i] += here[i];
      n_fragments += here[CONIC_CONTRIBUTION_VISIBLE] + here[CONIC_CONTRIBUTION_HIDDEN];
    }
  CHECK(n_fragments == f->statistics.fragments);
  conic_contributions_destroy(c);
}

static void test_deep(fixture *f, const char *folder) {
  const conic_drawing drawing = {&f->splats, NULL};
  deep_counts counts;
  fixture_render(f);
  if (deep_check(f, &drawing, folder, &counts))
    CHECK(counts.most > 1 - (f->options.passes == 1) && counts.n_triangles == 0);
}

/* Fates add up to the statistics; the conic is the variance's inverse; nothing covers a pixel outside its box. */
static void test_projections(fixture *f) {
  size_t fates[4] = {0};
  fixture_render(f);
  conic_contributions *c = contributions_of(f);
  for (size_t i = 0; i < f->splats.count; i++) {
    conic_projection p;
    CHECK_OK(conic_contributions_project(c, i, &p));
    fates[p.fate]++;
    CHECK(p.splat == i);
    if (p.fate > CONIC_FATE_RAY)
      continue;
    CHECK(p.x_begin < p.x_end && p.y_begin < p.y_end && p.x_end <= f->camera.width && p.y_end <= f->camera.height);
    CHECK(p.nearest_z > 0.0 && p.nearest_z <= p.farthest_z && p.nearness > 0.0 && p.nearness <= 1.0);
    if (p.fate == CONIC_FATE_RAY)
      continue;
    const double *v = p.variance_px, *q = p.conic;
    CHECK_NEAR(v[0] * q[0] + v[1] * q[1], 1.0, 1e-9);
    CHECK_NEAR(v[0] * q[1] + v[1] * q[2], 0.0, 1e-9 * sqrt(v[0] * v[2]) * (q[0] + q[2]));
    CHECK_NEAR(v[1] * q[1] + v[2] * q[2], 1.0, 1e-9);
    CHECK(v[0] > 0.999 && v[2] > 0.999); /* the prefilter's */
  }
  CHECK(fates[CONIC_FATE_CULLED] == f->statistics.splats_culled);
  CHECK(fates[CONIC_FATE_SKIPPED] == f->statistics.splats_skipped);
  CHECK(fates[CONIC_FATE_RAY] == f->statistics.splats_by_method[CONIC_METHOD_RAY]);
  CHECK(fates[CONIC_FATE_VARIANCE] + fates[CONIC_FATE_RAY] == f->statistics.splats_drawn);
  conic_projection p;
  CHECK(conic_contributions_project(c, f->splats.count, &p) == CONIC_ERROR_ARGUMENT);
  conic_contributions_destroy(c);
}

/* A disc across the line of sight, 2 px of standard deviation: worked out by hand. */
static void test_one_disc(fixture *f) {
  static const double center[3] = {0.25, -0.5, 2.0}, u[3] = {0.04, 0, 0}, v[3] = {0, 0.04, 0};
  const conic_contribution *list;
  conic_projection p;
  size_t n;
  fixture_camera(f, 100, 100, 100.0);
  fixture_splats(f, 1);
  fixture_set(f, 0, center, u, v, 1, 1, 1);
  conic_contributions *c = contributions_of(f);
  CHECK_OK(conic_contributions_project(c, 0, &p));
  CHECK(p.fate == CONIC_FATE_VARIANCE);
  CHECK_NEAR(p.center_px[0], 62.5, 1e-5);
  CHECK_NEAR(p.center_px[1], 25.0, 1e-5);
  CHECK_NEAR(p.variance_px[0], 5.0, 1e-5); /* 2² and the prefilter's 1 */
  CHECK_NEAR(p.variance_px[1], 0.0, 1e-5);
  CHECK_NEAR(p.amplitude, 0.8, 1e-6);
  CHECK_OK(conic_contributions_at(c, 62, 25, &list, &n)); /* half a pixel below the centre */
  CHECK(n == 1 && list[0].verdict == CONIC_CONTRIBUTION_VISIBLE);
  CHECK_NEAR((double)list[0].q, 0.25 / 5.0, 1e-6);
  CHECK_NEAR((double)list[0].weight, 0.8 * exp(-0.025), 1e-6);
  CHECK_NEAR((double)list[0].depth, 2.0, 1e-6);
  CHECK_OK(conic_contributions_at(c, 65, 22, &list, &n)); /* in the box's corner */
  CHECK(n == 1 && list[0].verdict == CONIC_CONTRIBUTION_OUTSIDE && list[0].weight == 0.0f);
  CHECK_OK(conic_contributions_at(c, 99, 99, &list, &n));
  CHECK(n == 0);
  CHECK(conic_contributions_at(c, 100, 0, &list, &n) == CONIC_ERROR_ARGUMENT);
  CHECK(conic_contributions_at(c, 0, -1, &list, &n) == CONIC_ERROR_ARGUMENT);
  conic_contributions_destroy(c);
}

static int n_left;

static void *allocate_few(void *cookie, size_t bytes) {
  (void)cookie;
  return n_left-- > 0 ? malloc(bytes) : NULL;
}

static void release_any(void *cookie, void *pointer) {
  (void)cookie;
  free(pointer);
}

/* Memory that runs out at any allocation: refused, and nothing is left. */
static void test_memory(fixture *f, const char *folder) {
  conic_context_options options;
  conic_context *poor;
  char path[200];
  int n_failed = 0;
  conic_context_options_init(&options);
  options.allocate = allocate_few;
  options.release = release_any;
  options.threads = 1;
  snprintf(path, sizeof path, "%s/poor.exr", folder);
  n_left = 1000;
  CHECK_OK(conic_context_create(&options, &poor));
  for (int n = 0; n < 1000; n++) {
    conic_contributions *c;
    const conic_contribution *list;
    size_t n_list;
    n_left = n;
    conic_status status = conic_contributions_create(poor, &f->splats, &f->camera, &f->options, &c);
    if (status == CONIC_OK)
      status = conic_contributions_at(c, 10, 10, &list, &n_list);
    if (status == CONIC_OK)
      status = conic_contributions_write(c, path, NULL);
    conic_contributions_destroy(c);
    if (status == CONIC_OK || status == CONIC_ERROR_UNSUPPORTED)
      break;
    CHECK(status == CONIC_ERROR_MEMORY);
    CHECK(access(path, F_OK) != 0);
    n_failed++;
  }
  CHECK(n_failed > 8 && n_failed < 1000);
  conic_context_destroy(poor);
  remove(path);
}

int main(void) {
  static const conic_method methods[] = {CONIC_METHOD_CONIC, CONIC_METHOD_RAY, CONIC_METHOD_AFFINE};
  char folder[FOLDER_ROOM];
  fixture f = fixture_open(3);
  folder_make(folder);
  for (int scene = 0; scene < N_SCENES; scene++)
    for (size_t i = 0; i < sizeof methods / sizeof methods[0]; i++) {
      size_t counts[4] = {0};
      fill(&f, scene);
      f.options.method = methods[i];
      f.options.passes = 3;
      test_sums(&f, counts);
      test_deep(&f, folder);
      test_projections(&f);
      CHECK(counts[CONIC_CONTRIBUTION_VISIBLE] > 1000 && counts[CONIC_CONTRIBUTION_HIDDEN] > 1000);
      CHECK(counts[CONIC_CONTRIBUTION_OUTSIDE] > 1000);
      CHECK(scene != SHARP_CUBE || counts[CONIC_CONTRIBUTION_CLIPPED] > 100); /* splats end at the edges */
      CHECK(scene != INSIDE_TORUS || methods[i] != CONIC_METHOD_RAY || counts[CONIC_CONTRIBUTION_CLIPPED] > 0);
      f.options.passes = 1;
      test_sums(&f, counts);
      test_deep(&f, folder);
    }
  f.options.method = CONIC_METHOD_CONIC;
  f.options.passes = 3;
  test_memory(&f, folder);
  test_one_disc(&f);
  fixture_close(&f);
  rmdir(folder);
  return check_result();
}
