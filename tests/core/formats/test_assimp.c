/* What is read through Assimp: the same mesh as a file of every kind is the same triangles and the same picture as that
 * of an OBJ. */
#include "tests/support/files.h"
#include "tests/support/mesh_file.h"

static conic_context *context;
static const char one_node[] = "{\"mesh\":0}";

static conic_triangles read_triangles(const char *name, const void *bytes, size_t n, conic_status expected) {
  conic_triangles t;
  const char *path = files_write_bytes(name, bytes, n);
  conic_status status = conic_triangles_read(context, path, &t);
  if (status != expected) {
    fprintf(stderr, "%s: status %d: %s\n", name, (int)status, files_message);
    check_failures++;
  }
  CHECK(unlink(path) == 0);
  return t;
}

/* The corners' places, which are compared whatever their order in the file's list was. */
static void check_same_mesh(const char *name, const conic_triangles *t, const conic_triangles *obj, int is_turned,
                            float scale, float shift) {
  int n_wrong = t->count != obj->count || t->n_vertices != obj->n_vertices;
  for (size_t i = 0; !n_wrong && i < t->count; i++)
    for (int k = 0; k < 3; k++) {
      uint32_t own = t->corners[i][k], other = obj->corners[i][k];
      float x = obj->position[0][other], y = obj->position[1][other], z = obj->position[2][other];
      n_wrong += t->position[0][own] != scale * x + shift;
      n_wrong += t->position[1][own] != scale * (is_turned ? z : y);
      n_wrong += t->position[2][own] != scale * (is_turned ? -y : z);
    }
  if (n_wrong) {
    fprintf(stderr, "%s: %zu triangles, %zu vertices, %d places differ\n", name, t->count, t->n_vertices, n_wrong);
    check_failures++;
  }
}

/* The picture's bits, seen by the camera that frames `like`. */
static uint64_t draw(const conic_triangles *t, const conic_triangles *like) {
  conic_camera camera;
  conic_framing framing;
  conic_renderer *renderer;
  conic_render_options options;
  conic_image image;
  double low[3], high[3];
  const conic_drawing drawing = {.triangles = t};
  conic_framing_init(&framing);
  framing.width = framing.height = 64;
  conic_render_options_init(&options);
  conic_triangles_bounds(like, low, high);
  memset(&image, 0, sizeof image);
  CHECK_OK(conic_camera_frame(context, &framing, low, high, &camera));
  CHECK_OK(conic_renderer_create(context, &renderer));
  CHECK_OK(conic_image_allocate(context, 64, 64, 1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_Z, &image));
  CHECK_OK(conic_render_drawing(context, renderer, &drawing, &camera, &options, 1, &image, NULL));
  uint64_t hash = conic_image_hash(&image, CONIC_PLANE_RGBA) ^ conic_image_hash(&image, CONIC_PLANE_Z);
  conic_image_release(context, &image);
  conic_renderer_destroy(renderer);
  return hash;
}

static void test_kinds(void) {
  static mesh_file file;
  file.n = 0;
  mesh_obj(&file);
  conic_triangles obj = read_triangles("a.obj", file.bytes, file.n, CONIC_OK);
  uint64_t picture = draw(&obj, &obj);
  for (int i = 0; i < MESH_N_KINDS; i++) {
    const mesh_kind *kind = &mesh_kinds[i];
    int is_moved = strcmp(kind->ending, "glb") == 0;
    char name[16];
    file.n = 0;
    kind->make(&file);
    snprintf(name, sizeof name, "a.%s", kind->ending);
    conic_triangles t = read_triangles(name, file.bytes, file.n, CONIC_OK);
    check_same_mesh(name, &t, &obj, kind->is_turned, is_moved ? 2.0f : 1.0f, is_moved ? 10.0f : 0.0f);
    if (!kind->is_turned && !is_moved && draw(&t, &obj) != picture && !t.normal[0]) {
      fprintf(stderr, "%s: another picture than that of the OBJ\n", name);
      check_failures++;
    }
    conic_triangles_release(context, &t);
    conic_model model; /* by its content alone */
    const char *path = files_write_bytes("a", file.bytes, file.n);
    CHECK_OK(conic_model_read(context, path, NULL, &model));
    CHECK(strcmp(conic_model_kind_name(model.kind), kind->ending) == 0);
    CHECK(model.points.count == 4 && model.n_triangles == 4);
    CHECK(memcmp(model.up, kind->up, sizeof model.up) == 0);
    conic_model_release(context, &model);
    CHECK(unlink(path) == 0);
  }
  conic_triangles_release(context, &obj);
}

