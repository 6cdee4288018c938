/* The PCD reader against hand-made files of every way of storing points. */
#include <math.h>

#include "core/base/byte_order.h"
#include "core/base/color.h"
#include "core/files/lzf.h"
#include "tests/support/files.h"

static conic_context *context;

/* A file that is put together piece by piece. */
typedef struct pcd_file {
  unsigned char bytes[4096];
  size_t n;
} pcd_file;

static pcd_file begin(const char *header) {
  pcd_file file = {.n = strlen(header)};
  memcpy(file.bytes, header, file.n);
  return file;
}

static void put(pcd_file *file, const void *value, size_t n_bytes) {
  memcpy(file->bytes + file->n, value, n_bytes);
  file->n += n_bytes;
}

static void put_words(pcd_file *file, const void *words, size_t n) {
  put(file, words, 4 * n);
  conic_turn_words(file->bytes + file->n - 4 * n, n, 4);
}

static conic_status read_file(const pcd_file *file, size_t n_bytes, conic_model *model) {
  const char *path = files_write_bytes("a.pcd", file->bytes, n_bytes);
  files_warnings = 0;
  conic_status status = conic_model_read(context, path, NULL, model);
  CHECK(unlink(path) == 0);
  return status;
}

static conic_model read_points(const pcd_file *file, size_t n, unsigned fields) {
  conic_model model;
  conic_status status = read_file(file, file->n, &model);
  if (status != CONIC_OK || model.points.count != n || conic_splats_fields(&model.points) != fields) {
    fprintf(stderr, "read as %zu points with fields %u: %s\n", model.points.count, conic_splats_fields(&model.points),
            files_message);
    exit(1);
  }
  CHECK(model.kind == CONIC_MODEL_PCD);
  return model;
}

static float decoded(unsigned code) {
  return (float)conic_srgb_decode((double)code / 255.0);
}

static void check_vector(float *const vector[3], size_t i, float a, float b, float c) {
  CHECK(vector[0][i] == a && vector[1][i] == b && vector[2][i] == c);
}

static const float places[3][3] = {{1.5f, -2.0f, 3.0f}, {4.0f, 5.0f, 6.0f}, {-7.0f, 8.0f, 9.25f}};
static const float normals[3][3] = {{0, 0, 1}, {1, 0, 0}, {0, -1, 0}};
static const uint32_t colors[3] = {0xFFFF3300u, 0x000000FFu, 0x00010203u};

static void check_three(const conic_model *model) {
  for (size_t i = 0; i < 3; i++) {
    check_vector(model->points.position, i, places[i][0], places[i][1], places[i][2]);
    check_vector(model->points.normal, i, normals[i][0], normals[i][1], normals[i][2]);
  }
  CHECK(model->points.origin[0] == 0.0 && model->points.origin[1] == 0.0);
  check_vector(model->points.color, 0, 1.0f, decoded(51), 0.0f);
  check_vector(model->points.color, 2, decoded(1), decoded(2), decoded(3));
}

enum { BOTH = CONIC_SPLATS_COLORS | CONIC_SPLATS_NORMALS };

#define HEADER(points, data)                                                                                           \
  "# .PCD v.7 - by hand\nVERSION .7\nFIELDS x y z intensity histogram rgb normal_x normal_y normal_z\n"                \
  "SIZE 4 4 4 2 1 4 4 4 4\nTYPE F F F U U F F F F\nCOUNT 1 1 1 1 3 1 1 1 1\nWIDTH 3\nHEIGHT 1\n"                       \
  "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS " points "\nDATA " data "\n"

static void test_binary(void) {
  pcd_file file = begin(HEADER("3", "binary"));
  for (size_t i = 0; i < 3; i++) {
    put_words(&file, places[i], 3);
    put(&file, "\x11\x22\1\2\3", 5);
    put_words(&file, &colors[i], 1);
    put_words(&file, normals[i], 3);
  }
  conic_model model = read_points(&file, 3, BOTH);
  check_three(&model);
  CHECK(files_warnings == 0);
  conic_model_release(context, &model);
  file.n -= 1; /* what is there is read */
  model = read_points(&file, 2, BOTH);
  CHECK(files_warnings == 1 && strstr(files_warning, "declares 3 points; the 2"));
  conic_model_release(context, &model);
}

