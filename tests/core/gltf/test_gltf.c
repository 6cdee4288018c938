/* Meshes in glTF: one square in every way of storing it, and what a file may do with it. */
#include "tests/support/files.h"
#include "tests/support/gltf_file.h"

static conic_context *context;
static mesh_file bytes;

static conic_triangles read_file(const char *name, conic_status expected) {
  conic_triangles t;
  const char *path = files_write_bytes(name, bytes.bytes, bytes.n);
  files_message[0] = files_warning[0] = 0;
  files_warnings = 0;
  conic_status status = conic_triangles_read(context, path, &t);
  if (status != expected) {
    fprintf(stderr, "%s: status %d: %s\n%.*s\n", name, (int)status, files_message, (int)bytes.n, bytes.bytes);
    check_failures++;
  }
  CHECK(unlink(path) == 0);
  return t;
}

/* --- one square in every dialect --- */

/* Corners from (0, 0) to (2, 2), as a strip has them; raw values are parts of 1, which the node doubles. */
static const double corners[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
static const double coordinates[4][2] = {{0, 0}, {1, 0}, {0, 1}, {1, 1}};
static const double normals[4][3] = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
static const double colors[4][4] = {{1, 0.2, 0, 1}, {1, 0.2, 0, 0.6}, {1, 0.2, 0, 0.6}, {1, 0.2, 0, 0.6}};
static const double list[6] = {0, 1, 2, 2, 1, 3}, strip[4] = {0, 1, 2, 3}, fan[4] = {0, 1, 3, 2};

typedef struct dialect {
  const char *name;
  gltf_storage position, coordinate, color;
  int index, mode; /* index 0: none */
  gltf_container container;
} dialect;

#define F                                                                                                              \
  { GLTF_FLOAT, 0, 0, 0 }
#define N8                                                                                                             \
  { GLTF_UINT8, 1, 0, 0 }

static const dialect dialects[] = {
    {"plain", F, F, F, GLTF_UINT16, 4, GLTF_EMBEDDED},
    {"beside", F, F, F, GLTF_UINT16, 4, GLTF_BESIDE},
    {"glb", F, F, F, GLTF_UINT16, 4, GLTF_GLB},
    {"indices of 8 bits", F, F, F, GLTF_UINT8, 4, GLTF_GLB},
    {"indices of 32 bits", F, F, F, GLTF_UINT32, 4, GLTF_EMBEDDED},
    {"strip", F, F, F, GLTF_UINT16, 5, GLTF_GLB},
    {"strip without indices", F, F, F, 0, 5, GLTF_GLB},
    {"fan", F, F, F, GLTF_UINT8, 6, GLTF_GLB},
    {"coordinates of 8 bits", F, N8, F, GLTF_UINT16, 4, GLTF_GLB},
    {"coordinates of 16 bits", F, {GLTF_UINT16, 1, 0, 0}, F, GLTF_UINT16, 4, GLTF_GLB},
    {"colours of 8 bits", F, F, N8, GLTF_UINT16, 4, GLTF_GLB},
    {"colours of 16 bits", F, F, {GLTF_UINT16, 1, 0, 0}, GLTF_UINT16, 4, GLTF_GLB},
    {"int8", {GLTF_INT8, 0, 4, 0}, {GLTF_INT8, 0, 4, 0}, F, GLTF_UINT16, 4, GLTF_GLB},
    {"uint8", {GLTF_UINT8, 0, 4, 0}, {GLTF_UINT8, 0, 0, 0}, F, GLTF_UINT16, 4, GLTF_GLB},
    {"int16", {GLTF_INT16, 0, 8, 0}, {GLTF_INT16, 0, 0, 0}, F, GLTF_UINT16, 4, GLTF_GLB},
    {"uint16", {GLTF_UINT16, 0, 8, 0}, {GLTF_UINT16, 0, 0, 0}, F, GLTF_UINT16, 4, GLTF_GLB},
    {"int8 normalized", {GLTF_INT8, 1, 4, 0}, {GLTF_INT8, 1, 0, 0}, N8, GLTF_UINT16, 4, GLTF_GLB},
    {"uint8 normalized", {GLTF_UINT8, 1, 4, 0}, N8, N8, GLTF_UINT16, 4, GLTF_EMBEDDED},
    {"int16 normalized", {GLTF_INT16, 1, 8, 0}, {GLTF_INT16, 1, 0, 0}, N8, GLTF_UINT16, 4, GLTF_BESIDE},
    {"uint16 normalized", {GLTF_UINT16, 1, 8, 0}, {GLTF_UINT16, 1, 0, 0}, N8, GLTF_UINT16, 4, GLTF_GLB},
    {"strided", {GLTF_FLOAT, 0, 32, 0}, {GLTF_FLOAT, 0, 12, 0}, {GLTF_UINT8, 1, 20, 0}, GLTF_UINT16, 4, GLTF_GLB},
    {"sparse", {GLTF_FLOAT, 0, 0, 1}, {GLTF_FLOAT, 0, 0, 1}, {GLTF_UINT8, 1, 0, 1}, GLTF_UINT16, 4, GLTF_EMBEDDED},
    {"sparse and strided", {GLTF_INT16, 1, 8, 1}, {GLTF_UINT16, 1, 8, 1}, F, GLTF_UINT8, 4, GLTF_GLB},
};

static void make_dialect(const dialect *d) {
  static gltf_file file;
  char rest[1024];
  memset(&file, 0, sizeof file);
  int position = gltf_put(&file, d->position, 3, corners[0], 4);
  int coordinate = gltf_put(&file, d->coordinate, 2, coordinates[0], 4);
  int color = gltf_put(&file, d->color, 4, colors[0], 4);
  int normal = gltf_put(&file, (gltf_storage){GLTF_INT8, 1, 4, 0}, 3, normals[0], 4);
  int index = -1;
  if (d->index)
    index = gltf_put(&file, (gltf_storage){d->index, 0, 0, 0}, 1,
                     d->mode == 4   ? list
                     : d->mode == 5 ? strip
                                    : fan,
                     d->mode == 4 ? 6 : 4);
  int n = snprintf(rest, sizeof rest,
                   "\"extensionsRequired\":[\"KHR_mesh_quantization\"],\"scenes\":[{\"nodes\":[0]}],\"nodes\":"
                   "[{\"mesh\":0,\"scale\":[2,2,2]}],\"meshes\":[{\"primitives\":[{\"mode\":%d,\"attributes\":"
                   "{\"POSITION\":%d,\"TEXCOORD_0\":%d,\"COLOR_0\":%d,\"NORMAL\":%d}",
                   d->mode, position, coordinate, color, normal);
  n += d->index ? snprintf(rest + n, sizeof rest - (size_t)n, ",\"indices\":%d", index) : 0;
  snprintf(rest + n, sizeof rest - (size_t)n, "}]}]");
  gltf_make(&bytes, &file, d->container, rest);
  if (d->container == GLTF_BESIDE)
    files_write_bytes("g.bin", file.buffer.bytes, file.buffer.n);
}

/* Every corner has what belongs to its place, and both triangles are seen from the front. */
static void check_square(const char *name, const conic_triangles *t) {
  int n_wrong = t->count != 2 || t->n_vertices != 4 || !t->normal[0] || !t->texture_coordinate[0] || !t->color[0];
  double area = 0.0;
  for (size_t i = 0; !n_wrong && i < 2; i++) {
    double p[3][2];
    for (int k = 0; k < 3; k++) {
      uint32_t v = t->corners[i][k], uv = t->texture_corners ? t->texture_corners[i][k] : v;
      uint32_t normal = t->normal_corners ? t->normal_corners[i][k] : v;
      for (int axis = 0; axis < 2; axis++) {
        p[k][axis] = (double)t->position[axis][v];
        n_wrong += p[k][axis] != 0.0 && p[k][axis] != 2.0;
      }
      n_wrong += t->position[2][v] != 0.0f || !(t->normal[2][normal] > 0.0f) || t->normal[0][normal] != 0.0f;
      n_wrong += (double)t->texture_coordinate[0][uv] != p[k][0] / 2.0;
      n_wrong += (double)t->texture_coordinate[1][uv] != 1.0 - p[k][1] / 2.0;
      n_wrong += t->color[0][v] != 1.0f || fabsf(t->color[1][v] - 0.2f) > 1e-6f || t->color[2][v] != 0.0f;
    }
    area += 0.5 * ((p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (p[1][1] - p[0][1]) * (p[2][0] - p[0][0]));
  }
  if (n_wrong || area != 4.0) {
    fprintf(stderr, "%s: %d values are wrong, of %zu triangles, area %g\n", name, n_wrong, t->count, area);
    check_failures++;
  }
}

static void test_dialects(void) {
  for (size_t i = 0; i < sizeof dialects / sizeof *dialects; i++) {
    make_dialect(&dialects[i]);
    conic_triangles t = read_file(dialects[i].container == GLTF_GLB ? "a.glb" : "a.gltf", CONIC_OK);
    check_square(dialects[i].name, &t);
    CHECK(files_warnings == 0);
    conic_triangles_release(context, &t);
    if (dialects[i].container == GLTF_BESIDE)
      CHECK(unlink(files_path("g.bin")) == 0);
  }
}

/* --- scenes of one square --- */

/* The square's places are accessor 0, its coordinates 1, its indices 2; more may follow. */
static gltf_file square;

static void begin_square(void) {
  static const gltf_storage floats = {GLTF_FLOAT, 0, 0, 0};
  memset(&square, 0, sizeof square);
  gltf_put(&square, floats, 3, corners[0], 4);
  gltf_put(&square, floats, 2, coordinates[0], 4);
  gltf_put(&square, (gltf_storage){GLTF_UINT16, 0, 0, 0}, 1, list, 6);
}

#define SQUARE "{\"attributes\":{\"POSITION\":0,\"TEXCOORD_0\":1},\"indices\":2}"
#define MESHES "\"meshes\":[{\"primitives\":[" SQUARE "]}]"

static conic_triangles read_square(const char *rest, conic_status expected) {
  gltf_make(&bytes, &square, GLTF_GLB, rest);
  return read_file("a.glb", expected);
}

/* Where the triangles are, as their box, and how many there are. */
static void check_box(const char *rest, size_t n_triangles, double x0, double y0, double z0, double x1, double y1,
                      double z1) {
  conic_triangles t = read_square(rest, CONIC_OK);
  const double wanted[2][3] = {{x0, y0, z0}, {x1, y1, z1}};
  double box[2][3];
  int n_wrong = t.count != n_triangles;
  conic_triangles_bounds(&t, box[0], box[1]);
  for (int i = 0; i < 6; i++)
    n_wrong += !(fabs(box[i / 3][i % 3] - wanted[i / 3][i % 3]) < 1e-6);
  if (n_wrong) {
    fprintf(stderr, "%s:\n%zu triangles, box %g %g %g to %g %g %g\n", rest, t.count, box[0][0], box[0][1], box[0][2],
            box[1][0], box[1][1], box[1][2]);
    check_failures++;
  }
  conic_triangles_release(context, &t);
}

static void test_nodes(void) {
  begin_square();
  check_box(MESHES ",\"nodes\":[{\"mesh\":0}]", 2, 0, 0, 0, 1, 1, 0);
  check_box(MESHES, 2, 0, 0, 0, 1, 1, 0); /* a file without nodes */
  check_box(MESHES ",\"scene\":1,\"scenes\":[{\"nodes\":[0]},{\"nodes\":[1]}],\"nodes\":[{\"mesh\":0},"
                   "{\"mesh\":0,\"translation\":[5,0,0]}]",
            2, 5, 0, 0, 6, 1, 0);
  CHECK(files_warnings == 1 && strstr(files_warning, "of its 2 scenes, number 1 is drawn"));
  check_box(MESHES ",\"scenes\":[{\"nodes\":[1]}],\"nodes\":[{\"mesh\":0},"
                   "{\"translation\":[5,0,0],\"children\":[2]},{\"mesh\":0,\"scale\":[2,3,1]}]",
            2, 5, 0, 0, 7, 3, 0);
  check_box(MESHES ",\"nodes\":[{\"mesh\":0,\"rotation\":[0,0,2,2],\"translation\":[0,0,1]}]", 2, -1, 0, 1, 0, 1, 1);
  check_box(MESHES ",\"nodes\":[{\"mesh\":0,\"matrix\":[2,0,0,0, 0,1,0,0, 0,0,1,0, 1,2,3,1]}]", 2, 1, 2, 3, 3, 3, 3);
  check_box(MESHES ",\"nodes\":[{\"mesh\":0},{\"mesh\":0,\"translation\":[9,0,0],\"extensions\":{"
                   "\"KHR_node_visibility\":{\"visible\":false}}}]",
            2, 0, 0, 0, 1, 1, 0);
  static const char alone[] = MESHES ",\"nodes\":[{\"mesh\":0}],\"scenes\":[{}]";
  conic_triangles t = read_square(alone, CONIC_ERROR_INPUT);
  CHECK(strstr(files_message, "neither faces nor points"));
  t = read_square(MESHES ",\"nodes\":[{\"children\":[1]},{\"children\":[0]}],\"scenes\":[{\"nodes\":[0]}]",
                  CONIC_ERROR_INPUT);
  CHECK(strstr(files_message, "is the child of another"));
  t = read_square(MESHES ",\"nodes\":[{\"children\":[2]},{\"children\":[2]},{\"mesh\":0}]", CONIC_ERROR_INPUT);
  CHECK(strstr(files_message, "child of two") && !t.count);
}

/* Three squares of one mesh: moved, turned by a normalized quaternion, and scaled. */
static void test_instances(void) {
  static const double moved[3][3] = {{0, 0, 0}, {4, 0, 0}, {0, 0, 9}}, scales[3][3] = {{1, 1, 1}, {1, 1, 1}, {2, 1, 1}};
  static const double turned[3][4] = {{0, 0, 0, 1}, {0, 0, 0.7071, 0.7071}, {0, 0, 0, 1}};
  begin_square();
  gltf_put(&square, (gltf_storage){GLTF_FLOAT, 0, 0, 0}, 3, moved[0], 3);
  gltf_put(&square, (gltf_storage){GLTF_INT16, 1, 0, 0}, 4, turned[0], 3);
  gltf_put(&square, (gltf_storage){GLTF_FLOAT, 0, 0, 0}, 3, scales[0], 3);
  check_box(MESHES ",\"nodes\":[{\"mesh\":0,\"translation\":[0,100,0],\"extensions\":{\"EXT_mesh_gpu_instancing\":{"
                   "\"attributes\":{\"TRANSLATION\":3,\"ROTATION\":4,\"SCALE\":5}}}}]",
            6, 0, 100, 0, 4, 101, 9);
  conic_triangles t = read_square(MESHES ",\"nodes\":[{\"mesh\":0,\"extensions\":{\"EXT_mesh_gpu_instancing\":{"
                                         "\"attributes\":{\"TRANSLATION\":3,\"SCALE\":0}}}}]",
                                  CONIC_ERROR_INPUT);
  CHECK(strstr(files_message, "SCALE of instances") && !t.count);
}

/* Morph targets by the weights of the mesh, or of the node instead. */
static void test_targets(void) {
  static const double lifted[4][3] = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
  static const double spread[4][3] = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {4, 4, 0}};
  static const char format[] = "\"meshes\":[{\"weights\":[0.5,0],\"primitives\":[{\"attributes\":{\"POSITION\":0},"
                               "\"indices\":2,\"targets\":[{\"POSITION\":3},{\"POSITION\":4}]}]}],\"nodes\":[{"
                               "\"mesh\":0%s}]";
  char rest[512];
  begin_square();
  gltf_put(&square, (gltf_storage){GLTF_FLOAT, 0, 0, 0}, 3, lifted[0], 4);
  gltf_put(&square, (gltf_storage){GLTF_FLOAT, 0, 0, 1}, 3, spread[0], 4);
  snprintf(rest, sizeof rest, format, "");
  check_box(rest, 2, 0, 0, 0.5, 1, 1, 0.5);
  snprintf(rest, sizeof rest, format, ",\"weights\":[0,0.25]");
  check_box(rest, 2, 0, 0, 0, 2, 2, 0);
}

/* A skin at rest: half of the square hangs from a joint that moves it up, whatever its own node says. */
static void test_skin(void) {
  static const double joints[4][4] = {{0, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 0, 0}, {1, 0, 0, 0}};
  static const double weights[4][4] = {{1, 0, 0, 0}, {0.2, 0.8, 0, 0}, {1, 0, 0, 0}, {1, 0, 0, 0}};
  double inverses[2][16] = {{0}};
  for (int i = 0; i < 32; i++)
    inverses[i / 16][i % 16] = i % 16 % 5 == 0;
  inverses[1][13] = -1.0; /* y */
  begin_square();
  gltf_put(&square, (gltf_storage){GLTF_UINT8, 0, 0, 0}, 4, joints[0], 4);
  gltf_put(&square, (gltf_storage){GLTF_UINT8, 1, 0, 0}, 4, weights[0], 4);
  gltf_put(&square, (gltf_storage){GLTF_FLOAT, 0, 0, 0}, 16, inverses[0], 2);
  static const char format[] =
      "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"JOINTS_0\":3,"
      "\"WEIGHTS_0\":4},\"indices\":2}]}],\"skins\":[{\"joints\":[1,2],"
      "\"inverseBindMatrices\":%d}],\"nodes\":[{\"mesh\":0,\"skin\":0,\"translation\":[50,0,0]},"
      "{\"children\":[2]},{\"translation\":[0,1,10]}],\"scenes\":[{\"nodes\":[0,1]}]";
  char rest[512];
  snprintf(rest, sizeof rest, format, 5);
  conic_triangles t = read_square(rest, CONIC_OK);
  const double wanted[4] = {0, 8, 0, 10};
  CHECK(t.n_vertices == 4);
  for (size_t i = 0; i < 4 && t.n_vertices == 4; i++) {
    CHECK_NEAR((double)t.position[2][i], wanted[i], 1e-6);
    CHECK_NEAR((double)t.position[1][i], corners[i][1], 1e-6);
    CHECK_NEAR((double)t.position[0][i], corners[i][0], 1e-6);
  }
  conic_triangles_release(context, &t);
  snprintf(rest, sizeof rest, format, 4);
  t = read_square(rest, CONIC_ERROR_INPUT);
  CHECK(strstr(files_message, "fewer matrices than joints") && !t.count);
}

/* --- materials --- */

#define MATERIAL                                                                                                       \
  "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"TEXCOORD_0\":1,\"TEXCOORD_1\":3},"                   \
  "\"indices\":2,\"material\":0}]}],\"textures\":[{\"source\":0}],\"images\":[{\"uri\":\"gone.png\"}],"                \
  "\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0%s}}}]"

/* Coordinates are offset + turn · scale · those of the file, whose v goes down. */
static void check_transform(const char *transform, const double wanted[4][2]) {
  char rest[1024];
  snprintf(rest, sizeof rest, MATERIAL, transform);
  conic_triangles t = read_square(rest, CONIC_OK);
  CHECK(files_warnings == 1 && strstr(files_warning, "gone.png is not there"));
  for (size_t i = 0; i < t.count; i++)
    for (int k = 0; k < 3; k++) {
      uint32_t uv = t.texture_corners ? t.texture_corners[i][k] : t.corners[i][k];
      const double *to = wanted[(size_t)list[3 * i + (size_t)k]];
      CHECK_NEAR((double)t.texture_coordinate[0][uv], to[0], 1e-6);
      CHECK_NEAR((double)t.texture_coordinate[1][uv], 1.0 - to[1], 1e-6);
    }
  conic_triangles_release(context, &t);
}

static void test_transforms(void) {
  static const double other[4][2] = {{0.5, 0.5}, {0.25, 0.5}, {0.5, 0.25}, {0, 0}};
  begin_square();
  gltf_put(&square, (gltf_storage){GLTF_FLOAT, 0, 0, 0}, 2, other[0], 4);
  check_transform("", coordinates);
  check_transform(",\"texCoord\":1", other);
  check_transform(",\"extensions\":{\"KHR_texture_transform\":{\"texCoord\":1}}", other);
  check_transform(",\"extensions\":{\"KHR_texture_transform\":{\"scale\":[0.25,0.5],\"offset\":[0.25,0.5]}}",
                  (const double[4][2]){{0.25, 0.5}, {0.5, 0.5}, {0.25, 1}, {0.5, 1}});
  /* a quarter turn, as the example of the extension's specification has it: the lower left quarter of the picture */
  check_transform(",\"extensions\":{\"KHR_texture_transform\":{\"offset\":[0,1],\"rotation\":1.57079632679,"
                  "\"scale\":[0.5,0.25]}}",
                  (const double[4][2]){{0, 1}, {0, 0.5}, {0.25, 1}, {0.25, 0.5}});
}

static void check_material(const char *material, const float color[3], uint32_t mode, float transparency) {
  char rest[1024];
  snprintf(rest, sizeof rest,
           "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":2%s}]}],\"materials\":[{%s}]",
           material ? ",\"material\":0" : "", material ? material : "");
  conic_triangles t = read_square(rest, CONIC_OK);
  CHECK(t.n_materials == 2);
  for (int c = 0; c < 3 && t.n_materials; c++)
    CHECK(t.materials[0].color[c] == color[c]);
  CHECK(t.n_materials && t.materials[0].alpha_mode == mode && t.materials[0].transparency == transparency);
  conic_triangles_release(context, &t);
}

