/* The values that points have by name: which a file lists, and what asking for one gives. */
#include "core/base/byte_order.h"
#include "core/splats/point_fields.h"
#include "tests/support/files.h"
#include "tests/support/las_file.h"

static conic_context *context;

static conic_status read_field(const char *path, const char *field, int is_optional, conic_model *model) {
  conic_read_options options;
  conic_read_options_init(&options);
  options.field = field;
  options.field_is_optional = is_optional;
  return conic_model_read(context, path, &options, model);
}

static const conic_model_field *find(const conic_model *model, const char *name) {
  for (size_t i = 0; i < model->n_fields; i++)
    if (strcmp(model->fields[i].name, name) == 0)
      return &model->fields[i];
  return NULL;
}

static void check_values(const char *path, const char *field, const float *expected, size_t n) {
  conic_model model;
  CHECK_OK(read_field(path, field, 0, &model));
  CHECK(model.points.count == n && model.points.scalar);
  for (size_t i = 0; i < n && model.points.scalar; i++)
    if (model.points.scalar[i] != expected[i]) {
      fprintf(stderr, "%s of point %zu is %g, not %g\n", field, i, (double)model.points.scalar[i], (double)expected[i]);
      check_failures++;
    }
  conic_model_release(context, &model);
}

static void test_names(void) {
  CHECK(conic_field_is("Intensity", "scalar_intensity") && conic_field_is("reflectance", "intensity"));
  CHECK(conic_field_is("Return Number", "return_number") && conic_field_is("label", "Classification"));
  CHECK(!conic_field_is("intensity", "intensities") && !conic_field_is("scalar", ""));
}

/* Where each field stands in its format. */
static void test_las(int minor, int format, size_t time_at) {
  static const float intensities[] = {0.0f, 513.0f}, classes[] = {0.0f, 5.0f}, times[] = {0.0f, 86400.5f};
  int is_new = format >= 6;
  const float returns[] = {0.0f, 3.0f}, of_returns[] = {0.0f, is_new ? 12.0f : 4.0f};
  const float angles[] = {0.0f, is_new ? (float)(-1000.0 * 0.006) : -20.0f}, users[] = {0.0f, 200.0f};
  const float sources[] = {0.0f, 777.0f};
  las_file file = las_begin(minor, format, 2, 0);
  size_t at = file.points_offset + file.point_bytes;
  las_put(&file, at + 12, 513, 2);
  las_put(&file, at + 14, is_new ? 12 << 4 | 3 : 0xC0 | 4 << 3 | 3, 1);
  las_put(&file, at + (is_new ? 16 : 15), is_new ? 5 : 0xE0 | 5, 1);
  las_put(&file, at + 17, 200, 1);
  if (is_new)
    las_put(&file, at + 18, (uint64_t)(uint16_t)-1000, 2);
  else
    las_put(&file, at + 16, (uint64_t)(uint8_t)-20, 1);
  las_put(&file, at + (is_new ? 20 : 18), 777, 2);
  if (time_at)
    las_put_double(&file, at + time_at, 86400.5);
  const char *path = files_write_bytes("a.las", file.bytes, file.n_bytes);
  check_values(path, "intensity", intensities, 2);
  check_values(path, "classification", classes, 2);
  check_values(path, "return_number", returns, 2);
  check_values(path, "NumberOfReturns", of_returns, 2);
  check_values(path, "scan_angle", angles, 2);
  check_values(path, "user_data", users, 2);
  check_values(path, "point_source_id", sources, 2);
  if (time_at)
    check_values(path, "gps_time", times, 2);
  else {
    conic_model model;
    files_check_failed("time", read_field(path, "gps_time", 0, &model), "a.las", "no field 'gps_time'",
                       "there are: ", "intensity, return_number", NULL);
  }
  CHECK(unlink(path) == 0);
  free(file.bytes);
}

