/* The camera file reader against hand-made files. */
#include "tests/support/files.h"

static conic_context *context;

#define MATRIX "[[1,0,0,0.5],[0,-1,0,-2],[0,0,-1,3e0],[0,0,0,1]]"
#define SIZES "\"width\": 640,\n\"height\": 4.8e2,\n\"fx\": 500.5, \"fy\": 501,\n\"cx\": -1, \"cy\": 240"

static conic_status read_text(const char *text, conic_camera *camera) {
  const char *path = files_write("camera.json", text);
  conic_status status = conic_camera_read(context, path, camera);
  CHECK(unlink(path) == 0);
  return status;
}

static void check_fails(const char *text, const char *what, const char *where) {
  conic_camera camera = {.width = -7};
  files_check_failed(text, read_text(text, &camera), "camera.json: ", what, where, (const char *)NULL);
  CHECK(camera.width == -7); /* left alone */
}

static void test_good(void) {
  conic_camera camera;
  CHECK_OK(read_text("{" SIZES
                     ",\n \"name\": \"a \\\"\\u0041\\n\", \"lists\": [1, [], {}, {\"a\": [true, false, null]}],"
                     "\"world_to_camera\": " MATRIX "}\r\n",
                     &camera));
  CHECK(camera.width == 640 && camera.height == 480 && camera.fx == 500.5 && camera.fy == 501.0);
  CHECK(camera.cx == -1.0 && camera.cy == 240.0);
  CHECK(camera.cam_from_world[0][3] == 0.5 && camera.cam_from_world[1][1] == -1.0 &&
        camera.cam_from_world[2][3] == 3.0);
}

static void test_bad_values(void) {
  check_fails("{\"width\": 0}", "whole numbers", "line 1");
  check_fails("{\n\"height\": 65536}", "whole numbers", "line 2");
  check_fails("{\n\"width\": 1.5}", "whole numbers", "line 2");
  check_fails("{\"fx\":\n\n0}", "above 0", "line 3");
  check_fails("{\"fy\": -1}", "above 0", "line 1");
  check_fails("{\"cx\": 1e999}", "too large", "line 1");
  check_fails("{\"cx\": nan}", "number is expected", "line 1");
  check_fails("{\"cx\": \"1\"}", "number is expected", "line 1");
  check_fails("{\"cx\": 1,\n\"cx\": 1}", "twice", "line 2");
  check_fails("{" SIZES "}", "lacks world_to_camera", "line 4");
  check_fails("{\"world_to_camera\": " MATRIX ", \"height\": 1}", "lacks width", "line 1");
}

static void test_bad_matrices(void) {
  check_fails("{\"world_to_camera\": [[1,0,0,0],[0,1,0,0],[0,0,1,0]]}", "4 rows of 4", "line 1");
  check_fails("{\"world_to_camera\": [[1,0,0,0],[0,1,0],[0,0,1,0],[0,0,0,1]]}", "4 rows of 4", "line 1");
  check_fails("{\"world_to_camera\": [[1,0,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]}", "4 rows of 4", "line 1");
  check_fails("{\"world_to_camera\": [[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1],[0]]}", "4 rows of 4", "line 1");
  check_fails("{\"world_to_camera\": [1,0,0,0]}", "array is expected", "line 1");
  check_fails("{\"world_to_camera\": [[1,0,0,0],[0,1,0,0],\n[0,0,1,0],[0,0,1,1]]}", "last row", "line 2");
  check_fails("{\"world_to_camera\": [[1,0,0,0],[0,1.01,0,0],[0,0,1,0],[0,0,0,1]]}", "orthonormal", "line 1");
  check_fails("{\"world_to_camera\": [[1,0,0,0],[0.1,1,0,0],[0,0,1,0],[0,0,0,1]]}", "orthonormal", "line 1");
  check_fails("{\"world_to_camera\": [[1,0,0,0],[0,1,0,0],[0,0,-1,0],[0,0,0,1]]}", "mirrors", "line 1");
}

static void test_bad_json(void) {
  char deep[400];
  static const char *const texts[] = {"",
                                      "[]",
                                      "{",
                                      "{\"a\"}",
                                      "{\"a\": }",
                                      "{\"a\": 1",
                                      "{\"a\": 1,}",
                                      "{a: 1}",
                                      "{\"a\": 01}",
                                      "{\"a\": 1.}",
                                      "{\"a\": .5}",
                                      "{\"a\": +1}",
                                      "{\"a\": 1e}",
                                      "{\"a\": tru}",
                                      "{\"a\": \"",
                                      "{\"a\": \"\\x\"}",
                                      "{\"a\": \"\\u12g4\"}",
                                      "{\"a\": [1 2]}",
                                      "{\"a\": \"\n\"}",
                                      "{\"a\": 1 \"b\": 2}"};
  for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
    check_fails(texts[i], "", "line 1");
  check_fails("{" SIZES ", \"world_to_camera\": " MATRIX "} x", "follows", "line 4");
  memset(deep, '[', sizeof deep - 1);
  deep[sizeof deep - 1] = 0;
  memcpy(deep, "{\"a\":", 5);
  check_fails(deep, "too deeply", "line 1");
}

static void test_sample(const char *source_folder) {
  char path[4096];
  conic_camera camera;
  snprintf(path, sizeof path, "%s/../shared/bench/camera.json", source_folder);
  if (access(path, R_OK) != 0) {
    fprintf(stderr, "skipped: %s is not there\n", path);
    return;
  }
  CHECK_OK(conic_camera_read(context, path, &camera));
  CHECK(camera.width == 1024 && camera.fx == 1406.708438760767 && camera.cam_from_world[2][3] == 3.2);
}

int main(int argc, char **argv) {
  context = files_context();
  test_good();
  test_bad_values();
  test_bad_matrices();
  test_bad_json();
  test_sample(argc > 1 ? argv[1] : ".");
  conic_camera camera;
  files_check_failed("absent", conic_camera_read(context, files_path("no.json"), &camera), "cannot read",
                     (const char *)NULL);
  files_end(context);
  return check_result();
}
