/* The OBJ reader against hand-made files. */
#include "tests/support/files.h"

static conic_context *context;

/* Reads `text` as a model and removes the file. */
static conic_status read_text(const char *text, conic_model *model) {
  const char *path = files_write("a.obj", text);
  conic_status status = conic_model_read(context, path, NULL, model);
  CHECK(unlink(path) == 0);
  if (status != CONIC_OK)
    CHECK(model->points.count == 0 && !model->points.position[0] && !model->triangles && model->n_triangles == 0);
  return status;
}

static void check_fails(const char *text, const char *what, const char *where) {
  conic_model model;
  files_check_failed(text, read_text(text, &model), "a.obj: ", what, where, (const char *)NULL);
}

static void check_triangle(const conic_model *model, size_t i, uint32_t a, uint32_t b, uint32_t c) {
  CHECK(i < model->n_triangles && model->triangles[i][0] == a && model->triangles[i][1] == b &&
        model->triangles[i][2] == c);
}

static void test_everything(void) {
  conic_model model;
  CHECK_OK(read_text("# comment\r\nmtllib a b.mtl\r\no thing\r\nv 0 0 0\r\nv 1 0 0 # aside\r\n"
                     "v 1 \\\r\n 1 \\\r\n 0\r\n\r\nv\t0 1 0 1.0\r\nvt 0.5\nvt 0 1 0\ng a\ns off\nusemtl c\n"
                     "vn 0 0 2\nvn 0 1 0\nf 1//1 2//1 3//1 4//2\nf -4/1 -3/-1 -2/2\nf 1/1/1 2/2/-1 3/1/\nl 1 2\np 1\n"
                     "curv 1 2 \\\n 3 4\n  f 4 3 2\nf 1 2 3 4",
                     &model));
  CHECK(model.points.count == 4 && model.n_triangles == 7);
  check_triangle(&model, 0, 0, 1, 2);
  check_triangle(&model, 1, 0, 2, 3);
  check_triangle(&model, 2, 0, 1, 2);
  check_triangle(&model, 3, 0, 1, 2);
  check_triangle(&model, 4, 3, 2, 1);
  check_triangle(&model, 6, 0, 2, 3);
  CHECK(model.points.position[0][2] == 1.0f && model.points.position[1][2] == 1.0f);
  CHECK(conic_splats_fields(&model.points) == CONIC_SPLATS_NORMALS);
  CHECK(model.points.normal[2][0] == 1.0f && model.points.normal[1][3] == 1.0f);
  /* vertex 2: (0, 0, 2) from the first face and (0, 1, 0) from the third */
  CHECK_NEAR(model.points.normal[1][1], 1.0 / sqrt(5.0), 1e-7);
  CHECK_NEAR(model.points.normal[2][1], 2.0 / sqrt(5.0), 1e-7);
  conic_model_release(context, &model);
}

static void test_colors(void) {
  conic_model model;
  CHECK_OK(read_text("v 0 0 0\nv 1 0 0 0.5 0 1\nv 2 0 0 1 1 1 0.5\n", &model));
  CHECK(model.points.count == 3 && model.n_triangles == 0);
  CHECK(conic_splats_fields(&model.points) == CONIC_SPLATS_COLORS);
  CHECK(model.points.color[0][0] == 1.0f && model.points.color[1][1] == 0.0f && model.points.color[2][1] == 1.0f);
  CHECK_NEAR(model.points.color[0][1], 0.21404114, 1e-7); /* the curve at one half */
  conic_model_release(context, &model);
}

static void test_far_out(void) {
  conic_model model;
  CHECK_OK(read_text("v 4500000.125 5100000.25 100.5\nv 4500001.375 5100000.5 101\n", &model));
  for (int i = 0; i < 2; i++)
    CHECK(model.points.origin[0] + (double)model.points.position[0][i] == (i ? 4500001.375 : 4500000.125));
  conic_model_release(context, &model);
}

static void test_indices_that_come_first(void) {
  conic_model model;
  CHECK_OK(read_text("f 1//1 2//1 3//1\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\n", &model));
  CHECK(model.n_triangles == 1 && model.points.normal[2][2] == 1.0f);
  conic_model_release(context, &model);
}

static void test_content_tells(void) {
  conic_model model;
  const char *path = files_write("model.txt", "# made by hand\nv 1 2 3\n");
  CHECK_OK(conic_model_read(context, path, NULL, &model));
  CHECK(model.points.count == 1);
  conic_model_release(context, &model);
  unlink(path);
  path = files_write("words.txt", "one two three\n");
  files_check_failed("text", conic_model_read(context, path, NULL, &model), "names of columns", "line 1",
                     (const char *)NULL);
  unlink(path);
  path = files_write_bytes("image.obj", "\x89PNG....", 8);
  files_check_failed("image", conic_model_read(context, path, NULL, &model), "PNG", "byte 0", (const char *)NULL);
  unlink(path);
  path = files_write("empty.obj", "");
  files_check_failed("empty", conic_model_read(context, path, NULL, &model), "empty", (const char *)NULL);
  unlink(path);
  files_check_failed("folder", conic_model_read(context, files_folder, NULL, &model), "directory", (const char *)NULL);
  files_check_failed("absent", conic_model_read(context, files_path("no.obj"), NULL, &model), "cannot read",
                     (const char *)NULL);
}