static void test_extra_bytes(void) {
  enum { POINTS = 2 };
  static const float heights[] = {-1.0f, 2.5f}, speeds[] = {1.5f, -3.25f};
  conic_model model;
  las_file file = las_begin(4, 6, POINTS, 6);
  size_t described_at = las_describe_extra(&file, POINTS);
  las_put(&file, file.points_offset + file.point_bytes + 30, 7, 2);
  for (size_t i = 0; i < POINTS; i++)
    conic_store_float(file.bytes + file.points_offset + i * file.point_bytes + 32, speeds[i]);
  const char *path = files_write_bytes("extra.las", file.bytes, file.n_bytes);
  check_values(path, "height?above", heights, 2);
  check_values(path, "speed", speeds, 2);
  CHECK_OK(conic_model_read(context, path, NULL, &model));
  CHECK(!model.points.scalar && find(&model, "speed") && strcmp(find(&model, "speed")->type, "float") == 0);
  CHECK(find(&model, "intensity") && strcmp(find(&model, "intensity")->type, "uint16") == 0);
  conic_model_release(context, &model);
  CHECK(unlink(path) == 0);

  file.bytes[described_at + 2] = 7; /* 64 bits are not read: no room is left for what follows */
  path = files_write_bytes("extra.las", file.bytes, file.n_bytes);
  files_check_failed("too far", read_field(path, "speed", 0, &model), "no field 'speed'", NULL);
  CHECK(unlink(path) == 0);
  free(file.bytes);
}

static void test_ply(void) {
  static const float heights[] = {2.0f, 4.0f, 6.0f}, labels[] = {7.0f, 8.0f, -9.0f}, reds[] = {1.0f, 2.0f, 3.0f};
  static const char text[] = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                             "property double z\nproperty short scalar_Label\nproperty list uchar int more\n"
                             "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n"
                             "0 0 2 7 1 5 1 0 0\n1 0 4 8 0 2 0 0\n0 1 6 -9 2 5 5 3 0 0\n";
  conic_model model;
  const char *path = files_write("a.ply", text);
  check_values(path, "z", heights, 3);
  check_values(path, "label", labels, 3);
  check_values(path, "red", reds, 3);
  CHECK_OK(read_field(path, "intensity", 1, &model));
  CHECK(!model.points.scalar && model.points.color[0] && model.n_fields == 7 && !find(&model, "more"));
  CHECK(find(&model, "z") && strcmp(find(&model, "z")->type, "double") == 0);
  conic_model_release(context, &model);
  files_check_failed("list", read_field(path, "more", 0, &model), "a.ply: no field 'more'; there are: x, y, z,", NULL);
  CHECK(!model.fields);
  CHECK(unlink(path) == 0);

  unsigned char binary[400];
  int n = snprintf((char *)binary, sizeof binary,
                   "ply\nformat binary_big_endian 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
                   "property float z\nproperty ushort quality\nend_header\n");
  memset(binary + n, 0, 28);
  binary[n + 12] = 1;
  binary[n + 27] = 9;
  static const float qualities[] = {256.0f, 9.0f};
  path = files_write_bytes("b.ply", binary, (size_t)n + 28);
  check_values(path, "quality", qualities, 2);
  CHECK(unlink(path) == 0);
}

/* Columns by their names, or by their numbers; what is no number in one that means nothing is none. */
static void test_text(void) {
  static const float amplitudes[] = {5.0f, 6.5f, -9.0f}, fifth[] = {1.0f, 2.0f, 3.0f}, xs[] = {0.0f, 1.0f, 0.0f};
  conic_model model;
  const char *path = files_write("a.csv", "x,y,z,Amplitude,label\n0,0,0,5,a\n1,0,0,6.5,7\n0,1,0,-9,c\n");
  check_values(path, "amplitude", amplitudes, 3);
  check_values(path, "x", xs, 3);
  CHECK_OK(read_field(path, "label", 0, &model));
  CHECK(model.points.scalar && isnan(model.points.scalar[0]) && model.points.scalar[1] == 7.0f);
  CHECK(model.n_fields == 5 && strcmp(model.fields[3].name, "Amplitude") == 0);
  conic_model_release(context, &model);
  files_check_failed("name", read_field(path, "amplitud", 0, &model), "did you mean 'Amplitude'?", NULL);
  CHECK(unlink(path) == 0);
  path = files_write("a.xyz", "0 0 0 5 1\n1 0 0 6 2\n0 1 0 9 3\n");
  check_values(path, "5", fifth, 3);
  CHECK(unlink(path) == 0);
}