static void test_materials(void) {
  static const float white[3] = {1, 1, 1}, color[3] = {0.25f, 0.5f, 1};
  begin_square();
  check_material(NULL, white, CONIC_ALPHA_OPAQUE, 0.0f);
  check_material("\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.25,0.5,1,0.5]}", color, CONIC_ALPHA_OPAQUE, 0.5f);
  check_material("\"alphaMode\":\"BLEND\",\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.25,0.5,1,0]}", color,
                 CONIC_ALPHA_BLEND, 1.0f);
  check_material("\"extensions\":{\"KHR_materials_pbrSpecularGlossiness\":{\"diffuseFactor\":[0.25,0.5,1,0.5]}}", color,
                 CONIC_ALPHA_OPAQUE, 0.5f);
  check_material("\"emissiveFactor\":[0.25,0.5,1],\"pbrMetallicRoughness\":{\"baseColorFactor\":[0,0,0,1]}", color,
                 CONIC_ALPHA_OPAQUE, 0.0f);
  CHECK(files_warnings == 0);
  check_material("\"emissiveFactor\":[1,0,0],\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.25,0.5,1,1]}", color,
                 CONIC_ALPHA_OPAQUE, 0.0f);
  CHECK(files_warnings == 1 && strstr(files_warning, "emits"));
}

