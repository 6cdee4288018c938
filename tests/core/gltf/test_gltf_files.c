/* glTF files as programs write them: pictures within and beside, alpha, mirrors, far places, points. */
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

int main(void) {
  context = files_context();
  test_embedded_texture();
  test_alpha_modes();
  test_files_beside();
  test_mirrored();
  test_origin();
  test_points();
  files_end(context);
  return check_result();
}
