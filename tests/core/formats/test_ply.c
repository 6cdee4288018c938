/* The PLY reader against hand-made files of every variant. */
#include <pthread.h>

#include "core/base/color.h"
#include "tests/support/ply_file.h"

static void test_encodings(void) {
  float table[256];
  conic_srgb_decode_table(table);
  for (int has_list = 0; has_list < 2; has_list++) {
    conic_model models[N_ENCODINGS];
    for (int kind = TEXT; kind < N_ENCODINGS; kind++) {
      ply_put_mixture((encoding)kind, has_list);
      CHECK_OK(ply_read(&models[kind]));
    }
    const conic_splats *points = &models[0].points;
    CHECK(points->count == 3 && models[0].n_triangles == 3);
    CHECK(points->position[0][1] == (float)(1e-3 / 2) && points->position[1][2] == 2.2f && points->origin[0] == 0.0);
    CHECK(points->position[2][0] == 0.3f);
    CHECK(conic_splats_fields(points) == CONIC_SPLATS_COLORS);
    CHECK(points->color[0][1] == 1.0f && points->color[1][1] == table[101] && points->color[2][1] == table[10]);
    CHECK(models[0].triangles[2][0] == 0 && models[0].triangles[2][1] == 2 && models[0].triangles[2][2] == 0);
    CHECK(ply_same_models(&models[TEXT], &models[LITTLE]) && ply_same_models(&models[TEXT], &models[BIG]));
    for (int kind = TEXT; kind < N_ENCODINGS; kind++)
      conic_model_release(context, &models[kind]);
  }
}

static void test_line_ends(void) {
  conic_model with, without;
  char long_comment[5000];
  CHECK_OK(
      ply_read_text("ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
                    "end_header\n1 2 3\n4 5 -6e0\n",
                    &without));
  CHECK_OK(ply_read_text("ply\r\nformat ascii 1.0\r\ncomment  \r\n\r\nelement vertex 2\r\nproperty float x\r\n"
                         "property float\ty \r\n property float z\r\nend_header\r\n\r\n1 2\t3 \r\n\n 4  +5 -6\r\n",
                         &with));
  CHECK(ply_same_models(&with, &without) && with.points.position[2][1] == -6.0f);
  conic_model_release(context, &with);
  CHECK_OK(
      ply_read_text("ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
                    "end_header\n1 2 3\n4 5 -6",
                    &with)); /* no line end at the end of the file */
  CHECK(ply_same_models(&with, &without));
  conic_model_release(context, &with);
  memset(long_comment, 'a', sizeof long_comment);
  ply.n = 0;
  ply_add_text("ply\r\nformat binary_little_endian 1.0\r\ncomment ");
  memcpy(ply.bytes + ply.n, long_comment, sizeof long_comment);
  ply.n += sizeof long_comment;
  ply_add_text("\r\nelement vertex 2\r\nproperty float x\r\nproperty float y\r\nproperty float z\r\nend_header\r\n");
  ply.encoding = LITTLE;
  for (int i = 1; i <= 6; i++)
    ply_add('f', i == 6 ? -6 : i);
  CHECK_OK(ply_read(&with));
  CHECK(ply_same_models(&with, &without));
  conic_model_release(context, &with);
  conic_model_release(context, &without);
}

static void test_origin(void) {
  static const char *const types[] = {"double", "int"};
  for (int kind = TEXT; kind < N_ENCODINGS; kind++)
    for (int type = 0; type < 2; type++) {
      char header[200];
      conic_model model;
      snprintf(header, sizeof header, "element vertex 3\nproperty %s x\nproperty double y\nproperty float z\n",
               types[type]);
      ply_begin((encoding)kind, header);
      for (int i = 0; i < 3; i++) {
        ply_add(type ? 'i' : 'd', type ? 20000001 + i : 4500000.1 + i);
        ply_add('d', i == 0 ? (double)NAN : 5e6 + 0.125 * i);
        ply_add('f', 7.5);
        ply_end_row();
      }
      CHECK_OK(ply_read(&model));
      CHECK(model.points.origin[0] == (type ? 20000002 : 4500001.1) && model.points.origin[1] == 5e6 + 0.125);
      CHECK(model.points.position[0][1] == 0.0f && model.points.position[0][2] == 1.0f);
      CHECK(isnan(model.points.position[1][0]) && model.points.position[1][2] == 0.125f);
      CHECK(model.points.origin[2] + (double)model.points.position[2][2] == 7.5);
      conic_model_release(context, &model);
    }
}