/* Primitives of several materials share their vertices. */
static void test_shared(void) {
  begin_square();
  conic_triangles t = read_square("\"meshes\":[{\"primitives\":[" SQUARE "," SQUARE "," SQUARE "]}]", CONIC_OK);
  CHECK(t.count == 6 && t.n_vertices == 4 && t.n_texture_coordinates == 5);
  conic_triangles_release(context, &t);
}

/* --- extensions --- */

static void test_extensions(void) {
  static const char draco[] = MESHES ",\"extensionsRequired\":[\"KHR_texture_basisu\"]";
  begin_square();
  conic_triangles t = read_square(MESHES ",\"extensionsRequired\":[\"VENDOR_foo\"]", CONIC_ERROR_INPUT);
  CHECK(strstr(files_message, "VENDOR_foo"));
  t = read_square(draco, CONIC_ERROR_INPUT);
  CHECK(strstr(files_message, "KHR_texture_basisu") && strstr(files_message, "KTX2"));
  t = read_square(MESHES ",\"extensionsUsed\":[\"VENDOR_foo\",\"KHR_materials_ior\"]", CONIC_OK);
  CHECK(files_warnings == 1 && strstr(files_warning, "VENDOR_foo is left out"));
  conic_triangles_release(context, &t);
  bytes.n = 0;
  mesh_text(&bytes, "{\"asset\":{\"version\":\"1.0\"},\"buffers\":{},\"meshes\":{\"a\":{}}}");
  t = read_file("a.gltf", CONIC_ERROR_INPUT);
  CHECK(strstr(files_message, "this is glTF 1"));
  bytes.n = 0;
  mesh_text(&bytes, "{\"asset\":{\"version\":\"1.1\"},\"geometricError\":70,\"root\":{\"content\":{\"uri\":\"a\"}}}");
  t = read_file("a.gltf", CONIC_ERROR_INPUT);
  CHECK(strstr(files_message, "glTF 1.1") || strstr(files_message, "tileset"));
  CHECK(!t.count);
}