static void test_pcd(void) {
  static const float curvatures[] = {0.5f, -2.0f}, labels[] = {3.0f, 200.0f};
  conic_model model;
  const char *path = files_write("a.pcd", "VERSION .7\nFIELDS x y z fpfh curvature label\nSIZE 4 4 4 4 4 1\n"
                                          "TYPE F F F F F U\nCOUNT 1 1 1 2 1 1\nWIDTH 2\nHEIGHT 1\nPOINTS 2\n"
                                          "DATA ascii\n0 0 0 9 9 .5 3\n1 0 0 9 9 -2 200\n");
  check_values(path, "curvature", curvatures, 2);
  check_values(path, "classification", labels, 2);
  files_check_failed("pcd", read_field(path, "fpfh", 0, &model), "no field 'fpfh'", "x, y, z, curvature, label", NULL);
  CHECK(unlink(path) == 0);
  char binary[300];
  int n = snprintf(binary, sizeof binary,
                   "VERSION .7\nFIELDS x y z intensity\nSIZE 4 4 4 4\nTYPE F F F F\n"
                   "COUNT 1 1 1 1\nWIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA binary\n");
  memset(binary + n, 0, 32);
  conic_store_float(binary + n + 12, curvatures[0]);
  conic_store_float(binary + n + 28, curvatures[1]);
  path = files_write_bytes("b.pcd", binary, (size_t)n + 32);
  check_values(path, "Intensity", curvatures, 2);
  CHECK(unlink(path) == 0);
}

typedef struct gathering {
  conic_splats all;
  size_t n_batches;
} gathering;

static conic_status gather(void *cookie, const conic_splats *batch) {
  gathering *g = cookie;
  if (g->n_batches++ == 0) {
    CHECK_OK(conic_splats_allocate(context, 0, conic_splats_fields(batch), &g->all));
    memcpy(g->all.origin, batch->origin, sizeof g->all.origin);
  }
  return conic_splats_append(context, &g->all, batch);
}

static void test_batches(void) {
  enum { MANY = 70000 };
  gathering g = {.n_batches = 0};
  conic_read_options options;
  las_file file = las_begin(2, 0, MANY, 0);
  for (size_t i = 0; i < MANY; i++) {
    las_set_point(&file, i, (int)i, 0, 0);
    las_put(&file, file.points_offset + i * file.point_bytes + 12, i & 0xFFFF, 2);
  }
  const char *path = files_write_bytes("many.las", file.bytes, file.n_bytes);
  conic_read_options_init(&options);
  options.field = "intensity";
  CHECK_OK(conic_model_stream(context, path, &options, gather, &g));
  CHECK(g.n_batches == 2 && g.all.count == MANY && g.all.scalar);
  for (size_t i = 0; i < MANY && g.all.scalar; i++)
    CHECK(g.all.scalar[i] == (float)(i & 0xFFFF));
  conic_splats_release(context, &g.all);
  CHECK(unlink(path) == 0);
  free(file.bytes);
}

static void test_without(void) {
  conic_model model;
  const char *path = files_write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  files_check_failed("obj", read_field(path, "intensity", 0, &model), "a.obj: no field 'intensity'", NULL);
  CHECK_OK(read_field(path, "intensity", 1, &model));
  CHECK(model.n_fields == 0 && !model.points.scalar);
  conic_model_release(context, &model);
  CHECK(unlink(path) == 0);
}

int main(void) {
  context = files_context();
  test_names();
  test_las(2, 0, 0);
  test_las(2, 1, 20);
  test_las(2, 2, 0);
  test_las(2, 3, 20);
  for (int format = 6; format <= 8; format++)
    test_las(4, format, 22);
  test_extra_bytes();
  test_ply();
  test_text();
  test_pcd();
  test_batches();
  test_without();
  files_end(context);
  return check_result();
}
