/* The PLY reader against hand-made files of every variant. */
#include <pthread.h>
#include <stdint.h>

#include "core/color.h"
#include "tests/files.h"

static conic_context *context;

/* A file that is put together in one of the three encodings. */
typedef enum encoding { TEXT, LITTLE, BIG, N_ENCODINGS } encoding;

typedef struct ply_file {
  encoding encoding;
  char bytes[1 << 16];
  size_t n;
} ply_file;

static ply_file file;

static void add_text(const char *text) {
  memcpy(file.bytes + file.n, text, strlen(text));
  file.n += strlen(text);
}

static void begin(encoding kind, const char *header) {
  static const char *const names[] = {"ascii", "binary_little_endian", "binary_big_endian"};
  file.n = 0;
  file.encoding = kind;
  add_text("ply\nformat ");
  add_text(names[kind]);
  add_text(" 1.0\n");
  add_text(header);
  add_text("end_header\n");
}

static void add_bits(uint64_t bits, int n_bytes) {
  for (int i = 0; i < n_bytes; i++)
    file.bytes[file.n++] = (char)(bits >> 8 * (file.encoding == BIG ? n_bytes - 1 - i : i));
}

/* Letters: c C s S i I (signed and unsigned of 1, 2, 4 bytes), f, d. */
static void add(char type, double value) {
  char text[40];
  uint64_t bits = 0;
  uint32_t half;
  float small = (float)value;
  if (file.encoding == TEXT) {
    snprintf(text, sizeof text, type == 'd' ? "%.17g " : type == 'f' ? "%.9g " : "%.0f ", value);
    add_text(text);
    return;
  }
  memcpy(&half, &small, sizeof half);
  if (type == 'd')
    memcpy(&bits, &value, sizeof bits);
  else
    bits = type == 'f' ? half : (uint64_t)(int64_t)value;
  add_bits(bits, type == 'd' ? 8 : strchr("iIf", type) ? 4 : strchr("sS", type) ? 2 : 1);
}

static void end_row(void) {
  if (file.encoding == TEXT)
    add_text("\n");
}

static conic_status read_file(conic_model *model) {
  const char *path = files_write_bytes("a.ply", file.bytes, file.n);
  conic_status status = conic_model_read(context, path, NULL, model);
  CHECK(unlink(path) == 0);
  if (status != CONIC_OK)
    CHECK(model->points.count == 0 && !model->points.position[0] && !model->triangles && model->n_triangles == 0);
  return status;
}

static conic_status read_text(const char *text, conic_model *model) {
  file.n = 0;
  add_text(text);
  return read_file(model);
}

static int same_arrays(float *const a[3], float *const b[3], size_t count) {
  for (int axis = 0; axis < 3; axis++)
    if (!a[axis] != !b[axis] || (a[axis] && memcmp(a[axis], b[axis], count * sizeof(float)) != 0))
      return 0;
  return 1;
}

static int same_models(const conic_model *a, const conic_model *b) {
  const conic_splats *p = &a->points, *q = &b->points;
  return p->count == q->count && a->n_triangles == b->n_triangles && conic_splats_fields(p) == conic_splats_fields(q) &&
         memcmp(p->origin, q->origin, sizeof p->origin) == 0 && same_arrays(p->position, q->position, p->count) &&
         same_arrays(p->tangent_u, q->tangent_u, p->count) && same_arrays(p->tangent_v, q->tangent_v, p->count) &&
         same_arrays(p->normal, q->normal, p->count) && same_arrays(p->color, q->color, p->count) &&
         (!p->opacity || memcmp(p->opacity, q->opacity, p->count * sizeof(float)) == 0) &&
         (!a->n_triangles || memcmp(a->triangles, b->triangles, a->n_triangles * sizeof *a->triangles) == 0);
}