/* Each field by itself; packed with the first bytes as they are, a copy that repeats itself, and the rest. */
static void test_compressed(void) {
  unsigned char data[3 * 33];
  pcd_file file = begin(HEADER("3", "binary_compressed"));
  size_t n = 0, start = file.n;
  for (size_t axis = 0; axis < 3; axis++)
    for (size_t i = 0; i < 3; i++, n += 4)
      conic_store_float(data + n, places[i][axis]);
  memset(data + n, 0x55, 6 + 9); /* intensities and histograms */
  for (size_t i = 0; i < 3; i++)
    conic_store_32(data + n + 15 + 4 * i, colors[i]);
  n += 15 + 12;
  for (size_t axis = 0; axis < 3; axis++)
    for (size_t i = 0; i < 3; i++, n += 4)
      conic_store_float(data + n, normals[i][axis]);
  CHECK(n == sizeof data);
  put(&file, "\0\0\0\0\x63\0\0\0", 8);
  put(&file, "\x1f", 1); /* 32 bytes */
  put(&file, data, 32);
  put(&file, "\x04", 1); /* 5 bytes, the last of which is 0x55 */
  put(&file, data + 32, 5);
  put(&file, "\xe0\x05\0", 3); /* 14 bytes more of that */
  for (size_t at = 51; at < sizeof data; at += 16) {
    put(&file, "\x0f", 1);
    put(&file, data + at, 16);
  }
  file.bytes[start] = (unsigned char)(file.n - start - 8);
  conic_model model = read_points(&file, 3, BOTH);
  check_three(&model);
  conic_model_release(context, &model);
  for (size_t cut = start; cut < file.n; cut++)
    files_check_failed("cut", read_file(&file, cut, &model), "a.pcd: ", "byte", (const char *)NULL);
  file.bytes[start + 8] = 0xff; /* a copy of what is not there yet */
  files_check_failed("damaged", read_file(&file, file.n, &model), "damaged", "byte", (const char *)NULL);
  file.bytes[start + 4]++;
  files_check_failed("size", read_file(&file, file.n, &model), "no whole number of points", "byte", (const char *)NULL);
  file.bytes[start + 6] = 0x99;
  file.bytes[start + 4] = 0x0f;
  file.bytes[start + 5] = 0x02;
  files_check_failed("ratio", read_file(&file, file.n, &model), "byte", (const char *)NULL);
}

static void test_lzf(void) {
  unsigned char out[16];
  CHECK(conic_lzf_unpack((const unsigned char *)"\2abc\x20\2", 6, out, 6) && memcmp(out, "abcabc", 6) == 0);
  CHECK(!conic_lzf_unpack((const unsigned char *)"\2abc\x20\3", 6, out, 6)); /* before the first byte */
  CHECK(!conic_lzf_unpack((const unsigned char *)"\2abc\x20\2", 6, out, 5));
  CHECK(!conic_lzf_unpack((const unsigned char *)"\2abc\x20\2", 6, out, 7));
  CHECK(!conic_lzf_unpack((const unsigned char *)"\2abc\x20", 5, out, 6));
  CHECK(!conic_lzf_unpack((const unsigned char *)"\3abc", 4, out, 4));
  CHECK(conic_lzf_unpack(NULL, 0, NULL, 0));
}

/* Fields in another order, of other types and names; a colour as the bits of a float, and of an integer. */
static void test_ascii(void) {
  pcd_file file = begin("FIELDS z rgb x y\nSIZE 4 4 4 4\nTYPE F F F F\nWIDTH 2\nHEIGHT 1\nDATA ascii\n"
                        "3 4.2108e+06 500000.125 2\r\n\n6 nan 500001.25 5");
  conic_model model = read_points(&file, 2, CONIC_SPLATS_COLORS);
  CHECK(model.points.origin[0] == 500000.125 && model.points.position[0][1] == 1.125f);
  check_vector(model.points.color, 0, decoded(0x80), decoded(0x80), decoded(0xE0)); /* 0x4A8080E0 */
  conic_model_release(context, &model);
  file = begin("FIELDS x y z rgba\nSIZE 4 4 4 4\nTYPE F F F U\nPOINTS 2\nDATA ascii\n0 0 0 4278255360\n1 0 0 255\n");
  model = read_points(&file, 2, CONIC_SPLATS_COLORS);
  check_vector(model.points.color, 0, 0.0f, 1.0f, 0.0f);
  check_vector(model.points.color, 1, 0.0f, 0.0f, 1.0f);
  conic_model_release(context, &model);
  file = begin("FIELDS a x y z\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 3 1 1 1\nPOINTS 1\nDATA ascii\n7 7 7 1 2 3\n");
  model = read_points(&file, 1, 0);
  CHECK(model.points.origin[0] == 1.0 && model.points.origin[2] == 3.0);
  conic_model_release(context, &model);
  file = begin("FIELDS X Y Z Red Green Blue\nSIZE 8 8 8 2 2 2\nTYPE F F F U U U\nPOINTS 3\nDATA ascii\n"
               "nan nan nan 0 0 0\n1e6 2 3 65535 0 256\n");
  model = read_points(&file, 1, CONIC_SPLATS_COLORS); /* what is not a number was not measured */
  CHECK(files_warnings == 1 && model.n_unmeasured == 1 && model.points.origin[0] == 1e6 &&
        model.points.position[0][0] == 0.0f);
  check_vector(model.points.color, 0, 1.0f, 0.0f, (float)conic_srgb_decode(256.0 / 65535.0));
  conic_model_release(context, &model);
}

