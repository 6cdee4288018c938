/* The PTX reader against hand-made files. */
#include <math.h>

#include "core/base/color.h"
#include "tests/support/files.h"

#define HEAD(columns, rows, x)                                                                                         \
  columns "\n" rows "\n1 2 3\n1 0 0\n0 1 0\n0 0 1\n0 1 0 0\n-1 0 0 0\n0 0 1 0\n" x " 2 3 1\n"

static conic_context *context;

static conic_status read_text(const char *text, const char *field, conic_model *model) {
  conic_read_options options;
  conic_read_options_init(&options);
  options.field = field;
  const char *path = files_write("a.dat", text);
  conic_status status = conic_model_read(context, path, &options, model);
  CHECK(unlink(path) == 0);
  return status;
}

/* Two scans; the matrix turns (x, y, z) to (−y, x, z). The second place of the first was not measured. */
static void test_scans(void) {
  conic_model model;
  CHECK_OK(read_text(
      HEAD("2", "1", "1") "4 5 6 0.25 255 0 51\n0 0 0 0.5 0 0 0\n" HEAD("1", "1", "100000") "1 0 0 0.75 0 255 0\n\n",
      "intensity", &model));
  const conic_splats *points = &model.points;
  CHECK(model.kind == CONIC_MODEL_PTX && points->count == 2 && model.up[2] == 1.0);
  if (points->count != 2)
    return;
  static const double places[2][3] = {{-4.0, 6.0, 9.0}, {100000.0, 3.0, 3.0}};
  for (size_t i = 0; i < 2; i++)
    for (int axis = 0; axis < 3; axis++)
      CHECK_NEAR(points->origin[axis] + (double)points->position[axis][i], places[i][axis], 1e-2);
  CHECK(points->scalar[0] == 0.25f && points->scalar[1] == 0.75f);
  CHECK(points->color[0][0] == 1.0f && points->color[2][0] == (float)conic_srgb_decode(0.2));
  CHECK_NEAR((double)points->sight[0][0], 5.0 / sqrt(77.0), 1e-6);
  CHECK(points->sight[1][1] == -1.0f);
  conic_model_release(context, &model);
}

/* Without a place of the scanner, map coordinates lie farther than any has seen. */
static void test_no_scanner(void) {
  conic_model model;
  CHECK_OK(read_text("1\n1\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n600000 800000 400 0.5\n",
                     NULL, &model));
  CHECK(model.points.count == 1 && !model.points.color[0]);
  CHECK(model.points.sight[0][0] == 0.0f && model.points.sight[1][0] == 0.0f && model.points.sight[2][0] == 0.0f);
  conic_model_release(context, &model);
}

static void check_wrong(const char *text, const char *said, const char *where) {
  conic_model model;
  files_check_failed(text, read_text(text, NULL, &model), "a.dat: ", said, where, (const char *)NULL);
}

static void test_wrong(void) {
  check_wrong(HEAD("2", "1", "1"), "the file ends before all places", "line 11");
  check_wrong(HEAD("2", "1", "1") "4 5 6 0.25\n1 2 3\n", "a point has 3 values", "line 12");
  check_wrong(HEAD("2", "1", "1") "4 5 6 0.25\n1 2 3 x\n", "not a number", "line 12");
  check_wrong(HEAD("1", "1.5", "1") "4 5 6 0.25\n", "no whole number", "line 1");
  check_wrong(HEAD("1", "1", "1") "4 5 6 0.25\n1\n1\n1 2\n", "a scan's head", "line 14");
  check_wrong("15\n71\n0 0 0\n1 0 0\n", "two counts begin a PTX scan", "line 2");
}

/* What is before the end is read. */
static void test_cut(void) {
  conic_model model;
  files_warnings = 0;
  CHECK_OK(read_text(HEAD("2", "2", "1") "4 5 6 0.25\n7 5 6 0.5\n", NULL, &model));
  CHECK(model.points.count == 2 && files_warnings == 1 && strstr(files_warning, "the last 2 places"));
  conic_model_release(context, &model);
}

static void test_real(const char *source_folder) {
  conic_model model;
  const char *path = check_data(source_folder, "clouds/1.2-with-color.ptx");
  if (!path)
    return;
  CHECK_OK(conic_model_read(context, path, NULL, &model));
  CHECK(model.points.count == 1065 && model.points.color[0]);
  CHECK_NEAR(model.points.origin[0] + (double)model.points.position[0][0], 637012.24, 1e-3);
  conic_model_release(context, &model);
}

int main(int argc, char **argv) {
  context = files_context();
  test_scans();
  test_no_scanner();
  test_wrong();
  test_cut();
  test_real(argc > 1 ? argv[1] : ".");
  files_end(context);
  return check_result();
}
