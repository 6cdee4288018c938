/* The reader of XYZ and PTS against hand-made files. */
#include "core/base/color.h"
#include "tests/support/files.h"

static conic_context *context;

static conic_status read_text(const char *text, conic_model *model) {
  const char *path = files_write("a.xyz", text);
  conic_status status = conic_model_read(context, path, NULL, model);
  CHECK(unlink(path) == 0);
  if (status != CONIC_OK)
    CHECK(model->points.count == 0 && !model->points.position[0]);
  return status;
}

/* Reads what must be read: `n` points with these fields. Another model where it fails, so that the caller goes on. */
static conic_model read_points(const char *text, size_t n, unsigned fields) {
  conic_model model;
  conic_status status = read_text(text, &model);
  if (status != CONIC_OK || model.points.count != n || conic_splats_fields(&model.points) != fields) {
    fprintf(stderr, "'%s' is read as %zu points with fields %u: %s\n", text, model.points.count,
            conic_splats_fields(&model.points), files_message);
    exit(1);
  }
  CHECK(model.kind == CONIC_MODEL_XYZ);
  return model;
}

static float decoded(double encoded) {
  return (float)conic_srgb_decode(encoded);
}

static void check_vector(float *const vector[3], size_t i, float a, float b, float c) {
  CHECK(vector[0][i] == a && vector[1][i] == b && vector[2][i] == c);
}

static void test_columns(void) {
  const unsigned color = CONIC_SPLATS_COLORS, normal = CONIC_SPLATS_NORMALS;
  conic_model m = read_points("1 2 3\n4 5 7\n", 2, 0);
  CHECK(m.points.origin[0] == 1.0 && m.points.origin[1] == 2.0 && m.points.origin[2] == 3.0);
  check_vector(m.points.position, 1, 3.0f, 3.0f, 4.0f);
  conic_model_release(context, &m);
  m = read_points("1 2 3 -1200\n4 5 7 0.5", 2, 0);
  conic_model_release(context, &m);
  m = read_points("0 0 0 255 0 51\n1 0 0 1 2 3\n", 2, color);
  check_vector(m.points.color, 0, 1.0f, 0.0f, decoded(0.2));
  conic_model_release(context, &m);
  m = read_points("0 0 0 -2000 255 0 51\n1 0 0 17 1 2 3\n", 2, color);
  check_vector(m.points.color, 0, 1.0f, 0.0f, decoded(0.2));
  conic_model_release(context, &m);
  m = read_points("0 0 0 0 0 1\n1 0 0 0 0.6 0.8\n2 0 0 0 0 0\n", 3, normal);
  check_vector(m.points.normal, 1, 0.0f, 0.6f, 0.8f);
  conic_model_release(context, &m);
  m = read_points("0 0 0 0 0 -7\n1 0 0 0 3 4\n", 2, normal); /* of any length, as no colour is negative */
  check_vector(m.points.normal, 0, 0.0f, 0.0f, -7.0f);
  conic_model_release(context, &m);
  m = read_points("0 0 0 10 20 255 0 0 1\n1 0 0 0 0 0 0 1 0\n", 2, color | normal);
  check_vector(m.points.color, 0, decoded(10.0 / 255.0), decoded(20.0 / 255.0), 1.0f);
  check_vector(m.points.normal, 1, 0.0f, 1.0f, 0.0f);
  conic_model_release(context, &m);
  m = read_points("0 0 0 0 0 -1 10 20 255\n1 0 0 0 1 0 0 0 0\n", 2, color | normal); /* the other way round */
  check_vector(m.points.color, 0, decoded(10.0 / 255.0), decoded(20.0 / 255.0), 1.0f);
  check_vector(m.points.normal, 0, 0.0f, 0.0f, -1.0f);
  conic_model_release(context, &m);
}

static void test_color_scales(void) {
  conic_model m = read_points("0 0 0 0.5 0.25 1\n1 0 0 0 0 0\n", 2, CONIC_SPLATS_COLORS);
  check_vector(m.points.color, 0, decoded(0.5), decoded(0.25), 1.0f);
  conic_model_release(context, &m);
  m = read_points("0 0 0 65535 256 0\n", 1, CONIC_SPLATS_COLORS);
  check_vector(m.points.color, 0, 1.0f, decoded(256.0 / 65535.0), 0.0f);
  conic_model_release(context, &m);
  m = read_points("0 0 0 0 0 0\n1 0 0 0 0 0\n", 2, 0); /* colours that nobody has filled in */
  conic_model_release(context, &m);
  m = read_points("0 0 0 nan 2 255\n", 1, CONIC_SPLATS_COLORS);
  CHECK(m.points.color[0][0] != m.points.color[0][0] && m.points.color[2][0] == 1.0f);
  conic_model_release(context, &m);
}

