/* The PLY writer: what it writes is read back, bit for bit where the file's types allow it. */
#include <stdint.h>

#include "core/base/color.h"
#include "tests/support/files.h"

static conic_context *context;

enum { N = 700 }; /* more than the rows that are laid out at a time */

static uint64_t state = 88172645463325252u;

static float next_float(void) {
  state ^= state << 13;
  state ^= state >> 7;
  state ^= state << 17;
  return (float)((double)(int64_t)state * 1e-19);
}

static void fill(float *const array[3], size_t n) {
  for (int axis = 0; axis < 3; axis++)
    for (size_t i = 0; array[axis] && i < n; i++)
      array[axis][i] = next_float();
}

static void make(conic_splats *splats, unsigned fields) {
  CHECK_OK(conic_splats_allocate(context, N, fields, splats));
  fill(splats->position, N);
  fill(splats->tangent_u, N);
  fill(splats->tangent_v, N);
  fill(splats->normal, N);
  fill(splats->color, N);
  for (size_t i = 0; splats->opacity && i < N; i++)
    splats->opacity[i] = next_float();
}

static int same_arrays(float *const a[3], float *const b[3]) {
  for (int axis = 0; axis < 3; axis++)
    if (!a[axis] != !b[axis] || (a[axis] && memcmp(a[axis], b[axis], N * sizeof(float)) != 0))
      return 0;
  return 1;
}

static int same_sets(const conic_splats *a, const conic_splats *b) {
  return a->count == b->count && memcmp(a->origin, b->origin, sizeof a->origin) == 0 &&
         conic_splats_fields(a) == conic_splats_fields(b) && same_arrays(a->position, b->position) &&
         same_arrays(a->tangent_u, b->tangent_u) && same_arrays(a->tangent_v, b->tangent_v) &&
         same_arrays(a->normal, b->normal) && same_arrays(a->color, b->color) &&
         (!a->opacity || memcmp(a->opacity, b->opacity, N * sizeof(float)) == 0);
}

static void write_and_read(const conic_splats *splats, const conic_write_options *options, conic_model *model) {
  const char *path = files_path("a.ply");
  CHECK_OK(conic_splats_write(context, path, splats, options));
  CHECK_OK(conic_model_read(context, path, NULL, model));
  CHECK(unlink(path) == 0);
}

static void test_exact(void) {
  static const unsigned fields[] = {0, CONIC_SPLATS_TANGENTS, CONIC_SPLATS_NORMALS,
                                    CONIC_SPLATS_TANGENTS | CONIC_SPLATS_COLORS | CONIC_SPLATS_OPACITIES,
                                    CONIC_SPLATS_NORMALS | CONIC_SPLATS_COLORS};
  for (int encoding = CONIC_PLY_BINARY; encoding <= CONIC_PLY_ASCII; encoding++)
    for (size_t i = 0; i < sizeof fields / sizeof *fields; i++) {
      conic_splats splats;
      conic_model model;
      conic_write_options options;
      conic_write_options_init(&options);
      options.encoding = (conic_ply_encoding)encoding;
      make(&splats, fields[i]);
      splats.position[0][3] = (float)HUGE_VAL;
      splats.position[1][4] = -0.0f;
      write_and_read(&splats, &options, &model);
      CHECK(same_sets(&splats, &model.points));
      conic_model_release(context, &model);
      conic_splats_release(context, &splats);
    }
}

static void test_byte_colors(void) {
  float table[256];
  char header[400] = "";
  conic_splats splats;
  conic_model model;
  conic_srgb_decode_table(table);
  make(&splats, CONIC_SPLATS_COLORS);
  for (int channel = 0; channel < 3; channel++)
    for (size_t i = 0; i < N; i++)
      splats.color[channel][i] = table[(i * 7 + (size_t)channel) & 255];
  write_and_read(&splats, NULL, &model);
  CHECK(same_sets(&splats, &model.points));
  conic_model_release(context, &model);
  const char *path = files_path("a.ply");
  for (int is_byte = 1; is_byte >= 0; is_byte--) {
    splats.color[2][N - 1] = is_byte ? 1.0f : 0.5f;
    CHECK_OK(conic_splats_write(context, path, &splats, NULL));
    FILE *file = fopen(path, "rb");
    CHECK(file && fread(header, 1, sizeof header - 1, file) > 100);
    fclose(file);
    CHECK((strstr(header, "property uchar red\n") != NULL) == is_byte);
    CHECK((strstr(header, "property float red\n") != NULL) != is_byte);
  }
  unlink(path);
  conic_splats_release(context, &splats);
}

static void test_origin(void) {
  for (int encoding = CONIC_PLY_BINARY; encoding <= CONIC_PLY_ASCII; encoding++) {
    conic_splats splats;
    conic_model model;
    conic_write_options options;
    conic_write_options_init(&options);
    options.encoding = (conic_ply_encoding)encoding;
    make(&splats, 0);
    splats.origin[0] = 4500000.25;
    splats.origin[2] = -1e7;
    write_and_read(&splats, &options, &model);
    for (int axis = 0; axis < 3; axis++)
      for (size_t i = 0; i < N; i++)
        CHECK_NEAR(model.points.origin[axis] + (double)model.points.position[axis][i],
                   splats.origin[axis] + (double)splats.position[axis][i], 1e-6);
    CHECK(model.points.origin[0] > 4400000.0);
    conic_model_release(context, &model);
    conic_splats_release(context, &splats);
  }
}

static double length_of(float *const vector[3], size_t i) {
  double x = (double)vector[0][i], y = (double)vector[1][i], z = (double)vector[2][i];
  return sqrt(x * x + y * y + z * z);
}

