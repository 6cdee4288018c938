/* What comes in batches is what reading the whole file gives, bit for bit: PLY, XYZ and LAS with
 * colours of every scale, OBJ. */
#include "tests/support/files.h"
#include "tests/support/las_file.h"

typedef struct gathering {
  conic_context *context;
  conic_splats all;
  int n_batches;
  size_t largest;
} gathering;

static conic_status gather(void *cookie, const conic_splats *batch) {
  gathering *g = cookie;
  if (g->n_batches++ == 0) {
    memcpy(g->all.origin, batch->origin, sizeof g->all.origin);
    CHECK_OK(conic_splats_allocate(g->context, 0, conic_splats_fields(batch), &g->all));
    memcpy(g->all.origin, batch->origin, sizeof g->all.origin);
  }
  for (int axis = 0; axis < 3; axis++)
    CHECK(batch->origin[axis] == g->all.origin[axis]);
  g->largest = batch->count > g->largest ? batch->count : g->largest;
  return conic_splats_append(g->context, &g->all, batch);
}

static void check_array(const float *a, const float *b, size_t n) {
  CHECK(!a == !b);
  if (a && b)
    CHECK(memcmp(a, b, n * sizeof *a) == 0);
}

static void check_same(conic_context *context, const char *path, size_t n, int least_batches) {
  conic_model model;
  gathering g = {.context = context};
  CHECK_OK(conic_model_read(context, path, NULL, &model));
  CHECK_OK(conic_model_stream(context, path, NULL, gather, &g));
  const conic_splats *a = &model.points, *b = &g.all;
  CHECK(a->count == n && b->count == n && g.n_batches >= least_batches);
  CHECK(least_batches == 1 || g.largest < n);
  for (int axis = 0; axis < 3 && a->count == n && b->count == n; axis++) {
    CHECK(a->origin[axis] == b->origin[axis]);
    check_array(a->position[axis], b->position[axis], n);
    check_array(a->tangent_u[axis], b->tangent_u[axis], n);
    check_array(a->tangent_v[axis], b->tangent_v[axis], n);
    check_array(a->normal[axis], b->normal[axis], n);
    check_array(a->color[axis], b->color[axis], n);
  }
  conic_splats_release(context, &g.all);
  conic_model_release(context, &model);
}

enum { MANY = 150000 };

static void test_ply(conic_context *context, conic_ply_encoding encoding, double offset, size_t n) {
  const char *path = files_path("stream.ply");
  conic_scene_options options;
  conic_write_options write;
  conic_scene *scene;
  conic_splats splats;
  conic_scene_options_init(&options);
  conic_write_options_init(&write);
  options.type = CONIC_SCENE_SPHERE;
  options.count = n;
  options.offset[2] = offset;
  write.encoding = encoding;
  CHECK_OK(conic_splats_allocate(context, n, CONIC_SPLATS_TANGENTS | CONIC_SPLATS_COLORS, &splats));
  CHECK_OK(conic_scene_create(context, &options, &scene));
  CHECK_OK(conic_scene_sample(scene, 0, n, &splats));
  conic_scene_destroy(scene);
  CHECK_OK(conic_splats_write(context, path, &splats, &write));
  check_same(context, path, n, n > 65536 ? 2 : 1);
  conic_splats_release(context, &splats);
  CHECK(unlink(path) == 0);
}

/* Colours as fractions, codes of 8 or of 16 bits; the largest comes last. */
static void test_xyz(conic_context *context, double largest, size_t n) {
  const char *path = files_path("stream.xyz");
  FILE *file = fopen(path, "w");
  if (!file)
    exit(1);
  for (size_t i = 0; i < n; i++)
    fprintf(file, "%zu %zu 5 %g %g 0\n", i, i % 7, i + 1 == n ? largest : largest * 0.001, largest * 0.0005);
  fclose(file);
  check_same(context, path, n, n > 65536 ? 2 : 1);
  CHECK(unlink(path) == 0);
}