/* A texture's colour where a corner of the triangles is. */
static void check_texel(const conic_triangles *t, size_t i, int k, const float expected[3]) {
  static const float nothing[2] = {0, 0};
  const uint32_t *corners = t->texture_corners ? t->texture_corners[i] : t->corners[i];
  float uv[2], color[3];
  for (int c = 0; c < 2; c++)
    uv[c] = 0.25f + 0.5f * t->texture_coordinate[c][corners[k]]; /* the middle of one of four */
  conic_texture_sample(t->materials[t->material[i]].texture, uv, nothing, nothing, color);
  for (int c = 0; c < 3; c++)
    CHECK_NEAR(color[c], expected[c], 1e-6);
}

/* Colour and picture of a GLB: row 0 of the picture is where v is 1 for an OBJ. */
static void test_embedded_texture(void) {
  static mesh_file file;
  file.n = 0;
  mesh_glb(&file);
  conic_triangles t = read_triangles("a.glb", file.bytes, file.n, CONIC_OK);
  CHECK(t.n_materials == 2 && t.material[0] == 0);
  CHECK(t.materials[0].color[0] == 0.5f && t.materials[0].color[1] == 1.0f && t.materials[0].color[2] == 0.25f);
  if (t.materials[0].texture) {
    static const png_kind picture = {.width = 2, .height = 2, .kind = PNG_COLOR, .depth = 8};
    float codes[256];
    for (int code = 0; code < 256; code++)
      codes[code] = (float)(code <= 10 ? code / 255.0 / 12.92 : pow((code / 255.0 + 0.055) / 1.055, 2.4));
    for (size_t i = 0; i < t.count; i++)
      for (int k = 0; k < 3; k++) {
        int corner = mesh_faces[i][k];
        float expected[3];
        for (int c = 0; c < 3; c++)
          expected[c] = codes[png_sample(&picture, corner & 1, (uint32_t)corner >> 1, c)];
        check_texel(&t, i, k, expected);
      }
  } else
    fprintf(stderr, "skipped: this build reads no PNG\n");
  conic_triangles_release(context, &t);
}

/* Of glTF's modes, alpha counts in BLEND and MASK alone. */
static void test_alpha_modes(void) {
  static const struct {
    const char *json;
    uint32_t mode;
    float cutoff;
  } modes[] = {{"", CONIC_ALPHA_OPAQUE, 0.5f},
               {"},\"alphaMode\":\"BLEND\",\"extras\":{", CONIC_ALPHA_BLEND, 0.5f},
               {"},\"alphaMode\":\"MASK\",\"alphaCutoff\":0.75,\"extras\":{", CONIC_ALPHA_MASK, 0.75f}};
  static mesh_file file;
  for (size_t i = 0; i < sizeof modes / sizeof *modes; i++) {
    char material[200];
    snprintf(material, sizeof material, "\"baseColorFactor\":[1,1,1,0.25]%s", modes[i].json);
    file.n = 0;
    mesh_gltf_json(&file, "", one_node, material, "", 0);
    conic_triangles t = read_triangles("a.gltf", file.bytes, file.n, CONIC_OK);
    CHECK(t.materials && t.materials[0].alpha_mode == modes[i].mode);
    CHECK(t.materials && t.materials[0].transparency == 0.75f && t.materials[0].alpha_cutoff == modes[i].cutoff);
    conic_triangles_release(context, &t);
  }
}

static const char *write_pfm(const char *name) {
  static const float texels[12] = {0, 0, 0, 1, 1, 1, 0.5f, 0.25f, 0.125f, 1, 0, 0};
  char pfm[64 + sizeof texels];
  int n = snprintf(pfm, sizeof pfm, "PF\n2 2\n-1.0\n");
  memcpy(pfm + n, texels, sizeof texels);
  return files_write_bytes(name, pfm, (size_t)n + sizeof texels);
}

