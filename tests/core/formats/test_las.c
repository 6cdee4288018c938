/* The LAS reader against hand-made files of every version and format. */
#include "core/base/color.h"
#include "tests/support/files.h"
#include "tests/support/las_file.h"

static conic_context *context;

static conic_status read_bytes(const las_file *file, size_t n_bytes, conic_model *model) {
  const char *path = files_write_bytes("a.las", file->bytes, n_bytes);
  conic_status status = conic_model_read(context, path, NULL, model);
  CHECK(unlink(path) == 0);
  if (status != CONIC_OK)
    CHECK(model->points.count == 0 && !model->points.position[0]);
  return status;
}

static void fill(las_file *file) {
  las_set_scale(file, 0.001, 589500.0, 231300.0, -50.0);
  las_set_point(file, 0, 1000, -2000, 3000);
  las_set_point(file, 1, 2147483647, -2147483647 - 1, 0);
  las_set_point(file, 2, 1001, -2001, 3000);
}

static void test_formats(int minor, int format, size_t extra_bytes, int has_color) {
  conic_model model;
  las_file file = las_begin(minor, format, 3, extra_bytes);
  fill(&file);
  for (size_t i = 0; i < 3 && has_color; i++)
    las_set_color(&file, i, i == 1 ? 65535 : 256, 0, 1000 * (unsigned)i);
  CHECK_OK(read_bytes(&file, file.n_bytes, &model));
  const conic_splats *points = &model.points;
  CHECK(points->count == 3 && model.n_triangles == 0 && model.kind == CONIC_MODEL_LAS);
  CHECK(conic_splats_fields(points) == (has_color ? (unsigned)CONIC_SPLATS_COLORS : 0u));
  if (points->count == 3) {
    CHECK(points->origin[0] == 589501.0 && points->origin[1] == 231298.0 && points->origin[2] == -47.0);
    CHECK(points->position[0][0] == 0.0f && points->position[1][0] == 0.0f && points->position[2][0] == 0.0f);
    CHECK(points->position[0][1] == (float)(2147482647.0 * 0.001));
    CHECK(points->position[1][1] == (float)(-2147481648.0 * 0.001));
    CHECK(points->position[0][2] == 0.001f && points->position[1][2] == -0.001f && points->position[2][2] == 0.0f);
  }
  if (points->color[0]) {
    CHECK(points->color[0][1] == 1.0f && points->color[1][1] == 0.0f);
    CHECK(points->color[0][0] == (float)conic_srgb_decode(256.0 / 65535.0));
    CHECK(points->color[2][2] == (float)conic_srgb_decode(2000.0 / 65535.0));
  }
  conic_model_release(context, &model);
  free(file.bytes);
}

/* Codes of 8 bits in fields of 16; and colours that nobody has filled in. */
static void test_colors(void) {
  conic_model model;
  las_file file = las_begin(2, 2, 2, 0);
  las_set_color(&file, 1, 255, 128, 1);
  CHECK_OK(read_bytes(&file, file.n_bytes, &model));
  CHECK(model.points.color[0] && model.points.color[0][1] == 1.0f && model.points.color[0][0] == 0.0f);
  CHECK(model.points.color[0] && model.points.color[1][1] == (float)conic_srgb_decode(128.0 / 255.0));
  conic_model_release(context, &model);
  las_set_color(&file, 1, 255 << 8, 128 << 8, 1 << 8); /* 8 bits in the upper half of 16 */
  CHECK_OK(read_bytes(&file, file.n_bytes, &model));
  CHECK(model.points.color[0] && model.points.color[0][1] == 1.0f);
  CHECK(model.points.color[0] && model.points.color[1][1] == (float)conic_srgb_decode(128.0 / 255.0));
  conic_model_release(context, &model);
  las_set_color(&file, 1, 3 * 257, 257, 0); /* 8 bits in both bytes, however dark */
  CHECK_OK(read_bytes(&file, file.n_bytes, &model));
  CHECK(model.points.color[0] && model.points.color[0][1] == (float)conic_srgb_decode(3.0 / 255.0));
  conic_model_release(context, &model);
  las_set_color(&file, 1, 4095, 300, 0); /* 12 bits */
  CHECK_OK(read_bytes(&file, file.n_bytes, &model));
  CHECK(model.points.color[0] && model.points.color[0][1] == 1.0f);
  CHECK(model.points.color[0] && model.points.color[1][1] == (float)conic_srgb_decode(300.0 / 4095.0));
  conic_model_release(context, &model);
  las_set_color(&file, 1, 0, 0, 0);
  CHECK_OK(read_bytes(&file, file.n_bytes, &model));
  CHECK(model.points.count == 2 && !model.points.color[0]);
  conic_model_release(context, &model);
  free(file.bytes);
}

/* So many points are read of a file's first bytes, with or without a word about it. */
static void check_count(const las_file *file, size_t n_bytes, size_t n_points, int is_told) {
  conic_model model;
  files_warnings = 0;
  CHECK_OK(read_bytes(file, n_bytes, &model));
  if (model.points.count != n_points || files_warnings != is_told) {
    fprintf(stderr, "%zu bytes: %zu points for %zu, told %d times\n", n_bytes, model.points.count, n_points,
            files_warnings);
    check_failures++;
  }
  conic_model_release(context, &model);
}

/* The number of points of 64 bits counts where it is given, and the older one elsewhere. What the file says of bytes
 * that follow the points keeps them from being taken for points. */