static void test_layout(void) {
  conic_model m = read_points("# a comment, 1 2 3\r\n// X Y Z\r\n\r\n 1,2,3\r\n4, 5,\t6\r\n#\r\n\r\n7 8 9", 3, 0);
  check_vector(m.points.position, 2, 6.0f, 6.0f, 6.0f);
  conic_model_release(context, &m);
  m = read_points("2\n1 2 3 -5 255 0 0\n4 5 6 -5 0 0 0\n", 2, CONIC_SPLATS_COLORS);
  conic_model_release(context, &m);
  m = read_points("0\n", 0, 0);
  conic_model_release(context, &m);
  m = read_points("nan 0 0\n589500.125 231300.5 1e7\n589500.25 231300 inf\n", 3, 0);
  CHECK(m.points.origin[0] == 589500.125 && m.points.origin[2] == 1e7);
  check_vector(m.points.position, 1, 0.0f, 0.0f, 0.0f);
  CHECK(m.points.position[0][2] == 0.125f && m.points.position[1][2] == -0.5f);
  conic_model_release(context, &m);
}

/* More points than are looked at and converted at a time. */
static void test_many(void) {
  enum { N = 1000 };
  static char text[N * 32];
  size_t n = 0;
  for (int i = 0; i < N; i++)
    n += (size_t)snprintf(text + n, sizeof text - n, "%d 0 0 1 1 %d\n", i, i == N - 1 ? 65535 : 1);
  conic_model m = read_points(text, N, CONIC_SPLATS_COLORS); /* the last value makes all codes of 16 bits */
  CHECK(m.points.position[0][N - 1] == N - 1 && m.points.color[2][N - 1] == 1.0f);
  CHECK(m.points.color[0][0] == decoded(1.0 / 65535.0));
  conic_model_release(context, &m);
}

/* A number of points that is off is told, once, and what is there is read. Another number begins another cloud. */
static void test_counts(void) {
  static const struct {
    const char *text;
    size_t n;
    int is_told;
  } files[] = {{"2\n1 2 3\n4 5 6\n", 2, 0},           {"3\n1 2 3\n4 5 6\n", 2, 1},
               {"1\n1 2 3\n4 5 6\n", 2, 1},           {"4000000000\n1 2 3\n", 1, 1},
               {"1\n1 2 3\n2\n4 5 6\n7 8 9\n", 3, 0}, {"1\n1 2 3\n9\n4 5 6\n7 8 9\n", 3, 1}};
  for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
    files_warnings = 0;
    conic_model m = read_points(files[i].text, files[i].n, 0);
    CHECK(files_warnings == files[i].is_told);
    CHECK(!files[i].is_told || strstr(files_warning, "a.xyz: line 1 declares"));
    conic_model_release(context, &m);
  }
}

static void check_kind(const char *name, const char *text, int is_xyz) {
  conic_model model;
  const char *path = files_write(name, text);
  conic_status status = conic_model_read(context, path, NULL, &model);
  CHECK(is_xyz == (status == CONIC_OK && model.kind == CONIC_MODEL_XYZ));
  conic_model_release(context, &model);
  unlink(path);
}

static void test_content_tells(void) {
  check_kind("a.txt", "# by hand\n\n-1.5 2 3\n", 1);
  check_kind("a.csv", "// X,Y,Z\n1,2,3", 1);
  check_kind("a.asc", "3\n1 2 3\n1 2 3\n1 2 3\n", 1);
  check_kind("a.txt", "v 1 2 3\n", 0);
  check_kind("a.txt", "1 2 x\n", 0);
  check_kind("a.txt", "1 2 3\x01\n", 0);
  check_kind("a.txt", "# nothing\n", 0);
  check_kind("a.xyz",
             "ply\nformat ascii 1.0\nelement vertex 0\nproperty int x\nproperty int y\nproperty int z\n"
             "end_header\n",
             0);
}

static void check_refused(const char *text, const char *what, const char *where) {
  conic_model model;
  files_check_failed(text, read_text(text, &model), "a.xyz: ", what, where, (const char *)NULL);
}

static void test_refused(void) {
  check_refused("1 2 3\n1 2\n", "2 values, those before it have 3", "line 2");
  check_refused("1 2 3\n\n1 2 3 4\n", "4 values, those before it have 3", "line 3");
  check_refused("1 2\n", "2 values; a point has 3", "line 1");
  check_refused("1 2 3\n1 2 x\n", "not a number", "line 2");
  check_refused("1 2 3\n1 2 3m\n", "not a number", "line 2");
  check_refused("# nothing\n\n", "without a point", "line 3");
  check_refused("-1\n1 2 3\n", "number of points", "line 1");
  check_refused("1.5\n1 2 3\n", "number of points", "line 1");
  check_refused("nan\n1 2 3\n", "number of points", "line 1");
  check_refused("1e300\n1 2 3\n", "number of points", "line 1");
  check_refused("3\n1 2 3\n4 5 6\n1 2      ", "2 values, those before it have 3", "line 4");
  check_refused("3\n# nothing\n", "without a point", "line 3");
  check_refused("1 2 3\n4\n", "1 values, those before it have 3", "line 2");
}

int main(void) {
  context = files_context();
  test_columns();
  test_color_scales();
  test_layout();
  test_many();
  test_counts();
  test_content_tells();
  test_refused();
  files_end(context);
  return check_result();
}