static void test_failures(void) {
  static const char three[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  char text[8192];
  const char *lines[][3] = {
      {"f 1 2 4\nv x", "not a number", "line 5"},
      {"f 1 2 4\n", "index 4, but there are only 3 vertices", "line 4"},
      {"\n\nf 1 2 -4\n", "index -4", "line 6"},
      {"f 0 1 2\n", "corner is", "line 4"},
      {"f 1 2 3x\n", "corner is", "line 4"},
      {"f 1/ 2 3\n", "corner is", "line 4"},
      {"f 1//1/1 2 3\n", "corner is", "line 4"},
      {"f 99999999999 2 3\n", "out of range", "line 4"},
      {"v 1 2\n", "a vertex has", "line 4"},
      {"v 1 2 3 4 5\n", "a vertex has", "line 4"},
      {"v 1 2 3 4 5 6 7 8\n", "too many", "line 4"},
      {"v 1 \\\n2 \\\nthree\n", "not a number", "line 6"},
      {"vn 1 2\n", "3 values", "line 4"},
      {"vt\n", "1 to 3 values", "line 4"},
      {"f 1 2 -9223372036854775809\n", "there are only 3 vertices so far", "line 4"},
      {"f 1 2 18446744073709551617\n", "out of range", "line 4"},
      {"f 1 2 4294967297\n", "out of range", "line 4"},
      {"f 1 2 -0\n", "corner is", "line 4"},
      {"f 1 2 1.5\n", "corner is", "line 4"},
      {"f 1 2 nan\n", "corner is", "line 4"},
      {"f 1 2 3 \\\n1 2 5\n", "index 5, but there are only 3 vertices", "line 5"},
  };
  for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
    snprintf(text, sizeof text, "%s%s", three, lines[i][0]);
    check_fails(text, lines[i][1], lines[i][2]);
  }
  check_fails("# nothing\n", "without a vertex", "line 2");
  memset(text, 'v', 8000);
  text[8000] = 0;
  check_fails(text, "a word of more than", "line 1");
}

/* A polygon of many corners is a fan from its first; values that are no numbers are kept, and faces with them. */
static void test_odd(void) {
  enum { N_CORNERS = 30000 };
  conic_model model;
  char *text = malloc(16 * N_CORNERS);
  if (!text)
    exit(1);
  int n = snprintf(text, 64, "v 0 0 0\nv 1 0 0\nv 1 1 0\nv nan inf -inf\nf");
  for (int i = 0; i < N_CORNERS; i++)
    n += snprintf(text + n, 16, " %d", i % 4 + 1);
  CHECK_OK(read_text(text, &model));
  CHECK(model.points.count == 4 && model.n_triangles == N_CORNERS - 2);
  for (uint32_t i = 0; i + 2 < N_CORNERS; i += 997)
    check_triangle(&model, i, 0, (i + 1) % 4, (i + 2) % 4);
  CHECK(model.points.position[0][3] != model.points.position[0][3] && model.points.position[2][3] == -INFINITY);
  conic_model_release(context, &model);
  free(text);
}

/* Corners that name coordinates and normals of which there are none do without. */
static void test_nothing_to_name(void) {
  conic_triangles triangles;
  const char *path = files_write("a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1/1/1 2/9/9 3/1/1\n");
  CHECK_OK(conic_triangles_read(context, path, &triangles));
  CHECK(triangles.count == 1 && unlink(path) == 0);
  conic_triangles_release(context, &triangles);
}

static void test_real(const char *source_folder) {
  static const struct {
    const char *name;
    size_t n_points, n_triangles;
  } files[] = {{"bunny.obj", 35947, 69451}, {"nefertiti.obj", 49971, 99938}, {"spot.obj", 2930, 5856}};
  for (int i = 0; i < 3; i++) {
    conic_model model;
    const char *path = check_data(source_folder, files[i].name);
    if (!path)
      continue;
    CHECK_OK(conic_model_read(context, path, NULL, &model));
    CHECK(model.points.count == files[i].n_points && model.n_triangles == files[i].n_triangles);
    conic_model_release(context, &model);
  }
}

int main(int argc, char **argv) {
  context = files_context();
  test_everything();
  test_colors();
  test_far_out();
  test_indices_that_come_first();
  test_content_tells();
  test_failures();
  test_odd();
  test_nothing_to_name();
  test_real(argc > 1 ? argv[1] : ".");
  files_end(context);
  return check_result();
}