/* --- files beside --- */

/* What a glTF names above its folder is refused, buffer or picture, unless the context allows it. */
static void test_outside(void) {
  char folder[160], outside[200], rest[1024];
  snprintf(folder, sizeof folder, "%s", files_path("inner"));
  CHECK(mkdir(folder, 0700) == 0);
  begin_square();
  gltf_put(&square, (gltf_storage){GLTF_FLOAT, 0, 0, 0}, 2, coordinates[0], 4);
  static const char pfm[] = "PF\n1 1\n-1.0\n\0\0\0\0\0\0\0\0\0\0\0";
  snprintf(outside, sizeof outside, "%s", files_write_bytes("b.pfm", pfm, sizeof pfm));
  for (int i = 0; i < 3; i++) {
    snprintf(rest, sizeof rest, MATERIAL, "");
    char *name = strstr(rest, "gone.png"), tail[512];
    snprintf(tail, sizeof tail, "%s", name + 8);
    snprintf(name, sizeof rest - (size_t)(name - rest), "%s%s",
             i == 0   ? "../b.pfm"
             : i == 1 ? "%2e%2e/b.pfm"
                      : outside,
             tail);
    for (int allows = 0; allows < 2; allows++) {
      conic_context_options options;
      conic_context *own;
      conic_triangles t;
      conic_context_options_init(&options);
      options.log = files_log;
      options.allows_outside = allows;
      CHECK_OK(conic_context_create(&options, &own));
      gltf_make(&bytes, &square, GLTF_GLB, rest);
      const char *path = files_write_bytes("inner/a.glb", bytes.bytes, bytes.n);
      conic_status status = conic_triangles_read(own, path, &t);
      CHECK(status == (allows ? CONIC_OK : CONIC_ERROR_INPUT));
      CHECK(allows ? t.n_materials && t.materials[0].texture : strstr(files_message, "--allow-outside") != NULL);
      conic_triangles_release(own, &t);
      conic_context_destroy(own);
      CHECK(unlink(path) == 0);
    }
  }
  CHECK(unlink(outside) == 0 && rmdir(folder) == 0);
}