/* A glTF whose buffer and picture are files beside it, where they are found whatever the folder that it names. */
static void test_files_beside(void) {
  static const float black[3] = {0, 0, 0};
  static const char base[] = "\"baseColorTexture\":{\"index\":0}";
  static mesh_file file, buffer;
  char bin[160], picture[160];
  file.n = buffer.n = 0;
  mesh_buffer(&buffer);
  snprintf(bin, sizeof bin, "%s", files_write_bytes("b.bin", buffer.bytes, buffer.n));
  snprintf(picture, sizeof picture, "%s", write_pfm("a b.pfm"));
  mesh_gltf_json(&file, ",\"uri\":\"b.bin\"", one_node, base, "{\"uri\":\"elsewhere/a%20b.pfm\"}", 0);
  conic_triangles t = read_triangles("a.gltf", file.bytes, file.n, CONIC_OK);
  CHECK(t.count == 4 && t.n_materials == 2 && t.materials[0].texture);
  if (t.materials[0].texture)
    check_texel(&t, 0, 1, black); /* corner 2, (0, 1) from the top: the picture's first row is its lowest */
  conic_triangles_release(context, &t);
  CHECK(unlink(picture) == 0);
  files_warnings = 0;
  t = read_triangles("a.gltf", file.bytes, file.n, CONIC_OK); /* without it */
  CHECK(files_warnings == 1 && strstr(files_warning, "a%20b.pfm") && strstr(files_warning, "a.gltf"));
  CHECK(t.n_materials == 2 && !t.materials[0].texture);
  conic_triangles_release(context, &t);
  files_write("a b.pfm", "PF\n2 2\n-1.0\n");
  t = read_triangles("a.gltf", file.bytes, file.n, CONIC_OK); /* with one that is spoiled */
  CHECK(files_warnings == 2 && strstr(files_warning, "a b.pfm") && strstr(files_warning, "left out"));
  conic_triangles_release(context, &t);
  CHECK(unlink(picture) == 0);
  CHECK(unlink(bin) == 0);
  t = read_triangles("a.gltf", file.bytes, file.n, CONIC_ERROR_INPUT);
  CHECK(strstr(files_message, "a.gltf: cannot read: "));
  file.n = 0; /* what lies above the folder is not for the file to read */
  char above[200];
  snprintf(above, sizeof above, ",\"uri\":\"../%s/b.bin\"", strrchr(files_folder, '/') + 1);
  snprintf(bin, sizeof bin, "%s", files_write_bytes("b.bin", buffer.bytes, buffer.n));
  mesh_gltf_json(&file, above, one_node, "", "", 0);
  t = read_triangles("a.gltf", file.bytes, file.n, CONIC_ERROR_INPUT);
  CHECK(unlink(bin) == 0);
  files_message[0] = 0;
}

/* Where a node mirrors, faces are still seen from outside. */
static void test_mirrored(void) {
  static mesh_file file;
  file.n = 0;
  mesh_gltf_json(&file, "", "{\"mesh\":0,\"scale\":[-1,1,1]}", "", "", 0);
  conic_triangles t = read_triangles("a.gltf", file.bytes, file.n, CONIC_OK);
  CHECK(t.count == 4);
  double volume = 0.0;
  for (size_t i = 0; i < t.count; i++) {
    const uint32_t *c = t.corners[i];
    double p[3][3];
    for (int k = 0; k < 3; k++)
      for (int axis = 0; axis < 3; axis++)
        p[k][axis] = (double)t.position[axis][c[k]];
    for (int axis = 0; axis < 3; axis++)
      volume +=
          p[0][axis] * (p[1][(axis + 1) % 3] * p[2][(axis + 2) % 3] - p[1][(axis + 2) % 3] * p[2][(axis + 1) % 3]);
  }
  CHECK_NEAR(volume, 3.0 * 2.0 * 1.0, 1e-5);
  conic_triangles_release(context, &t);
}

/* Far from zero, the first corner is the origin. */
static void test_origin(void) {
  static mesh_file file;
  conic_model model;
  file.n = 0;
  mesh_gltf_json(&file, "", "{\"mesh\":0,\"translation\":[4000000,0,0]}", "", "", 0);
  const char *path = files_write_bytes("a.gltf", file.bytes, file.n);
  CHECK_OK(conic_model_read(context, path, NULL, &model));
  CHECK(model.points.origin[0] == 4000000.0 && model.points.position[0][0] == 0.0f);
  conic_model_release(context, &model);
  CHECK(unlink(path) == 0);
}

/* Points, with colours that are linear floats, and alpha where it is asked for. */
static void test_points(void) {
  static mesh_file file, buffer;
  static const float colors[4][4] = {{0.25f, 0.5f, 1, 0.5f}, {0, 0, 0, 1}, {1, 1, 1, 0}, {0.125f, 0, 0, 0.25f}};
  conic_read_options options;
  conic_model model;
  file.n = buffer.n = 0;
  mesh_put(&buffer, mesh_corners, sizeof mesh_corners);
  mesh_put(&buffer, colors, sizeof colors);
  mesh_text(&file,
            "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],"
            "\"meshes\":[{\"primitives\":[{\"mode\":0,\"attributes\":{\"POSITION\":0,\"COLOR_0\":1}}]}],"
            "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\",\"min\":[0,0,0],"
            "\"max\":[3,2,1]},{\"bufferView\":1,\"componentType\":5126,\"count\":4,\"type\":\"VEC4\"}],"
            "\"bufferViews\":[{\"buffer\":0,\"byteLength\":48},{\"buffer\":0,\"byteOffset\":48,\"byteLength\":64}],"
            "\"buffers\":[{\"byteLength\":112,\"uri\":\"data:application/octet-stream;base64,");
  mesh_base64(&file, buffer.bytes, buffer.n);
  mesh_text(&file, "\"}]}");
  const char *path = files_write_bytes("a.gltf", file.bytes, file.n);
  conic_read_options_init(&options);
  for (int keeps_alpha = 0; keeps_alpha < 2; keeps_alpha++) {
    options.keeps_alpha = keeps_alpha;
    CHECK_OK(conic_model_read(context, path, &options, &model));
    CHECK(model.points.count == 4 && model.n_triangles == 0 && model.points.color[0]);
    CHECK((model.points.opacity != NULL) == keeps_alpha);
    for (size_t i = 0; model.points.color[0] && i < 4; i++)
      for (int c = 0; c < 3; c++)
        CHECK(model.points.color[c][i] == colors[i][c] && model.points.position[c][i] == mesh_corners[i][c]);
    for (size_t i = 0; model.points.opacity && i < 4; i++)
      CHECK(model.points.opacity[i] == colors[i][3]);
    conic_model_release(context, &model);
  }
  CHECK(unlink(path) == 0);
}