static void check_circle(const conic_splats *points, size_t i, const double normal[3], double sigma) {
  double u[3], v[3], uu = 0, vv = 0, uv = 0;
  for (int axis = 0; axis < 3; axis++) {
    u[axis] = (double)points->tangent_u[axis][i];
    v[axis] = (double)points->tangent_v[axis][i];
    uu += u[axis] * u[axis];
    vv += v[axis] * v[axis];
    uv += u[axis] * v[axis];
  }
  CHECK_NEAR(sqrt(uu) / sigma, 1.0, 2e-7);
  CHECK_NEAR(sqrt(vv) / sigma, 1.0, 2e-7);
  CHECK_NEAR(uv / (sigma * sigma), 0.0, 2e-7);
  for (int axis = 0; axis < 3; axis++) {
    int next = (axis + 1) % 3, last = (axis + 2) % 3;
    CHECK_NEAR((u[next] * v[last] - u[last] * v[next]) / (sigma * sigma), normal[axis], 3e-7);
  }
}

static void test_circles(void) {
  static const double normals[][3] = {{0, 0, 1},         {0, 0, -1},     {1, 0, 0},
                                      {0, -1, 0},        {0.6, 0, -0.8}, {0.6, 0.8, 0},
                                      {0.6, -0.8, -0.0}, {1e-9, 0, -1},  {-0.48, 0.6, 0.64}};
  enum { N = sizeof normals / sizeof *normals };
  conic_model model;
  ply_begin(LITTLE, "element vertex 13\nproperty float x\nproperty float y\nproperty float z\nproperty float radius\n"
                    "property double nx\nproperty double ny\nproperty double nz\nproperty float opacity\n");
  for (int i = 0; i < N + 4; i++) {
    double scale = i == N ? 0.0 : i == N + 1 ? (double)NAN : 3.0; /* normals of any length */
    const double *normal = normals[i < N ? i : 0];
    ply_add('f', i), ply_add('f', 0), ply_add('f', 0), ply_add('f', i == N + 2 ? 0.0 : i == N + 3 ? (double)NAN : 0.75);
    ply_add('d', scale * normal[0]), ply_add('d', scale * normal[1]), ply_add('d', scale * normal[2]),
        ply_add('f', 0.5);
  }
  CHECK_OK(ply_read(&model));
  CHECK(conic_splats_fields(&model.points) == (CONIC_SPLATS_TANGENTS | CONIC_SPLATS_OPACITIES));
  CHECK(model.points.count == N + 4 && model.points.opacity[3] == 0.5f);
  for (int i = 0; i < N; i++)
    check_circle(&model.points, (size_t)i, normals[i], 0.5);
  for (int i = N; i < N + 4; i++)
    for (int axis = 0; axis < 3; axis++)
      CHECK(model.points.tangent_u[axis][i] == 0.0f && model.points.tangent_v[axis][i] == 0.0f);
  conic_model_release(context, &model);
}

static void test_cutoff(void) {
  conic_model model;
  conic_read_options options;
  conic_read_options_init(&options);
  CHECK(options.cutoff == 1.5f);
  options.cutoff = 3.0f;
  const char *path =
      files_write("a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                           "property float z\nproperty float nx\nproperty float ny\nproperty float nz\n"
                           "property float radius\nend_header\n0 0 0 0 0 1 6\n");
  CHECK_OK(conic_model_read(context, path, &options, &model));
  CHECK(model.points.tangent_u[0][0] == 2.0f && model.points.tangent_v[1][0] == 2.0f);
  conic_model_release(context, &model);
  options.cutoff = 0.0f;
  CHECK(conic_model_read(context, path, &options, &model) == CONIC_ERROR_ARGUMENT);
  unlink(path);
}

