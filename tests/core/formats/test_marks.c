/* A byte-order mark of UTF-8 changes nothing, whatever text it stands before; UTF-16 is called by its name. */
#include <math.h>

#include "core/formats/material_file.h"
#include "tests/support/files.h"

#define MARK "\xEF\xBB\xBF"

static conic_context *context;

static const char *write_mark(const char *name, const char *text) {
  char marked[1024];
  snprintf(marked, sizeof marked, MARK "%s", text);
  return files_write(name, marked);
}

static void test_obj(void) {
  conic_model model;
  const char *path = write_mark("a.obj", "v 1 2 3\nv 4 5 6\nv 7 8 10\nf 1 2 3\n");
  CHECK_OK(conic_model_read(context, path, NULL, &model));
  CHECK(model.points.count == 3 && model.n_triangles == 1);
  CHECK(model.points.position[0] && model.points.position[0][0] == 1.0f && model.triangles[0][2] == 2);
  conic_model_release(context, &model);
  CHECK(unlink(path) == 0);
  path = write_mark("a.unknown", "v 1 2 3\nv 4 5 6\nv 7 8 10\nf 1 2 3\n"); /* told by its content */
  CHECK_OK(conic_model_read(context, path, NULL, &model));
  CHECK(model.kind == CONIC_MODEL_OBJ && model.points.count == 3);
  conic_model_release(context, &model);
  CHECK(unlink(path) == 0);
}

static conic_status count_points(void *cookie, const conic_splats *batch) {
  *(size_t *)cookie += batch->count;
  return CONIC_OK;
}

static void test_points(void) {
  static const char *const files[][2] = {
      {"a.ply", "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
                "end_header\n1 2 3\n4 5 6\n"},
      {"a.xyz", "1 2 3\n4 5 6\n"},
      {"a.pts", "2\n1 2 3\n4 5 6\n"},
      {"a.csv", "x,y,z\n1,2,3\n4,5,6\n"},
      {"a.pcd", "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 2\nDATA ascii\n1 2 3\n4 5 6\n"}};
  for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
    conic_model model;
    size_t n = 0;
    const char *path = write_mark(files[i][0], files[i][1]);
    files_warnings = 0;
    CHECK_OK(conic_model_read(context, path, NULL, &model));
    CHECK(model.points.count == 2 && files_warnings == 0);
    CHECK(model.points.count == 2 && fabs(model.points.origin[1] + (double)model.points.position[1][1] - 5.0) < 1e-9);
    conic_model_release(context, &model);
    CHECK_OK(conic_model_stream(context, path, NULL, count_points, &n));
    CHECK(n == 2);
    CHECK(unlink(path) == 0);
  }
}

static void test_material(void) {
  static char names[] = "\0red";
  const conic_texts texts = {names, sizeof names, sizeof names, 2};
  conic_material materials[2];
  memset(materials, 0, sizeof materials);
  const char *path = write_mark("a.mtl", "newmtl red\nKd 0.5 0.25 0\n");
  CHECK_OK(conic_material_file_read(context, path, &texts, materials));
  CHECK(materials[1].color[0] == 0.5f && materials[1].color[1] == 0.25f);
  CHECK(unlink(path) == 0);
}

static void test_camera(void) {
  static const char text[] = "{\"width\": 64, \"height\": 48, \"fx\": 50, \"fy\": 50, \"cx\": 32, \"cy\": 24,\n"
                             "\"world_to_camera\": [[1,0,0,0],[0,1,0,0],[0,0,1,-3.5],[0,0,0,1]]}\n";
  conic_camera camera;
  const char *path = write_mark("a.json", text);
  CHECK_OK(conic_camera_read(context, path, &camera));
  CHECK(camera.width == 64 && camera.cam_from_world[2][3] == -3.5);
  CHECK(unlink(path) == 0);
  path = files_write_bytes("a.json", "\xFF\xFE{\0}\0", 6);
  files_check_failed("wide", conic_camera_read(context, path, &camera), "a.json: ", "UTF-16", (const char *)NULL);
  CHECK(unlink(path) == 0);
}

static void test_wide(const char *source_folder) {
  conic_model model;
  const char *path = check_data(source_folder, "foreign/assimp_box_UTF16BE.obj");
  if (path)
    files_check_failed("wide", conic_model_read(context, path, NULL, &model), "UTF-16", "iconv", (const char *)NULL);
}

int main(int argc, char **argv) {
  context = files_context();
  test_obj();
  test_points();
  test_material();
  test_camera();
  test_wide(argc > 1 ? argv[1] : ".");
  files_end(context);
  return check_result();
}