/* Every type, any order, lists in the vertices and elsewhere, unknown elements before, between and behind. */
static void put_mixture(encoding kind, int has_vertex_list) {
  begin(kind, has_vertex_list ? "comment a comment\nobj_info an info\nelement camera 1\nproperty float view_px\n"
                                "property list uchar double knots\nelement vertex 3\nproperty uchar blue\n"
                                "property list short ushort extra\nproperty float z\nproperty int8 flag\n"
                                "property float y\nproperty uint8 green\nproperty float32 x\nproperty uint32 stamp\n"
                                "property uchar red\nproperty double time\nproperty int16 a\nproperty uint16 b\n"
                                "element nothing 0\nproperty float q\nelement empty 7\nelement face 2\n"
                                "property uchar f\nproperty list uchar int vertex_indices\n"
                                "property list int8 float64 t\nelement edge 1\nproperty int vertex1\n"
                              : "element camera 1\nproperty float view_px\nproperty list uchar double knots\n"
                                "element vertex 3\nproperty uchar blue\nproperty float z\nproperty int8 flag\n"
                                "property float y\nproperty uint8 green\nproperty float32 x\nproperty uint32 stamp\n"
                                "property uchar red\nproperty double time\nproperty int16 a\nproperty uint16 b\n"
                                "element nothing 0\nproperty float q\nelement empty 7\nelement face 2\n"
                                "property uchar f\nproperty list uchar int vertex_indices\n"
                                "property list int8 float64 t\nelement edge 1\nproperty int vertex1\n");
  add('f', 0.1);
  add('C', 2), add('d', 0.2), add('d', -1e300);
  end_row();
  for (int i = 0; i < 3; i++) {
    add('C', 10 * i);
    if (has_vertex_list) {
      add('s', i);
      for (int k = 0; k < i; k++)
        add('S', 65535);
    }
    add('f', 0.3 + i), add('c', -128), add('f', 0.2 + i), add('C', 100 + i), add('f', 1e-3 / (i + 1));
    add('I', 4294967295.0), add('C', 255), add('d', 0.1), add('s', -32768), add('S', 65535);
    end_row();
  }
  for (int i = 0; i < 2; i++) {
    add('C', 7), add('C', 3 + i);
    for (int k = 0; k < 3 + i; k++)
      add('i', k % 3);
    add('c', 1), add('d', 0.5);
    end_row();
  }
  add('i', -5);
  end_row();
}

static void test_encodings(void) {
  float table[256];
  conic_srgb_decode_table(table);
  for (int has_list = 0; has_list < 2; has_list++) {
    conic_model models[N_ENCODINGS];
    for (int kind = TEXT; kind < N_ENCODINGS; kind++) {
      put_mixture((encoding)kind, has_list);
      CHECK_OK(read_file(&models[kind]));
    }
    const conic_splats *points = &models[0].points;
    CHECK(points->count == 3 && models[0].n_triangles == 3);
    CHECK(points->position[0][1] == (float)(1e-3 / 2) && points->position[1][2] == 2.2f && points->origin[0] == 0.0);
    CHECK(points->position[2][0] == 0.3f);
    CHECK(conic_splats_fields(points) == CONIC_SPLATS_COLORS);
    CHECK(points->color[0][1] == 1.0f && points->color[1][1] == table[101] && points->color[2][1] == table[10]);
    CHECK(models[0].triangles[2][0] == 0 && models[0].triangles[2][1] == 2 && models[0].triangles[2][2] == 0);
    CHECK(same_models(&models[TEXT], &models[LITTLE]) && same_models(&models[TEXT], &models[BIG]));
    for (int kind = TEXT; kind < N_ENCODINGS; kind++)
      conic_model_release(context, &models[kind]);
  }
}