static void test_axes_and_normals(void) {
  conic_model model;
  CHECK_OK(
      ply_read_text("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
                    "property float tv_x\nproperty float tv_y\nproperty float tv_z\nproperty float tu_x\n"
                    "property float tu_y\nproperty float tu_z\nproperty float nx\nproperty float ny\n"
                    "property float nz\nproperty float radius\nproperty float r\nproperty float g\nproperty float b\n"
                    "end_header\n0 0 0 1 2 3 4 5 6 0 0 1 9 0.25 2 -1\n",
                    &model));
  CHECK(conic_splats_fields(&model.points) == (CONIC_SPLATS_TANGENTS | CONIC_SPLATS_COLORS));
  CHECK(model.points.tangent_u[2][0] == 6.0f && model.points.tangent_v[0][0] == 1.0f);
  CHECK(model.points.color[0][0] == 0.25f && model.points.color[1][0] == 2.0f && model.points.color[2][0] == -1.0f);
  conic_model_release(context, &model);
  CHECK_OK(
      ply_read_text("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
                    "property float nx\nproperty float ny\nproperty float nz\nproperty uchar diffuse_red\n"
                    "property uchar diffuse_green\nproperty uchar diffuse_blue\nproperty uchar alpha\n"
                    "property float opacity\nend_header\n0 nan -inf 0 0 2 255 0 255 9 0.5\n",
                    &model));
  CHECK(conic_splats_fields(&model.points) == (CONIC_SPLATS_NORMALS | CONIC_SPLATS_COLORS));
  CHECK(model.points.normal[2][0] == 2.0f && isnan(model.points.position[1][0]));
  CHECK(model.points.color[0][0] == 1.0f && model.points.color[1][0] == 0.0f);
  conic_model_release(context, &model);
  CHECK_OK(ply_read_text(
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
      "property ushort red\nproperty ushort green\nproperty ushort blue\nend_header\n0 0 0 65535 0 32896\n",
      &model));
  CHECK(model.points.color[0][0] == 1.0f && model.points.color[1][0] == 0.0f);
  CHECK(model.points.color[2][0] == (float)conic_srgb_decode(128.0 / 255.0)); /* 32896 = 257 × 128 */
  conic_model_release(context, &model);
}

#define GAUSSIAN_ROTATION "property float rot_0\nproperty float rot_1\nproperty float rot_2\nproperty float rot_3\n"

static void test_gaussians(void) {
  conic_model model;
  double h = sqrt(0.5);
  ply_begin(LITTLE, "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\n"
                    "property float ny\nproperty float nz\nproperty float f_dc_0\nproperty float f_dc_1\n"
                    "property float f_dc_2\nproperty float f_rest_0\nproperty float opacity\nproperty float scale_0\n"
                    "property float scale_1\nproperty float scale_2\n" GAUSSIAN_ROTATION);
  /* thin along its own x, turned by 90° around z: the normal is world y */
  const double scales[3][3] = {{-5, -1, 0.5}, {-5, -1, 0.5}, {1, 2, -3}};
  const double rotations[3][4] = {{h, 0, 0, h}, {0, 0, 0, 0}, {7, 0, 0, 0}};
  for (int i = 0; i < 3; i++) {
    for (int k = 0; k < 6; k++)
      ply_add('f', 0);
    ply_add('f', 0), ply_add('f', -5), ply_add('f', 1), ply_add('f', 99), ply_add('f', i == 1 ? -2.0 : 0.0);
    for (int k = 0; k < 3; k++)
      ply_add('f', scales[i][k]);
    for (int k = 0; k < 4; k++)
      ply_add('f', rotations[i][k]);
  }
  CHECK_OK(ply_read(&model));
  conic_splats *points = &model.points;
  CHECK(conic_splats_fields(points) == (CONIC_SPLATS_TANGENTS | CONIC_SPLATS_COLORS | CONIC_SPLATS_OPACITIES));
  CHECK_NEAR(points->tangent_u[0][0], -exp(-1.0), 1e-7); /* own y is world -x */
  CHECK_NEAR(points->tangent_v[2][0], exp(0.5), 2e-7);
  CHECK_NEAR(points->tangent_u[1][0], 0.0, 1e-7);
  CHECK(points->tangent_u[0][1] == 0.0f && points->tangent_v[2][1] == 0.0f);
  CHECK_NEAR(points->tangent_u[0][2], exp(1.0), 3e-7);
  CHECK_NEAR(points->tangent_v[1][2], exp(2.0), 6e-7);
  CHECK(points->opacity[0] == 0.5f);
  CHECK_NEAR(points->opacity[1], 1.0 / (1.0 + exp(2.0)), 1e-8);
  CHECK_NEAR(points->color[0][0], 0.21404114, 1e-7);
  CHECK(points->color[1][0] == 0.0f);
  CHECK_NEAR(points->color[2][0], conic_srgb_decode(0.78209479), 1e-7);
  conic_model_release(context, &model);
}