static void test_circles(void) {
  conic_splats splats;
  conic_model model;
  conic_write_options options;
  conic_write_options_init(&options);
  options.circles = 1;
  make(&splats, CONIC_SPLATS_TANGENTS);
  for (size_t i = 0; i < N; i++) { /* any u, and v as long and at a right angle */
    double u[3], v[3];
    for (int axis = 0; axis < 3; axis++)
      u[axis] = (double)splats.tangent_u[axis][i];
    double scale = length_of(splats.tangent_u, i) / sqrt(u[0] * u[0] + u[1] * u[1]);
    v[0] = -u[1] * scale;
    v[1] = u[0] * scale;
    v[2] = 0.0;
    for (int axis = 0; axis < 3; axis++)
      splats.tangent_v[axis][i] = (float)v[axis];
  }
  for (int axis = 0; axis < 3; axis++)
    splats.tangent_u[axis][5] = splats.tangent_v[axis][5] = 0.0f;
  write_and_read(&splats, &options, &model);
  conic_splats *read = &model.points;
  for (size_t i = 0; i < N; i++) {
    double sigma = length_of(splats.tangent_u, i), dot_u = 0.0, dot_v = 0.0;
    CHECK_NEAR(length_of(read->tangent_u, i), sigma, 3e-7 * sigma);
    for (int axis = 0; axis < 3; axis++) { /* the same plane: the new axes lie in the span of the old */
      int next = (axis + 1) % 3, last = (axis + 2) % 3;
      double normal = (double)splats.tangent_u[next][i] * (double)splats.tangent_v[last][i] -
                      (double)splats.tangent_u[last][i] * (double)splats.tangent_v[next][i];
      dot_u += normal * (double)read->tangent_u[axis][i];
      dot_v += normal * (double)read->tangent_v[axis][i];
    }
    CHECK_NEAR(dot_u, 0.0, 1e-6 * sigma * sigma * sigma);
    CHECK_NEAR(dot_v, 0.0, 1e-6 * sigma * sigma * sigma);
  }
  conic_model_release(context, &model);
  conic_splats_release(context, &splats);
}

static void test_batches(void) {
  conic_splats splats;
  conic_splats_writer *writer;
  conic_model model;
  make(&splats, CONIC_SPLATS_TANGENTS);
  const char *path = files_path("b.ply");
  CHECK_OK(conic_splats_writer_open(context, path, N, CONIC_SPLATS_TANGENTS, NULL, &writer));
  for (size_t first = 0; first < N; first += 300) {
    conic_splats batch = splats;
    batch.count = N - first < 300 ? N - first : 300;
    for (int axis = 0; axis < 3; axis++) {
      batch.position[axis] += first;
      batch.tangent_u[axis] += first;
      batch.tangent_v[axis] += first;
    }
    CHECK_OK(conic_splats_writer_append(writer, &batch));
    CHECK(access(path, F_OK) != 0);
  }
  CHECK(conic_splats_writer_append(writer, &splats) == CONIC_ERROR_ARGUMENT);
  CHECK_OK(conic_splats_writer_finish(writer));
  CHECK_OK(conic_model_read(context, path, NULL, &model));
  CHECK(same_sets(&splats, &model.points));
  conic_model_release(context, &model);
  unlink(path);
  conic_splats_release(context, &splats);
}

static void test_misuse(void) {
  conic_splats splats;
  conic_splats_writer *writer;
  conic_write_options options;
  make(&splats, 0);
  const char *path = files_path("c.ply");
  CHECK_OK(conic_splats_writer_open(context, path, N + 1, 0, NULL, &writer));
  CHECK_OK(conic_splats_writer_append(writer, &splats));
  CHECK(conic_splats_writer_finish(writer) == CONIC_ERROR_ARGUMENT);
  CHECK(strstr(files_message, "c.ply") && strstr(files_message, "701"));
  CHECK_OK(conic_splats_writer_open(context, path, N, CONIC_SPLATS_COLORS, NULL, &writer));
  CHECK(conic_splats_writer_append(writer, &splats) == CONIC_ERROR_ARGUMENT);
  conic_splats_writer_abandon(writer);
  conic_splats_writer_abandon(NULL);
  conic_write_options_init(&options);
  options.circles = 1;
  CHECK(conic_splats_write(context, path, &splats, &options) == CONIC_ERROR_ARGUMENT);
  options.size = 1;
  CHECK(conic_splats_write(context, path, &splats, &options) == CONIC_ERROR_ARGUMENT);
  CHECK(access(path, F_OK) != 0);
  CHECK(conic_splats_write(context, files_folder, &splats, NULL) == CONIC_ERROR_IO);
  CHECK(conic_splats_write(context, files_path("no/folder.ply"), &splats, NULL) == CONIC_ERROR_IO);
  if (access("/dev/full", W_OK) == 0)
    CHECK(conic_splats_write(context, "/dev/full", &splats, NULL) == CONIC_ERROR_IO);
  splats.count = 0;
  CHECK_OK(conic_splats_write(context, path, &splats, NULL));
  conic_model model;
  CHECK_OK(conic_model_read(context, path, NULL, &model));
  CHECK(model.points.count == 0);
  conic_model_release(context, &model);
  unlink(path);
  conic_splats_release(context, &splats);
}

int main(void) {
  context = files_context();
  test_exact();
  test_byte_colors();
  test_origin();
  test_circles();
  test_batches();
  test_misuse();
  files_end(context);
  return check_result();
}