static void test_line_ends(void) {
  conic_model with, without;
  char long_comment[5000];
  CHECK_OK(read_text("ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
                     "end_header\n1 2 3\n4 5 -6e0\n",
                     &without));
  CHECK_OK(read_text("ply\r\nformat ascii 1.0\r\ncomment  \r\n\r\nelement vertex 2\r\nproperty float x\r\n"
                     "property float\ty \r\n property float z\r\nend_header\r\n\r\n1 2\t3 \r\n\n 4  +5 -6\r\n",
                     &with));
  CHECK(same_models(&with, &without) && with.points.position[2][1] == -6.0f);
  conic_model_release(context, &with);
  CHECK_OK(read_text("ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
                     "end_header\n1 2 3\n4 5 -6",
                     &with)); /* no line end at the end of the file */
  CHECK(same_models(&with, &without));
  conic_model_release(context, &with);
  memset(long_comment, 'a', sizeof long_comment);
  file.n = 0;
  add_text("ply\r\nformat binary_little_endian 1.0\r\ncomment ");
  memcpy(file.bytes + file.n, long_comment, sizeof long_comment);
  file.n += sizeof long_comment;
  add_text("\r\nelement vertex 2\r\nproperty float x\r\nproperty float y\r\nproperty float z\r\nend_header\r\n");
  file.encoding = LITTLE;
  for (int i = 1; i <= 6; i++)
    add('f', i == 6 ? -6 : i);
  CHECK_OK(read_file(&with));
  CHECK(same_models(&with, &without));
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
      begin((encoding)kind, header);
      for (int i = 0; i < 3; i++) {
        add(type ? 'i' : 'd', type ? 20000001 + i : 4500000.1 + i);
        add('d', i == 0 ? (double)NAN : 5e6 + 0.125 * i);
        add('f', 7.5);
        end_row();
      }
      CHECK_OK(read_file(&model));
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
  begin(LITTLE, "element vertex 13\nproperty float x\nproperty float y\nproperty float z\nproperty float radius\n"
                "property double nx\nproperty double ny\nproperty double nz\nproperty float opacity\n");
  for (int i = 0; i < N + 4; i++) {
    double scale = i == N ? 0.0 : i == N + 1 ? (double)NAN : 3.0; /* normals of any length */
    const double *normal = normals[i < N ? i : 0];
    add('f', i), add('f', 0), add('f', 0), add('f', i == N + 2 ? 0.0 : i == N + 3 ? (double)NAN : 0.75);
    add('d', scale * normal[0]), add('d', scale * normal[1]), add('d', scale * normal[2]), add('f', 0.5);
  }
  CHECK_OK(read_file(&model));
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
  CHECK_OK(read_text("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
                     "property float tv_x\nproperty float tv_y\nproperty float tv_z\nproperty float tu_x\n"
                     "property float tu_y\nproperty float tu_z\nproperty float nx\nproperty float ny\n"
                     "property float nz\nproperty float radius\nproperty float r\nproperty float g\nproperty float b\n"
                     "end_header\n0 0 0 1 2 3 4 5 6 0 0 1 9 0.25 2 -1\n",
                     &model));
  CHECK(conic_splats_fields(&model.points) == (CONIC_SPLATS_TANGENTS | CONIC_SPLATS_COLORS));
  CHECK(model.points.tangent_u[2][0] == 6.0f && model.points.tangent_v[0][0] == 1.0f);
  CHECK(model.points.color[0][0] == 0.25f && model.points.color[1][0] == 2.0f && model.points.color[2][0] == -1.0f);
  conic_model_release(context, &model);
  CHECK_OK(read_text("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
                     "property float nx\nproperty float ny\nproperty float nz\nproperty uchar diffuse_red\n"
                     "property uchar diffuse_green\nproperty uchar diffuse_blue\nproperty uchar alpha\n"
                     "property float opacity\nend_header\n0 nan -inf 0 0 2 255 0 255 9 0.5\n",
                     &model));
  CHECK(conic_splats_fields(&model.points) == (CONIC_SPLATS_NORMALS | CONIC_SPLATS_COLORS));
  CHECK(model.points.normal[2][0] == 2.0f && isnan(model.points.position[1][0]));
  CHECK(model.points.color[0][0] == 1.0f && model.points.color[1][0] == 0.0f);
  conic_model_release(context, &model);
  CHECK_OK(
      read_text("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
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
  begin(LITTLE, "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\n"
                "property float ny\nproperty float nz\nproperty float f_dc_0\nproperty float f_dc_1\n"
                "property float f_dc_2\nproperty float f_rest_0\nproperty float opacity\nproperty float scale_0\n"
                "property float scale_1\nproperty float scale_2\n" GAUSSIAN_ROTATION);
  /* thin along its own x, turned by 90° around z: the normal is world y */
  const double scales[3][3] = {{-5, -1, 0.5}, {-5, -1, 0.5}, {1, 2, -3}};
  const double rotations[3][4] = {{h, 0, 0, h}, {0, 0, 0, 0}, {7, 0, 0, 0}};
  for (int i = 0; i < 3; i++) {
    for (int k = 0; k < 6; k++)
      add('f', 0);
    add('f', 0), add('f', -5), add('f', 1), add('f', 99), add('f', i == 1 ? -2.0 : 0.0);
    for (int k = 0; k < 3; k++)
      add('f', scales[i][k]);
    for (int k = 0; k < 4; k++)
      add('f', rotations[i][k]);
  }
  CHECK_OK(read_file(&model));
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
  CHECK_OK(read_text("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
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
    begin((encoding)kind, "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
                          "element tristrips 1\nproperty list int int vertex_indices\n");
    for (int i = 0; i < 4; i++) {
      add('f', i), add('f', 0), add('f', 0);
      end_row();
    }
    add('i', 15);
    for (int i = 0; i < 15; i++)
      add('i', strip[i]);
    end_row();
    CHECK_OK(read_file(&model));
    CHECK(model.n_triangles == 4);
    for (size_t i = 0; i < 4 && i < model.n_triangles; i++)
      CHECK(memcmp(model.triangles[i], expected[i], sizeof expected[i]) == 0);
    conic_model_release(context, &model);
  }
}

#define XYZ "property float x\nproperty float y\nproperty float z\n"
#define ASCII "ply\nformat ascii 1.0\n"

static void check_fails(const char *text, const char *what, const char *where) {
  conic_model model;
  files_check_failed(text, read_text(text, &model), "a.ply: ", what, where, (const char *)NULL);
}

static void test_wrong_headers(void) {
  check_fails("ply", "does not begin", "byte 0");
  check_fails("PLY\nformat", "does not begin", "byte 0");
  check_fails("ply\n", "ends within the header", "line 2");
  check_fails("ply\nformat ascii 1.0\nelement vertex 1\n", "ends within the header", "line 4");
  check_fails("ply\nformat ascii 1.1\n", "unknown PLY version '1.1'", "line 2");
  check_fails("ply\nformat binary 1.0\n", "unknown PLY encoding 'binary'", "line 2");
  check_fails("ply\nformat ascii\n", "a format line is", "line 2");
  check_fails("ply\nelement vertex 0\n" XYZ "end_header\n", "no format line", "line 6");
  check_fails(ASCII "format ascii 1.0\n", "cannot begin with 'format'", "line 3");
  check_fails(ASCII "elements vertex 1\n", "cannot begin with 'elements'", "line 3");
  check_fails(ASCII "element vertex -1\n", "an element line is", "line 3");
  check_fails(ASCII "element vertex 99999999999999999999999\n", "an element line is", "line 3");
  check_fails(ASCII "element vertex 1 2\n", "an element line is", "line 3");
  check_fails(ASCII "element a 1\nelement a 1\n", "a second element 'a'", "line 4");
  check_fails(ASCII "property float x\n", "before any element", "line 3");
  check_fails(ASCII "element vertex 1\nproperty float64x x\n", "unknown type 'float64x'", "line 4");
  check_fails(ASCII "element vertex 1\nproperty list uchar int128 x\n", "unknown type 'int128'", "line 4");
  check_fails(ASCII "element vertex 1\nproperty list float int x\n", "length of a list", "line 4");
  check_fails(ASCII "element vertex 1\nproperty float\n", "a property line is", "line 4");
  check_fails(ASCII "element vertex 1\nproperty float x\nproperty float y\nend_header\n0 0\n", "lack x, y or z",
              "line 3");
  check_fails(ASCII "element vertex 4\nend_header\n", "lack x, y or z", "line 3");
  check_fails(ASCII "element vertex 4\nelement face 4\nend_header\n", "lack x, y or z", "line 3");
  check_fails(ASCII "element point 1\n" XYZ "end_header\n0 0 0\n", "no element 'vertex'", "line 7");
  check_fails(ASCII "element vertex 4294967295\n" XYZ "end_header\n0 0 0\n", "too many", "line 3");
  check_fails(ASCII "element vertex 4000000000\n" XYZ "end_header\n0 0 0\n", "too short for the 4000000000", "line 3");
  check_fails(ASCII "element vertex 1\n" XYZ "element face 1\nproperty list uchar float vertex_indices\n"
                    "end_header\n0 0 0\n3 0 0 0\n",
              "no list of integers", "line 7");
}

static void test_wrong_text(void) {
  static const char vertices[] = ASCII "element vertex 2\n" XYZ "end_header\n";
  static const char faces[] = ASCII "element vertex 3\n" XYZ "element face 2\nproperty list char int vertex_index\n"
                                    "end_header\n0 0 0\n1 0 0\n0 1 0\n";
  static const struct {
    const char *header, *body, *what, *where;
  } wrong[] = {
      {vertices, "1 2 3\n4 5 x\n", "vertex 1: a value is not a number", "line 9"},
      {vertices, "1 2 3\n4 5 6a\n", "a value is not a number", "line 9"},
      {vertices, "1 2 3\n4 5      \n", "fewer values", "line 9"},
      {vertices, "1 2 3\n4 5   ", "ends within vertex 1 of 2", "line 9"},
      {vertices, "1 2 3 4\n5 6\n", "more values", "line 8"},
      {vertices, "1 2 3      \n\n\n", "ends within vertex 1 of 2", "line 11"},
      {faces, "3 0 1 2\n3 0 1 3\n", "vertex index 3, but there are only 3", "line 14"},
      {faces, "3 0 1 2\n3 0 1 -1\n", "index is negative", "line 14"},
      {faces, "3 0 1 2\n-3 0 1 2\n", "negative length", "line 14"},
      {faces, "3 0 1 2\n3 0 1 2.5\n", "not an integer", "line 14"},
      {faces, "3 0 1 2\n128 0 1 2\n", "not an integer", "line 14"},
      {faces, "3 0 1 2\n99 0 1 2\n", "past the end", "line 14"},
      {faces, "3 0 1 2\n", "face 1 of 2", "line 14"},
      {faces, "3 0 1 2\n3 0 1 nan\n", "not an integer", "line 14"},
  };
  for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
    char text[1000];
    snprintf(text, sizeof text, "%s%s", wrong[i].header, wrong[i].body);
    check_fails(text, wrong[i].what, wrong[i].where);
  }
}

static void check_binary_fails(const char *what) {
  conic_model model;
  files_check_failed(what, read_file(&model), "a.ply: ", what, "at byte", (const char *)NULL);
}

static void test_wrong_binary(void) {
  static const char faces[] = "element vertex 3\n" XYZ "element face 1\nproperty list int uint vertex_indices\n";
  static const double lists[][5] = {
      {3, 0, 1, 2, 0}, {3, 0, 1, 3, 0}, {-1, 0, 1, 2, 0}, {2147483647, 0, 1, 2, 0}, {6, 0, 1, 2, 0}};
  static const char *const messages[] = {NULL, "vertex index 3", "negative length", "runs past the end",
                                         "runs past the end"};
  for (int kind = LITTLE; kind < N_ENCODINGS; kind++) {
    for (int i = 0; i < 5; i++) {
      conic_model model;
      begin((encoding)kind, faces);
      for (int k = 0; k < 9; k++)
        add('f', k);
      for (int k = 0; k < 4; k++)
        add('i', lists[i][k]);
      if (messages[i])
        check_binary_fails(messages[i]);
      else {
        CHECK_OK(read_file(&model));
        conic_model_release(context, &model);
        file.n--;
        check_binary_fails("past the end");
      }
    }
    begin((encoding)kind, "element vertex 3\n" XYZ);
    for (int k = 0; k < 8; k++)
      add('f', k);
    check_binary_fails("too short for the 3 rows");
    begin((encoding)kind, "element vertex 4294967294\n" XYZ);
    check_binary_fails("too short for the 4294967294 rows");
    begin((encoding)kind, "element other 9000000000000000000\nproperty double a\nelement vertex 0\n" XYZ);
    check_binary_fails("too short for the 9000000000000000000 rows");
  }
}

/* Every proper beginning of a good file fails cleanly, and says where. */
static void test_truncations(void) {
  for (int kind = TEXT; kind < N_ENCODINGS; kind++) {
    put_mixture((encoding)kind, 1);
    size_t whole = file.n - (kind == TEXT ? 3 : 0); /* an ascii number may lose digits, blanks and the line end */
    for (size_t n = 4; n < whole; n++) {
      conic_model model;
      put_mixture((encoding)kind, 1);
      file.n = n;
      conic_status status = read_file(&model);
      files_check_failed("truncated", status, "a.ply: ", (const char *)NULL);
      if (status == CONIC_OK)
        conic_model_release(context, &model);
    }
  }
}

/* Any byte may be any other: the file is read or refused, and nothing else happens (the sanitizers see to that). */
static void test_mutations(void) {
  uint32_t state = 1;
  for (int i = 0; i < 6000; i++) {
    conic_model model;
    put_mixture((encoding)(i % N_ENCODINGS), i & 1);
    for (int k = 0; k <= i % 4; k++) {
      state = state * 1664525u + 1013904223u;
      size_t position = 4 + (state >> 8) % (file.n - 4);
      state = state * 1664525u + 1013904223u;
      file.bytes[position] = (char)(k & 1 ? '0' + (state >> 24) % 10 : state >> 24);
    }
    conic_status status = read_file(&model);
    CHECK(status == CONIC_OK || status == CONIC_ERROR_INPUT);
    for (size_t t = 0; t < model.n_triangles; t++)
      for (int corner = 0; corner < 3; corner++)
        CHECK(model.triangles[t][corner] < model.points.count);
    conic_model_release(context, &model);
  }
}

/* An allocator whose n-th call fails, and which counts what has not been released. */
typedef struct failing_allocator {
  int n_left, n_open;
} failing_allocator;

static void *allocate_or_fail(void *cookie, size_t bytes) {
  failing_allocator *allocator = cookie;
  if (allocator->n_left-- == 0)
    return NULL;
  allocator->n_open++;
  return malloc(bytes);
}

static void release(void *cookie, void *pointer) {
  failing_allocator *allocator = cookie;
  allocator->n_open -= pointer != NULL;
  free(pointer);
}

static void test_no_memory(void) {
  failing_allocator allocator = {1 << 30, 0};
  conic_context_options options;
  conic_context *poor;
  conic_context_options_init(&options);
  options.allocate = allocate_or_fail;
  options.release = release;
  options.allocator_cookie = &allocator;
  options.threads = 1;
  CHECK_OK(conic_context_create(&options, &poor));
  put_mixture(TEXT, 1);
  const char *path = files_write_bytes("a.ply", file.bytes, file.n);
  int n_open = allocator.n_open, n_failed = 0;
  for (conic_status status = CONIC_ERROR_MEMORY; status != CONIC_OK && n_failed < 1000; n_failed++) {
    conic_model model;
    allocator.n_left = n_failed;
    status = conic_model_read(poor, path, NULL, &model);
    CHECK(status == CONIC_OK || (status == CONIC_ERROR_MEMORY && !model.points.position[0] && !model.triangles));
    conic_model_release(poor, &model);
    CHECK(allocator.n_open == n_open);
  }
  CHECK(n_failed > 8 && n_failed < 1000);
  allocator.n_left = 1 << 30;
  conic_context_destroy(poor);
  CHECK(allocator.n_open == 0);
  unlink(path);
}

/* A writer at the other end of a pipe. */
typedef struct pipe_writer {
  const char *path;
  const char *bytes;
  size_t n;
} pipe_writer;

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
  file.encoding = LITTLE;
  for (int i = 0; i < N_POINTS; i++) {
    file.n = 0;
    add('f', i * 0.1), add('f', -i), add('f', 1.0 / (i + 1)), add('C', i & 255), add('C', i >> 8 & 255), add('C', 3);
    memcpy(bytes + n, file.bytes, ROW);
    n += ROW;
  }
  const char *path = files_write_bytes("big.ply", bytes, (size_t)n);
  CHECK_OK(conic_model_read(context, path, NULL, &from_file));
  CHECK_OK(read_through_pipe(bytes, (size_t)n, &from_pipe));
  CHECK(from_file.points.count == N_POINTS && from_file.points.position[1][39999] == -39999.0f);
  CHECK(same_models(&from_file, &from_pipe));
  conic_model_release(context, &from_file);
  conic_model_release(context, &from_pipe);
  unlink(path);
  files_check_failed("pipe", read_through_pipe(bytes, (size_t)n - 1, &from_pipe), "ends within vertex 39999 of 40000",
                     "at byte", (const char *)NULL);
  /* a count that no pipe will ever fill takes no memory */
  n = snprintf(bytes, sizeof bytes,
               "ply\nformat binary_little_endian 1.0\nelement vertex 4294967294\n" XYZ "end_header\n0123456789");
  files_check_failed("pipe", read_through_pipe(bytes, (size_t)n, &from_pipe), "ends within vertex 0", "at byte",
                     (const char *)NULL);
}

static void test_empty(void) {
  conic_model model;
  CHECK_OK(read_text(ASCII "element vertex 0\n" XYZ "end_header\n", &model));
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
  test_wrong_headers();
  test_wrong_text();
  test_wrong_binary();
  test_truncations();
  test_mutations();
  test_no_memory();
  test_pipe();
  test_empty();
  test_real(argc > 1 ? argv[1] : ".");
  files_end(context);
  return check_result();
}