static void test_flat_gaussians(void) {
  conic_model model;
  CHECK_OK(
      ply_read_text("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
                    "property float scale_0\nproperty float scale_1\n" GAUSSIAN_ROTATION
                    "property uchar red\nproperty uchar green\nproperty uchar blue\n"
                    "end_header\n0 0 0 0 -1 0 0 2 0 255 255 0\n",
                    &model)); /* half a turn around y */
  CHECK(conic_splats_fields(&model.points) == (CONIC_SPLATS_TANGENTS | CONIC_SPLATS_COLORS));
  CHECK(model.points.tangent_u[0][0] == -1.0f);
  CHECK_NEAR(model.points.tangent_v[1][0], exp(-1.0), 1e-7);
  CHECK(model.points.color[1][0] == 1.0f && model.points.color[2][0] == 0.0f);
  conic_model_release(context, &model);
}

static void test_strips(void) {
  static const uint32_t expected[][3] = {{0, 1, 2}, {2, 1, 3}, {2, 3, 0}, {1, 2, 3}, {3, 2, 0}};
  for (int kind = TEXT; kind < N_ENCODINGS; kind++) {
    static const int strip[] = {0, 1, 2, 3, 0, -1, 1, 2, 3, 3, 0, 0, -1, 2, 1};
    conic_model model;
    ply_begin((encoding)kind, "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
                              "element tristrips 1\nproperty list int int vertex_indices\n");
    for (int i = 0; i < 4; i++) {
      ply_add('f', i), ply_add('f', 0), ply_add('f', 0);
      ply_end_row();
    }
    ply_add('i', 15);
    for (int i = 0; i < 15; i++)
      ply_add('i', strip[i]);
    ply_end_row();
    CHECK_OK(ply_read(&model));
    CHECK(model.n_triangles == 4);
    for (size_t i = 0; i < 4 && i < model.n_triangles; i++)
      CHECK(memcmp(model.triangles[i], expected[i], sizeof expected[i]) == 0);
    conic_model_release(context, &model);
  }
}

/* A writer at the other end of a pipe. */
typedef struct pipe_writer {
  const char *path;
  const char *bytes;
  size_t n;
} pipe_writer;

#if !defined(_WIN32) /* where no name is a pipe's */

static void *write_pipe(void *data) {
  const pipe_writer *writer = data;
  FILE *to = fopen(writer->path, "wb");
  CHECK(to && fwrite(writer->bytes, 1, writer->n, to) == writer->n && fclose(to) == 0);
  return NULL;
}