/* Colours of other files are sRGB codes; faces of two colours share no point. */
static void test_colors(void) {
  static const char text[] =
      "<?xml version=\"1.0\"?><amf><object id=\"0\"><mesh><vertices>"
      "<vertex><coordinates><x>0</x><y>0</y><z>0</z></coordinates><color><r>1</r><g>0</g><b>0.2</b></color></vertex>"
      "<vertex><coordinates><x>1</x><y>0</y><z>0</z></coordinates></vertex>"
      "<vertex><coordinates><x>0</x><y>1</y><z>0</z></coordinates></vertex></vertices><volume>"
      "<triangle><v1>0</v1><v2>1</v2><v3>2</v3></triangle></volume></mesh></object></amf>";
  conic_model model;
  const char *path = files_write("a.amf", text);
  CHECK_OK(conic_model_read(context, path, NULL, &model));
  CHECK(model.points.count == 3 && model.points.color[0]);
  if (model.points.color[0])
    CHECK(model.points.color[0][0] == 1.0f && model.points.color[1][0] == 0.0f &&
          model.points.color[2][0] == (float)0.033104766570885055); /* code 51 */
  conic_model_release(context, &model);
  CHECK(unlink(path) == 0);
}

static void check_refused(const char *name, const void *bytes, size_t n, const char *what) {
  conic_model model;
  const char *path = files_write_bytes(name, bytes, n);
  files_check_failed(name, conic_model_read(context, path, NULL, &model), name, what, (const char *)NULL);
  CHECK(unlink(path) == 0);
}

/* Where Assimp fails, or does not come back, it is one line of error. */
static void test_refused(void) {
  static const char huge[] = "OFF\n4 2000000000 0\n0 0 0\n1 0 0\n";
  static const char nothing[] = "{\"asset\":{\"version\":\"2.0\"}}";
  static mesh_file file;
  check_refused("a.off", huge, sizeof huge - 1, "ends before its");
  check_refused("a.stl", "\0\0\0", 3, "ends within the header");
  check_refused("a.fbx", "rubbish", 7, "cannot read: ");
  check_refused("a.gltf", nothing, sizeof nothing - 1, "a.gltf: ");
  file.n = 0;
  mesh_glb(&file);
  for (size_t i = 0; i + sizeof mesh_faces <= file.n; i++)
    if (memcmp(file.bytes + i, mesh_faces, sizeof mesh_faces) == 0)
      file.bytes[i] = 4;
  check_refused("a.glb", file.bytes, file.n, "index is out of range");
  for (int i = 0; i < MESH_N_KINDS; i++) { /* none of these is whole when its second half is missing */
    file.n = 0;
    mesh_kinds[i].make(&file);
    conic_model model;
    char name[16];
    snprintf(name, sizeof name, "a.%s", mesh_kinds[i].ending);
    const char *path = files_write_bytes(name, file.bytes, file.n / 2);
    conic_status status = conic_model_read(context, path, NULL, &model);
    CHECK(status == CONIC_OK || (status == CONIC_ERROR_INPUT && strstr(files_message, name)));
    conic_model_release(context, &model);
    CHECK(unlink(path) == 0);
  }
  files_message[0] = 0;
}

int main(void) {
  int has_assimp = 0;
  for (int i = 0; conic_feature_at(i); i++)
    has_assimp |= strcmp(conic_feature_at(i)->name, "Assimp") == 0 && conic_feature_at(i)->available;
  if (!has_assimp) {
    fprintf(stderr, "skipped: this build is without Assimp\n");
    return 77;
  }
  context = files_context();
  test_kinds();
  test_embedded_texture();
  test_alpha_modes();
  test_files_beside();
  test_mirrored();
  test_origin();
  test_points();
  test_colors();
  test_refused();
  files_end(context);
  return check_result();
}