static void test_las(conic_context *context, unsigned largest, size_t n) {
  las_file file = las_begin(2, 2, n, 0);
  las_set_scale(&file, 0.001, 589500.0, 231300.0, -50.0);
  for (size_t i = 0; i < n; i++) {
    las_set_point(&file, i, (int)i, (int)(i % 11), 3);
    las_set_color(&file, i, i + 1 == n ? largest : largest / 3, largest / 2, 0);
  }
  const char *path = files_write_bytes("stream.las", file.bytes, file.n_bytes);
  check_same(context, path, n, n > 65536 ? 2 : 1);
  CHECK(unlink(path) == 0);
  free(file.bytes);
}

/* PCD: packed colours, and separate ones whose scale the last one tells. */
static void test_pcd(conic_context *context, int is_packed, unsigned largest, size_t n) {
  const char *path = files_path("stream.pcd");
  FILE *file = fopen(path, "w");
  if (!file)
    exit(1);
  fprintf(file, is_packed ? "FIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F U\n"
                          : "FIELDS x y z r g b\nSIZE 8 8 8 2 2 2\nTYPE F F F U U U\n");
  fprintf(file, "POINTS %zu\nDATA ascii\n", n);
  for (size_t i = 0; i < n; i++)
    if (is_packed)
      fprintf(file, "%zu %zu 5 %zu\n", i, i % 7, i % 256);
    else
      fprintf(file, "%zu %zu 5 %u 1 0\n", i, i % 7, i + 1 == n ? largest : 3);
  fclose(file);
  check_same(context, path, n, n > 65536 ? 2 : 1);
  CHECK(unlink(path) == 0);
}

static conic_status refuse(void *cookie, const conic_splats *batch) {
  ++*(int *)cookie;
  return batch->count ? CONIC_ERROR_IO : CONIC_OK;
}

static void test_failures(conic_context *context) {
  int n_calls = 0;
  const char *path = files_write("short.xyz", "3\n0 0 0\n1 0\n");
  files_check_failed("too few values", conic_model_stream(context, path, NULL, refuse, &n_calls), "short.xyz", "(line ",
                     NULL);
  CHECK(n_calls == 0);
  CHECK(unlink(path) == 0);
  path = files_write("a.xyz", "0 0 0\n1 0 0\n");
  CHECK(conic_model_stream(context, path, NULL, refuse, &n_calls) == CONIC_ERROR_IO && n_calls == 1);
  CHECK(unlink(path) == 0);
  files_check_failed("missing", conic_model_stream(context, files_path("none.ply"), NULL, refuse, &n_calls),
                     "cannot read", NULL);
}

/* A header that is refused leaves no model behind. */
static void test_refused(conic_context *context) {
  gathering g = {.context = context};
  const char *path =
      files_write("refused.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty foo x\nend_header\n0\n");
  CHECK(conic_model_stream(context, path, NULL, gather, &g) == CONIC_ERROR_INPUT && g.n_batches == 0);
  remove(path);
}

int main(void) {
  conic_context *context = files_context();
  test_refused(context);
  test_ply(context, CONIC_PLY_BINARY, 0.0, MANY);
  test_ply(context, CONIC_PLY_BINARY, 1e6, 3000);
  test_ply(context, CONIC_PLY_ASCII, 1e6, 70000);
  test_xyz(context, 1.0, 200);
  test_xyz(context, 255.0, MANY);
  test_xyz(context, 60000.0, 200);
  test_las(context, 255, MANY);
  test_las(context, 65535, 500);
  test_las(context, 4095, 500);
  test_las(context, 0, 500);
  test_pcd(context, 1, 0, 70000);
  test_pcd(context, 0, 65535, 500);
  test_pcd(context, 0, 255, 500);
  const char *path = files_write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  check_same(context, path, 3, 1);
  CHECK(unlink(path) == 0);
  test_failures(context);
  files_end(context);
  return check_result();
}