static conic_status read_through_pipe(const char *bytes, size_t n, conic_model *model) {
  pthread_t thread;
  pipe_writer writer = {files_path("pipe"), bytes, n};
  CHECK(mkfifo(writer.path, 0600) == 0);
  CHECK(pthread_create(&thread, NULL, write_pipe, &writer) == 0);
  conic_status status = conic_model_read(context, writer.path, NULL, model);
  pthread_join(thread, NULL);
  CHECK(unlink(writer.path) == 0);
  return status;
}

/* Many blocks and windows, of unknown size: the same as from a file. */
static void test_pipe(void) {
  enum { N_POINTS = 40000, ROW = 15 };
  static char bytes[N_POINTS * ROW + 300];
  conic_model from_file, from_pipe;
  int n = snprintf(bytes, sizeof bytes,
                   "ply\nformat binary_little_endian 1.0\nelement vertex %d\n" XYZ
                   "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n",
                   (int)N_POINTS);
  ply.encoding = LITTLE;
  for (int i = 0; i < N_POINTS; i++) {
    ply.n = 0;
    ply_add('f', i * 0.1), ply_add('f', -i), ply_add('f', 1.0 / (i + 1)), ply_add('C', i & 255),
        ply_add('C', i >> 8 & 255), ply_add('C', 3);
    memcpy(bytes + n, ply.bytes, ROW);
    n += ROW;
  }
  const char *path = files_write_bytes("big.ply", bytes, (size_t)n);
  CHECK_OK(conic_model_read(context, path, NULL, &from_file));
  CHECK_OK(read_through_pipe(bytes, (size_t)n, &from_pipe));
  CHECK(from_file.points.count == N_POINTS && from_file.points.position[1][39999] == -39999.0f);
  CHECK(ply_same_models(&from_file, &from_pipe));
  conic_model_release(context, &from_file);
  conic_model_release(context, &from_pipe);
  unlink(path);
  files_warnings = 0;
  CHECK_OK(read_through_pipe(bytes, (size_t)n - 1, &from_pipe));
  CHECK(from_pipe.points.count == N_POINTS - 1 && files_warnings == 1);
  CHECK(strstr(files_warning, "ends within vertex 39999 of 40000") && strstr(files_warning, "at byte"));
  conic_model_release(context, &from_pipe);
  /* a count that no pipe will ever fill takes no memory */
  n = snprintf(bytes, sizeof bytes,
               "ply\nformat binary_little_endian 1.0\nelement vertex 4294967294\n" XYZ "end_header\n0123456789");
  files_check_failed("pipe", read_through_pipe(bytes, (size_t)n, &from_pipe), "ends within vertex 0", "at byte",
                     (const char *)NULL);
}

#else

static void test_pipe(void) {
}

#endif

static void test_empty(void) {
  conic_model model;
  CHECK_OK(ply_read_text(ASCII "element vertex 0\n" XYZ "end_header\n", &model));
  CHECK(model.points.count == 0 && model.n_triangles == 0);
  conic_model_release(context, &model);
}

static void test_real(const char *source_folder) {
  conic_model model;
  const char *path = check_data(source_folder, "igea.ply");
  if (path) {
    CHECK_OK(conic_model_read(context, path, NULL, &model));
    CHECK(model.points.count == 134345 && model.n_triangles == 268686);
    conic_model_release(context, &model);
  }
  path = check_data(source_folder, "lion.ply");
  if (path) {
    CHECK_OK(conic_model_read(context, path, NULL, &model));
    CHECK(model.points.count == 341989 && model.n_triangles == 0);
    CHECK(conic_splats_fields(&model.points) == (CONIC_SPLATS_NORMALS | CONIC_SPLATS_COLORS));
    conic_model_release(context, &model);
  }
}

int main(int argc, char **argv) {
  context = files_context();
  test_encodings();
  test_line_ends();
  test_origin();
  test_circles();
  test_cutoff();
  test_axes_and_normals();
  test_gaussians();
  test_flat_gaussians();
  test_strips();
  test_pipe();
  test_empty();
  test_real(argc > 1 ? argv[1] : ".");
  files_end(context);
  return check_result();
}