/* The field that is asked for, by any way of storing it. */
static void test_scalars(void) {
  conic_read_options options;
  conic_model model;
  conic_read_options_init(&options);
  options.field = "Intensity";
  const char *path =
      files_write("a.pcd", "FIELDS x y z _ h intensity\nSIZE 4 4 4 1 4 2\nTYPE F F F U F U\nCOUNT 1 1 1 2 3 1\n"
                           "POINTS 2\nDATA ascii\n1 2 3 0 0 8 8 8 700\n4 5 6 0 0 8 8 8 65535\n");
  CHECK_OK(conic_model_read(context, path, &options, &model));
  CHECK(model.n_fields == 4 && strcmp(model.fields[3].name, "intensity") == 0);
  CHECK(model.points.scalar && model.points.scalar[0] == 700.0f && model.points.scalar[1] == 65535.0f);
  conic_model_release(context, &model);
  options.field = "h";
  files_check_failed("three", conic_model_read(context, path, &options, &model), "no field 'h'", "x, y, z, intensity",
                     (const char *)NULL);
  CHECK(unlink(path) == 0);
}

static void check_refused(const char *text, const char *what, const char *where) {
  conic_model model;
  pcd_file file = begin(text);
  files_check_failed(text, read_file(&file, file.n, &model), "a.pcd: ", what, where, (const char *)NULL);
}

static void test_refused(void) {
#define XYZ "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\n"
  check_refused("FIELDS x y\n", "lack x, y or z", "line 1");
  check_refused("VERSION .7\nSIZE 4 4 4\nDATA ascii\n", "no line FIELDS", "line 3");
  check_refused("FIELDS x y z\nSIZE 4 4\nTYPE F F F\nDATA ascii\n", "2 sizes", "line 4");
  check_refused("FIELDS x y z\nSIZE 4 4 3\n", "neither 1, 2, 4 nor 8", "line 2");
  check_refused("FIELDS x y z\nSIZE 4 4 4\nTYPE F F X\n", "neither F, I nor U", "line 3");
  check_refused("FIELDS x y z\nSIZE 4 4 8\nTYPE F F I\nDATA ascii\n", "field z has a type", "line 4");
  check_refused(XYZ "COUNT 1 1 2\nDATA ascii\n", "field z has a type", "line 5");
  check_refused(XYZ "COUNT 1 1 1e9\n", "count is no whole number", "line 4");
  check_refused(XYZ "POINTS -1\n", "number of points", "line 4");
  check_refused(XYZ "POINTS 1e300\n", "number of points", "line 4");
  check_refused(XYZ "WIDTH 4000000000\nHEIGHT 4000000000\nDATA ascii\n", "too many points", "line 6");
  check_refused(XYZ "DATA text\n", "neither ascii, binary", "line 4");
  check_refused(XYZ "COLOUR red\n", "no word that is known", "line 4");
  check_refused(XYZ "POINTS 1\n", "within the header", "line 5");
  check_refused(XYZ "POINTS 1\nDATA ascii\n1 2\n", "2 values, where the header tells of 3", "line 6");
  check_refused(XYZ "POINTS 1\nDATA ascii\n1 2 x\n", "not a number", "line 6");
  check_refused(XYZ "POINTS 1\nDATA ascii\n\n", "before its first point", "byte");
  check_refused(XYZ "POINTS 1\nDATA binary\nabc", "before its first point", "byte");
  check_refused("x y z\n1 2 3\n", "no word that is known", "line 1");
}

/* A file of another program, where it is: as text of the same survey has it. */
static void test_foreign(const char *source_folder) {
  const char *path = check_data(source_folder, "clouds/autzen-utm.pcd");
  conic_model model;
  if (!path)
    return;
  CHECK_OK(conic_model_read(context, path, NULL, &model));
  CHECK(model.points.count == 1065 && model.points.color[0]);
  CHECK(fabs(model.points.origin[0] - 494500.0) < 600.0 && fabs(model.points.origin[1] - 4878200.0) < 900.0);
  conic_model_release(context, &model);
}

int main(int argc, char **argv) {
  context = files_context();
  test_binary();
  test_compressed();
  test_lzf();
  test_ascii();
  test_scalars();
  test_refused();
  test_foreign(argc > 1 ? argv[1] : ".");
  files_end(context);
  return check_result();
}
