/* What is read through Assimp: the same mesh as a file of every kind is the same triangles and the same picture as that
 * of an OBJ. */
#include "tests/support/files.h"
#include "tests/support/mesh_file.h"

static conic_context *context;

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

/* A file that another one names is read from its folder, and not from above. */
static void test_inlined(void) {
  static const char format[] = "<?xml version=\"1.0\"?><X3D version=\"3.0\"><Scene>%s<Shape><IndexedFaceSet "
                               "coordIndex=\"0 1 2 -1\"><Coordinate point=\"0 0 0 %d 0 0 0 1 0\"/></IndexedFaceSet>"
                               "</Shape></Scene></X3D>";
  char text[1024], inner[200], path[200];
  snprintf(text, sizeof text, format, "", 1);
  snprintf(path, sizeof path, "%s", files_write("b.x3d", text));
  for (int is_above = 0; is_above < 2; is_above++) {
    snprintf(inner, sizeof inner, "<Inline url=\"%s%s%sb.x3d\"/>", is_above ? "../" : "",
             is_above ? strrchr(files_folder, '/') + 1 : "", is_above ? "/" : "");
    snprintf(text, sizeof text, format, inner, 5);
    conic_model model;
    const char *outer = files_write("a.x3d", text);
    conic_status status = conic_model_read(context, outer, NULL, &model);
    CHECK(is_above ? status != CONIC_OK || model.n_triangles == 1 : status == CONIC_OK && model.n_triangles == 2);
    conic_model_release(context, &model);
    CHECK(unlink(outer) == 0);
  }
  CHECK(unlink(path) == 0);
  files_message[0] = 0;
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
  check_refused("a.glb", file.bytes, file.n, "is out of range");
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
  test_colors();
  test_inlined();
  test_refused();
  files_end(context);
  return check_result();
}
