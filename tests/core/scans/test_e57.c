/* The E57 reader against a file made here, every value of which is known, and against real ones. */
#include <math.h>

#include "conic/version.h"
#include "core/base/color.h"
#include "tests/support/e57_example.h"
#include "tests/support/files.h"

static conic_context *context;

static conic_status read_bytes(const e57_test_file *file, const char *field, conic_model *model) {
  conic_read_options options;
  conic_read_options_init(&options);
  options.field = field;
  const char *path = files_write_bytes("a.e57", file->bytes, file->n_bytes);
  conic_status status = conic_model_read(context, path, &options, model);
  CHECK(unlink(path) == 0);
  return status;
}

static void check_place(const conic_splats *points, size_t i, double x, double y, double z) {
  const double expected[3] = {x, y, z};
  for (int axis = 0; axis < 3; axis++)
    CHECK_NEAR(points->origin[axis] + (double)points->position[axis][i], expected[axis], 1e-5);
}

/* Turned by 90° about z, (x, y, z) is (−y, x, z). */
static void test_values(void) {
  e57_test_file file;
  conic_model model;
  e57_make(&file);
  CHECK_OK(read_bytes(&file, "intensity", &model));
  const conic_splats *points = &model.points;
  CHECK(model.kind == CONIC_MODEL_E57 && points->count == 5 && model.up[2] == 1.0);
  if (points->count != 5)
    return;
  static const int kept[3] = {0, 1, 3};
  for (size_t k = 0; k < 3; k++) {
    const double *p = e57_places[kept[k]];
    check_place(points, k, 100.0 - p[1], 200.0 + p[0], 300.0 + p[2]);
    CHECK(points->scalar[k] == (float)e57_intensities[kept[k]]);
    for (int channel = 0; channel < 3; channel++)
      CHECK(points->color[channel][k] == (float)conic_srgb_decode((double)(50 * kept[k] + 10 * channel) / 255.0));
    double along = 0.0, length2 = p[0] * p[0] + p[1] * p[1] + p[2] * p[2];
    const double world[3] = {-p[1], p[0], p[2]};
    for (int axis = 0; axis < 3; axis++)
      along += (double)points->sight[axis][k] * world[axis];
    CHECK_NEAR(along, -sqrt(length2), 1e-3); /* towards where the scanner stood */
  }
  check_place(points, 3, 2.0, 0.0, 0.0);
  check_place(points, 4, 0.0, 0.0, 3.0);
  CHECK(points->color[0][3] == 1.0f && points->sight[2][4] == -1.0f && isnan(points->scalar[4]));
  conic_model_release(context, &model);
}

static conic_status count_batch(void *cookie, const conic_splats *batch) {
  conic_splats *all = cookie;
  return conic_splats_append(context, all, batch);
}

static void test_stream(void) {
  e57_test_file file;
  conic_model model;
  conic_splats streamed;
  e57_make(&file);
  CHECK_OK(read_bytes(&file, NULL, &model));
  memset(&streamed, 0, sizeof streamed);
  memcpy(streamed.origin, model.points.origin, sizeof streamed.origin);
  const char *path = files_write_bytes("b.e57", file.bytes, file.n_bytes);
  CHECK_OK(conic_model_stream(context, path, NULL, count_batch, &streamed));
  CHECK(unlink(path) == 0);
  CHECK(streamed.count == model.points.count);
  for (int axis = 0; axis < 3 && streamed.count == model.points.count; axis++) {
    CHECK(memcmp(streamed.position[axis], model.points.position[axis], streamed.count * sizeof(float)) == 0);
    CHECK(memcmp(streamed.color[axis], model.points.color[axis], streamed.count * sizeof(float)) == 0);
    CHECK(memcmp(streamed.sight[axis], model.points.sight[axis], streamed.count * sizeof(float)) == 0);
  }
  conic_splats_release(context, &streamed);
  conic_model_release(context, &model);
}

/* Replaces a text of the file by one that is as long, and mends the sums. */
static void replace(e57_test_file *file, const char *old, const char *text) {
  size_t n = strlen(old);
  CHECK(n == strlen(text));
  for (size_t i = 0; i + n <= file->n_bytes; i++)
    if (memcmp(file->bytes + i, old, n) == 0) {
      memcpy(file->bytes + i, text, n);
      conic_e57_mend(file->bytes, file->n_bytes);
      return;
    }
  fprintf(stderr, "no '%s' in one piece\n", old);
  check_failures++;
}

static void check_wrong(const char *old, const char *text, const char *said) {
  e57_test_file file;
  conic_model model;
  e57_make(&file);
  replace(&file, old, text);
  files_check_failed(text, read_bytes(&file, NULL, &model), "a.e57: ", said, "(at byte ", (const char *)NULL);
}