/* --- files of the reports --- */

static void test_reports(const char *source_folder) {
  static const struct {
    const char *name;
    double low[3], high[3];
  } files[] = {{"quant_norm16", {0, 0, 0}, {2, 2, 0}}, {"quant_u16", {5, 0, 0}, {6, 1, 0}},
               {"t_uv_u16n", {0, 0, 0}, {1, 1, 0}},    {"atlas", {0, 0, 0}, {1, 1, 0}},
               {"s15", {0, 0, 0}, {1, 1, 0}},          {"t_webp", {0, 0, 0}, {1, 1, 0}}};
  for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
    char path[1024];
    double low[3], high[3];
    conic_triangles t;
    snprintf(path, sizeof path, "%s/../shared/data/reports/scans/gltf/%s.glb", source_folder, files[i].name);
    if (access(path, R_OK) != 0) {
      fprintf(stderr, "not tried, since it is not there: %s\n", path);
      continue;
    }
    CHECK_OK(conic_triangles_read(context, path, &t));
    conic_triangles_bounds(&t, low, high);
    CHECK(t.count == 2);
    for (int axis = 0; axis < 3; axis++) {
      CHECK_NEAR(low[axis], files[i].low[axis], 1e-6);
      CHECK_NEAR(high[axis], files[i].high[axis], 1e-6);
    }
    conic_triangles_release(context, &t);
  }
}

int main(int argc, char **argv) {
  context = files_context();
  test_dialects();
  test_nodes();
  test_instances();
  test_targets();
  test_skin();
  test_transforms();
  test_materials();
  test_shared();
  test_extensions();
  test_outside();
  test_reports(argc > 1 ? argv[1] : ".");
  files_end(context);
  return check_result();
}