static void test_counts(void) {
  las_file file = las_begin(4, 1, 5, 0);
  las_put(&file, 107, 2, 4);
  check_count(&file, file.n_bytes, 5, 0);
  las_put(&file, 235, file.points_offset + 2 * file.point_bytes, 8); /* records begin there */
  las_put(&file, 247, 0, 8);
  check_count(&file, file.n_bytes, 2, 0);
  las_put(&file, 107, 0, 4);
  check_count(&file, file.n_bytes, 0, 0); /* whoever draws it says that there is nothing */
  free(file.bytes);
}

/* Counts that are off: what is there is read. */
static void test_wrong_counts(int minor, int format) {
  las_file file = las_begin(minor, format, 4, 0);
  size_t at = format < 6 ? 107 : 247;
  const uint64_t counts[] = {0, 3, 5, 4000000000u};
  for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
    las_put(&file, at, counts[i], 4);
    check_count(&file, file.n_bytes, 4, 1);
  }
  las_put(&file, at, 3, 4);
  check_count(&file, file.n_bytes - 1, 3, 0); /* what follows is no whole point */
  if (minor >= 3)
    las_put(&file, 227, file.points_offset + 3 * file.point_bytes, 8); /* but waveforms */
  check_count(&file, file.n_bytes, minor >= 3 ? 3 : 4, minor < 3);
  las_put(&file, at, 4, 4);
  las_put(&file, 227, 0, 8 * (minor >= 3));
  las_put(&file, 100, 0x3fb99999, 4); /* records that cannot be */
  check_count(&file, file.n_bytes, 4, 1);
  free(file.bytes);
}

/* Since a header of its version is longer, what is not there counts as 0. */
static void test_short_headers(void) {
  las_file file = las_begin(4, 3, 3, 0);
  las_put(&file, 94, 227, 2);
  memset(file.bytes + 227, 0xff, 148);
  check_count(&file, file.n_bytes, 3, 0);
  free(file.bytes);
}

static void check_refused(size_t at, uint64_t value, int n_bytes, const char *what, const char *where) {
  conic_model model;
  las_file file = las_begin(4, 7, 3, 0);
  las_put(&file, at, value, n_bytes);
  files_check_failed(what, read_bytes(&file, file.n_bytes, &model), "a.las: ", what, where, (const char *)NULL);
  free(file.bytes);
}

static void test_refused(void) {
  const uint64_t infinity = UINT64_C(0x7FF0000000000000), huge = UINT64_C(0x7FE0000000000000);
  check_refused(24, 2, 1, "version 2.4", "byte 24");
  check_refused(25, 6, 1, "version 1.6", "byte 24");
  check_refused(94, 226, 2, "header is shorter", "byte 94");
  check_refused(96, 374, 4, "within the header", "byte 96");
  check_refused(96, 100000, 4, "past the end", "byte 96");
  check_refused(104, 7 | 128, 1, "no record says how", "byte 104");
  check_refused(104, 7 | 64, 1, "no record says how", "byte 104");
  check_refused(104, 11, 1, "point format 11", "byte 104");
  check_refused(104, 9, 1, "shorter than its format", "byte 105");
  check_refused(105, 35, 2, "shorter than its format", "byte 105");
  check_refused(105, 0, 2, "shorter than its format", "byte 105");
  check_refused(131, 0, 8, "scale is zero", "byte 131");
  check_refused(139, infinity, 8, "scale", "byte 139");
  check_refused(147, huge, 8, "scale is too large", "byte 147");
  check_refused(163, infinity, 8, "offset", "byte 163");
}

/* A file that ends before its first point is refused; of one that ends later the whole points are read. */
static void test_truncated(int minor, int format) {
  conic_model model;
  las_file file = las_begin(minor, format, 3, 0);
  for (size_t n = 4; n < file.n_bytes; n++)
    if (n < file.points_offset + file.point_bytes)
      files_check_failed("truncated", read_bytes(&file, n, &model), "a.las: ", "byte", (const char *)NULL);
    else
      check_count(&file, n, (n - file.points_offset) / file.point_bytes, 1);
  free(file.bytes);
}

/* Files that others wrote, where they are. */
static void test_foreign(const char *source_folder) {
  static const struct {
    const char *path;
    size_t n_points;
    int n_told;
  } files[] = {{"foreign/laspy_simple1_3.las", 999, 0},
               {"foreign/pdal_garbage_nVariableLength.las", 718, 2},
               {"clouds/vegetation_1_3.las", 10683, 0}};
  for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
    conic_model model;
    const char *path = check_data(source_folder, files[i].path);
    if (!path)
      continue;
    files_warnings = 0;
    CHECK_OK(conic_model_read(context, path, NULL, &model));
    CHECK(model.points.count == files[i].n_points && files_warnings == files[i].n_told);
    conic_model_release(context, &model);
  }
}

int main(int argc, char **argv) {
  context = files_context();
  for (int minor = 0; minor <= 4; minor++)
    for (int format = 0; format <= (minor < 2 ? 1 : 3); format++)
      test_formats(minor, format, minor == 3 ? 5 : 0, format >= 2);
  for (int format = 4; format <= 10; format++)
    test_formats(4, format, format == 7 ? 1000 : 0, format == 5 || format == 7 || format == 8 || format == 10);
  test_colors();
  test_counts();
  test_wrong_counts(2, 0);
  test_wrong_counts(3, 4);
  test_wrong_counts(4, 8);
  test_short_headers();
  test_foreign(argc > 1 ? argv[1] : ".");
  test_refused();
  test_truncated(2, 0);
  test_truncated(3, 3);
  test_truncated(4, 8);
  files_end(context);
  return check_result();
}