static void test_wrong(void) {
  e57_test_file file;
  conic_model model;
  e57_make(&file);
  file.bytes[200] ^= 1;
  files_check_failed("sum", read_bytes(&file, NULL, &model), "a.e57: a page's checksum is wrong", (const char *)NULL);
  e57_make(&file);
  file.n_bytes -= E57_PAGE;
  files_check_failed("cut", read_bytes(&file, NULL, &model), "a part of it is missing", (const char *)NULL);
  check_wrong("recordCount=\"5\"", "recordCount=\"6\"", "a packet is too short");
  check_wrong("recordCount=\"5\"", "rehordCount=\"5\"", "the XML: it does not say where the points of a scan are");
  check_wrong("</e57Root>", "</e57root>", "the XML: it is damaged");
  check_wrong("<e57Root", "<E57Root", "the XML");
  check_wrong("maximum=\"4095\"", "maximum=\"-095\"", "the limits of a value");
  check_wrong("sphericalAzimuth", "sphericalAzimoth", "have no coordinates");
  e57_make(&file);
  CHECK(read_bytes(&file, "reflectance", &model) == CONIC_OK); /* means the same */
  conic_model_release(context, &model);
  files_check_failed("field", read_bytes(&file, "humidity", &model), "no field 'humidity'", (const char *)NULL);
}

/* A scan from within a box: every normal turns inwards, to the scanner, where the middle alone says outwards. */
static double facing_share(int has_sights) {
  enum { SIDE = 12, N = 6 * SIDE * SIDE };
  conic_model model;
  conic_estimate_options options;
  size_t n_facing = 0;
  memset(&model, 0, sizeof model);
  CHECK_OK(conic_splats_allocate(context, N, has_sights ? CONIC_SPLATS_SIGHTS : 0u, &model.points));
  for (size_t i = 0; i < N; i++) {
    size_t face = i / (SIDE * SIDE);
    double place[3] = {0.0, ((double)(i % SIDE) + 0.5) / SIDE * 2.0 - 1.0,
                       ((double)(i / SIDE % SIDE) + 0.5) / SIDE * 2.0 - 1.0};
    place[0] = face % 2 ? 1.0 : -1.0;
    for (size_t axis = 0; axis < 3; axis++) {
      float value = (float)place[(axis + face / 2) % 3];
      model.points.position[axis][i] = value;
      if (has_sights)
        model.points.sight[axis][i] = -value;
    }
  }
  conic_estimate_options_init(&options);
  CHECK_OK(conic_model_to_splats(context, &options, &model, NULL));
  for (size_t i = 0; i < N; i++) {
    double normal[3], inwards = 0.0;
    for (int axis = 0; axis < 3; axis++) {
      int b = (axis + 1) % 3, c = (axis + 2) % 3;
      normal[axis] = (double)(model.points.tangent_u[b][i] * model.points.tangent_v[c][i] -
                              model.points.tangent_u[c][i] * model.points.tangent_v[b][i]);
      inwards -= normal[axis] * (double)model.points.position[axis][i];
    }
    n_facing += inwards > 0.0;
  }
  conic_model_release(context, &model);
  return (double)n_facing / N;
}

/* They hold the same six points, one in a cloud and one in two. */
static void test_real(const char *source_folder) {
  conic_model both, merged;
  if (!check_data(source_folder, "clouds/A_B.e57") || !check_data(source_folder, "clouds/A_merged_B.e57"))
    return;
  CHECK_OK(conic_model_read(context, check_data(source_folder, "clouds/A_B.e57"), NULL, &both));
  CHECK_OK(conic_model_read(context, check_data(source_folder, "clouds/A_merged_B.e57"), NULL, &merged));
  CHECK(both.points.count == 6 && merged.points.count == 6 && !both.points.sight[0]);
  for (size_t i = 0; i < 6 && both.points.count == 6 && merged.points.count == 6; i++) {
    int n_same = 0;
    for (size_t k = 0; k < 6; k++)
      n_same += both.points.position[0][i] == merged.points.position[0][k] &&
                both.points.position[1][i] == merged.points.position[1][k] &&
                both.points.position[2][i] == merged.points.position[2][k];
    CHECK(n_same == 1);
  }
  conic_model_release(context, &both);
  conic_model_release(context, &merged);
}

static int is_in_build(const char *feature) {
  for (int i = 0; conic_feature_at(i); i++)
    if (strcmp(conic_feature_at(i)->name, feature) == 0)
      return conic_feature_at(i)->available;
  return 0;
}

int main(int argc, char **argv) {
  context = files_context();
  CHECK(facing_share(0) < 0.01);
  CHECK(facing_share(1) == 1.0);
  if (is_in_build("libxml2")) {
    test_values();
    test_stream();
    test_wrong();
    test_real(argc > 1 ? argv[1] : ".");
  }
  files_end(context);
  return check_result();
}
