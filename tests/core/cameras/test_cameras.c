/* Files of cameras: one camera through every door is the same to the bit; what the models mean; what is refused. */
#include <math.h>

#include "tests/support/camera_files.h"

static conic_context *context;

/* --- reading what was made here --- */

static conic_status read_bytes_as(const char *name, const void *bytes, size_t n, conic_cameras *cameras) {
  const char *path = files_write_bytes(name, bytes, n);
  conic_status status = conic_cameras_read(context, path, NULL, cameras);
  CHECK(unlink(path) == 0);
  return status;
}

static conic_status read_text_as(const char *name, const char *text, conic_cameras *cameras) {
  return read_bytes_as(name, text, strlen(text), cameras);
}

/* --- one camera --- */

static void test_doors(void) {
  conic_cameras cameras;
  conic_camera wanted = camera_example();
  camera_bytes first, second, archive = camera_npz_example();
  CHECK_OK(read_text_as("camera.json", CAMERA_JSON, &cameras));
  camera_check_read(context, &cameras, CONIC_CAMERA_FILE_CONIC, "", &wanted);
  CHECK_OK(camera_read_colmap_text(context, CAMERA_COLMAP_CAMERAS, CAMERA_COLMAP_IMAGES, &cameras));
  camera_check_read(context, &cameras, CONIC_CAMERA_FILE_COLMAP, "a/one.jpg", &wanted);
  camera_colmap_binary(1, (const double[]){50.5, 50, 31, 24.5}, 4, &first, &second);
  CHECK_OK(camera_read_colmap(context, "bin", first.bytes, first.n, second.bytes, second.n, &cameras));
  camera_check_read(context, &cameras, CONIC_CAMERA_FILE_COLMAP, "a/one.jpg", &wanted);
  CHECK_OK(read_text_as("transforms.json", CAMERA_TRANSFORMS, &cameras));
  camera_check_read(context, &cameras, CONIC_CAMERA_FILE_TRANSFORMS, "a/one.jpg", &wanted);
  CHECK_OK(read_text_as("bom.json", "\xef\xbb\xbf" CAMERA_TRANSFORMS, &cameras));
  camera_check_read(context, &cameras, CONIC_CAMERA_FILE_TRANSFORMS, "a/one.jpg", &wanted);
  CHECK_OK(read_bytes_as("any name", archive.bytes, archive.n, &cameras));
  camera_check_read(context, &cameras, CONIC_CAMERA_FILE_NUMPY, "", &wanted);
  wanted.cx = 32.0;
  wanted.cy = 24.0;
  CHECK_OK(read_text_as("cameras.json", CAMERA_LIST, &cameras));
  camera_check_read(context, &cameras, CONIC_CAMERA_FILE_LIST, "one", &wanted);
}

/* Of a rotation that is no permutation, each door is within rounding of the quaternion's. */
static void test_turned(void) {
  conic_cameras colmap, transforms;
  char text[1024];
  CHECK_OK(camera_read_colmap_text(context, CAMERA_COLMAP_CAMERAS, "1 .1 -.7 .2 .4 1 2 3 1 b c.png\n\n", &colmap));
  if (colmap.count != 1)
    return;
  const double(*m)[4] = colmap.cameras[0].cam_from_world;
  double determinant = 0.0;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      double dot = m[i][0] * m[j][0] + m[i][1] * m[j][1] + m[i][2] * m[j][2];
      CHECK(fabs(dot - (i == j)) < 1e-15);
    }
  for (int i = 0; i < 3; i++)
    determinant += m[0][i] * (m[1][(i + 1) % 3] * m[2][(i + 2) % 3] - m[1][(i + 2) % 3] * m[2][(i + 1) % 3]);
  CHECK(fabs(determinant - 1.0) < 1e-15);
  /* by the quaternion's definition: x turns to this */
  CHECK(fabs(m[0][0] - (0.01 + 0.49 - 0.04 - 0.16) / 0.7) < 1e-15);
  CHECK(fabs(m[1][0] - 2.0 * (-0.7 * 0.2 + 0.1 * 0.4) / 0.7) < 1e-15);
  CHECK(fabs(m[2][0] - 2.0 * (-0.7 * 0.4 - 0.1 * 0.2) / 0.7) < 1e-15);
  CHECK(strcmp(colmap.names[0], "b c.png") == 0); /* a name may have blanks */
  double eye[3], c[3][3];
  for (int axis = 0; axis < 3; axis++) {
    eye[axis] = -(m[0][axis] * 1.0 + m[1][axis] * 2.0 + m[2][axis] * 3.0);
    for (int i = 0; i < 3; i++)
      c[axis][i] = i ? -m[i][axis] : m[i][axis];
  }
  snprintf(text, sizeof text,
           "{\"w\": 64, \"h\": 48, \"fl_x\": 50, \"frames\": [{\"transform_matrix\": [[%.17g,%.17g,%.17g,%.17g],"
           "[%.17g,%.17g,%.17g,%.17g],[%.17g,%.17g,%.17g,%.17g]]}]}",
           c[0][0], c[0][1], c[0][2], eye[0], c[1][0], c[1][1], c[1][2], eye[1], c[2][0], c[2][1], c[2][2], eye[2]);
  CHECK_OK(read_text_as("t.json", text, &transforms));
  for (int i = 0; i < 12 && transforms.count == 1; i++)
    CHECK(fabs(transforms.cameras[0].cam_from_world[i / 4][i % 4] - m[i / 4][i % 4]) < 2e-15);
  conic_cameras_release(context, &colmap);
  conic_cameras_release(context, &transforms);
}

/* --- transforms.json --- */

static conic_camera read_frame_of(const char *numbers, const char *frame) {
  conic_cameras cameras;
  conic_camera camera = {.width = -1};
  char text[2048];
  snprintf(text, sizeof text, "{%s, \"frames\": [{\"transform_matrix\": " CAMERA_MATRIX "%s}]}", numbers, frame);
  CHECK_OK(read_text_as("t.json", text, &cameras));
  if (cameras.count == 1)
    camera = cameras.cameras[0];
  conic_cameras_release(context, &cameras);
  return camera;
}

static void test_transforms(void) {
  static const double brown[8] = {1, 2, 5, 6, 3, 0}, prism[8] = {1, 2, 5, 6, 3, 4}, radial[8] = {1, 2, 3, 4};
  conic_camera c = read_frame_of("\"w\": 64, \"h\": 48, \"fl_x\": 50, \"cx\": 1", ", \"cx\": 30, \"fl_y\": 49");
  CHECK(c.fx == 50.0 && c.fy == 49.0 && c.cx == 30.0 && c.cy == 24.0 && c.kind == 0 && c.lens == 0);
  c = read_frame_of("\"w\": 64, \"h\": 48, \"fl_x\": 50, \"k1\": 1, \"k2\": 2, \"k3\": 3, \"p1\": 5, \"p2\": 6", "");
  CHECK(c.fy == 50.0 && c.lens == CONIC_LENS_OPENCV && memcmp(c.distortion, brown, sizeof brown) == 0);
  c = read_frame_of("\"w\": 64, \"h\": 48, \"fl_x\": 50, \"k1\": 1, \"k2\": 2, \"k3\": 3, \"p1\": 5, \"p2\": 6",
                    ", \"k4\": 4");
  CHECK(c.lens == CONIC_LENS_THIN_PRISM && memcmp(c.distortion, prism, sizeof prism) == 0);
  c = read_frame_of("\"w\": 64, \"h\": 48, \"fl_x\": 50, \"k1\": 1, \"k2\": 2, \"k3\": 3, \"k4\": 4, "
                    "\"camera_model\": \"OPENCV_FISHEYE\"",
                    "");
  CHECK(c.kind == CONIC_CAMERA_FISHEYE && c.lens == CONIC_LENS_RADIAL &&
        memcmp(c.distortion, radial, sizeof radial) == 0);
  c = read_frame_of("\"w\": 64, \"h\": 48, \"fl_x\": 50, \"is_fisheye\": true", "");
  CHECK(c.kind == CONIC_CAMERA_FISHEYE && c.lens == CONIC_LENS_NONE);
  c = read_frame_of("\"w\": 64, \"h\": 32, \"fl_x\": 32, \"camera_model\": \"EQUIRECTANGULAR\"", "");
  CHECK(c.kind == CONIC_CAMERA_EQUIRECTANGULAR && fabs(c.fx * 3.14159265358979323846 - 32.0) < 1e-13 && c.fy == c.fx);
  /* half of 64 over the tangent of 45 degrees */
  c = read_frame_of("\"w\": 64, \"h\": 48, \"camera_angle_x\": 1.5707963267948966", "");
  CHECK(fabs(c.fx - 32.0) < 1e-13 && c.fy == c.fx && c.cx == 32.0 && c.cy == 24.0);
}

/* Where the file says no size: the picture's beside it, or what is asked for. */
static void test_no_size(void) {
  static const unsigned char png[24] = "\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\x40\0\0\0\x30";
  static const char text[] = "{\"camera_angle_x\": 1.5707963267948966, \"frames\": [{\"file_path\": \"./r_0\", "
                             "\"transform_matrix\": " CAMERA_MATRIX "}]}";
  conic_cameras cameras;
  conic_cameras_options options;
  conic_cameras_options_init(&options);
  files_check_failed("no size", read_text_as("t.json", text, &cameras), "t.json: ", "--size", (const char *)NULL);
  const char *path = files_write("t.json", text);
  options.width = 100;
  options.height = 80;
  CHECK_OK(conic_cameras_read(context, path, &options, &cameras));
  CHECK(cameras.count == 1 && cameras.cameras[0].width == 100 && cameras.cameras[0].height == 80 &&
        fabs(cameras.cameras[0].fx - 50.0) < 1e-13 && fabs(cameras.cameras[0].fy - 50.0) < 1e-13);
  conic_cameras_release(context, &cameras);
  const char *picture = files_write_bytes("r_0.png", png, sizeof png);
  CHECK_OK(conic_cameras_read(context, path, NULL, &cameras));
  CHECK(cameras.count == 1 && cameras.cameras[0].width == 64 && cameras.cameras[0].height == 48 &&
        fabs(cameras.cameras[0].fx - 32.0) < 1e-13);
  conic_cameras_release(context, &cameras);
  CHECK(unlink(picture) == 0 && unlink(path) == 0);
  options.height = 0;
  CHECK(conic_cameras_read(context, path, &options, &cameras) == CONIC_ERROR_ARGUMENT);
}

/* --- NumPy --- */

static conic_status read_npz(const camera_part *parts, size_t n, int size, conic_cameras *cameras) {
  conic_cameras_options options;
  conic_cameras_options_init(&options);
  options.width = options.height = size;
  camera_bytes made = camera_npz(parts, n);
  const char *path = files_write_bytes("c.npz", made.bytes, made.n);
  conic_status status = conic_cameras_read(context, path, &options, cameras);
  CHECK(unlink(path) == 0);
  return status;
}

static void test_numpy(void) {
  conic_cameras cameras;
  conic_camera wanted = camera_example();
  float narrow[32];
  double turned[24];
  static const uint16_t sizes[2] = {64, 10};
  static const uint8_t heights[1] = {48};
  for (int i = 0; i < 32; i++)
    narrow[i] = (float)camera_npz_matrix[i % 16];
  for (int i = 0; i < 24; i++) /* two of three rows, the first index running fastest */
    turned[i] = camera_npz_matrix[i / 2 % 3 * 4 + i / 6] + (i % 2 && i >= 18);
  const camera_part two[] = {{"viewmats.npy", camera_npy("<f4", "False", "(2, 4, 4)", narrow, sizeof narrow)},
                             {"Ks.npy", camera_npy("<f8", "False", "(3, 3)", camera_npz_k, sizeof camera_npz_k)},
                             {"width.npy", camera_npy("<u2", "False", "(2,)", sizes, sizeof sizes)},
                             {"height.npy", camera_npy("|u1", "False", "(1,)", heights, sizeof heights)}};
  CHECK_OK(read_npz(two, 4, 0, &cameras));
  CHECK(cameras.count == 2 && camera_is_same(&cameras.cameras[0], &wanted) && cameras.cameras[1].width == 10);
  conic_cameras_release(context, &cameras);
  static const double k[4] = {50.5, 50, 31, 24.5};
  const camera_part fortran[] = {{"viewmat.npy", camera_npy("<f8", "True", "(2, 3, 4)", turned, sizeof turned)},
                                 {"K.npy", camera_npy("<f8", "False", "(4,)", k, sizeof k)}};
  CHECK_OK(read_npz(fortran, 2, 64, &cameras));
  wanted.height = 64;
  CHECK(cameras.count == 2 && camera_is_same(&cameras.cameras[0], &wanted));
  for (int i = 0; i < 3; i++)
    wanted.cam_from_world[i][3] += 1.0;
  CHECK(cameras.count == 2 && camera_is_same(&cameras.cameras[1], &wanted));
  conic_cameras_release(context, &cameras);
  files_check_failed("no size", read_npz(fortran, 2, 0, &cameras), "c.npz: ", "--size", (const char *)NULL);
  files_check_failed("no K", read_npz(two, 1, 64, &cameras), "no Ks.npy", (const char *)NULL);
  files_check_failed("one side", read_npz(two, 3, 64, &cameras), "one of width and height", (const char *)NULL);
}

static void check_npz_fails(const char *type, const char *shape, size_t n_bytes, const char *what) {
  conic_cameras cameras;
  const camera_part parts[] = {{"viewmats.npy", camera_npy(type, "False", shape, camera_npz_matrix, n_bytes)},
                               {"Ks.npy", camera_npy("<f8", "False", "(3, 3)", camera_npz_k, sizeof camera_npz_k)}};
  files_check_failed(what, read_npz(parts, 2, 64, &cameras), "c.npz: ", what, (const char *)NULL);
}

static void test_numpy_wrong(void) {
  check_npz_fails("<f8", "(2, 8)", 128, "is of the shape (n, 4, 4)");
  check_npz_fails("<f8", "(0, 4, 4)", 0, "is of the shape (n, 4, 4)");
  check_npz_fails("<f8", "(1, 1, 1, 1, 1, 1, 1, 4, 4)", 128, "no shape");
  check_npz_fails("<f8", "(4, 4)", 120, "not as long");
  check_npz_fails("<f8", "(99999999999999999999, 4, 4)", 120, "no shape");
  check_npz_fails(">f8", "(4, 4)", 128, "little-endian");
  check_npz_fails("<c8", "(4, 4)", 128, "little-endian");
  check_npz_fails("<f4", "(2, 4, 4)", 128, "last row"); /* of the bytes of doubles */
}

/* --- glTF --- */

static void test_gltf(void) {
  conic_cameras cameras;
  conic_camera wanted = camera_example();
  CHECK_OK(read_text_as("c.gltf", CAMERA_GLTF, &cameras));
  CHECK(cameras.count == 2 && cameras.kind == CONIC_CAMERA_FILE_GLTF);
  if (cameras.count == 2) {
    const conic_camera *c = cameras.cameras;
    CHECK(c->width == 1536 && c->height == 1024 && fabs(c->fx - 512.0) < 1e-10 && c->fy == c->fx && c->cx == 768.0);
    CHECK(memcmp(c->cam_from_world, wanted.cam_from_world, sizeof c->cam_from_world) == 0);
    CHECK(c[1].kind == CONIC_CAMERA_ORTHOGRAPHIC && c[1].width == 2048 && c[1].fx == 512.0 && c[1].fy == 512.0);
    CHECK(c[1].cam_from_world[1][1] == -1.0 && c[1].cam_from_world[2][2] == -1.0 && c[1].cam_from_world[2][3] == -0.5);
    CHECK(strcmp(cameras.names[1], "two") == 0);
  }
  conic_cameras_release(context, &cameras);
  camera_bytes glb = {.n = 0};
  camera_put(&glb, "glTF\2\0\0\0\0\0\0\0", 12);
  camera_put_word(&glb, strlen(CAMERA_GLTF), 4);
  camera_put_text(&glb, "JSON" CAMERA_GLTF);
  CHECK_OK(read_bytes_as("c.glb", glb.bytes, glb.n, &cameras));
  CHECK(cameras.count == 2);
  conic_cameras_release(context, &cameras);
  files_check_failed("cut", read_bytes_as("c.glb", glb.bytes, glb.n - 1, &cameras), "c.glb: ", (const char *)NULL);
}

/* --- what is chosen --- */

static void check_found(const conic_cameras *cameras, const char *name, size_t wanted) {
  size_t i_camera;
  if (conic_cameras_find(context, cameras, name, &i_camera) != CONIC_OK || i_camera != wanted) {
    fprintf(stderr, "the view %s is not %zu\n", name, wanted);
    check_failures++;
  }
}

static void test_find(void) {
  conic_cameras cameras;
  size_t i_camera;
  CHECK_OK(camera_read_colmap_text(
      context, "1 SIMPLE_PINHOLE 10 20 5 1 2\n",
      "1 1 0 0 0 0 0 0 1 a/0002.png\n\n2 1 0 0 0 0 0 0 1 a/x.png\n\n3 1 0 0 0 0 0 0 1 b/x.jpg\n\n"
      "4 1 0 0 0 0 0 0 1 c/77.jpg\n\n",
      &cameras));
  check_found(&cameras, "0", 0);
  check_found(&cameras, "2", 2);
  check_found(&cameras, "0002", 0); /* a name, as its zeros tell */
  check_found(&cameras, "0002.png", 0);
  check_found(&cameras, "a/x.png", 1);
  check_found(&cameras, "x.jpg", 2);
  check_found(&cameras, "77", 3); /* no index here */
  CHECK(conic_cameras_find(context, &cameras, "x", &i_camera) == CONIC_ERROR_ARGUMENT);
  CHECK(strstr(files_message, "2 views are called x"));
  CHECK(conic_cameras_find(context, &cameras, "4", &i_camera) == CONIC_ERROR_ARGUMENT);
  CHECK(strstr(files_message, "there is no view 4; there are 4, from a/0002.png to c/77.jpg"));
  CHECK(conic_cameras_find(context, &cameras, "", &i_camera) == CONIC_ERROR_ARGUMENT);
  conic_cameras_release(context, &cameras);
}

static void test_resize(void) {
  conic_camera camera = camera_example(), same = camera;
  conic_camera_resize(&camera, 64, 48);
  CHECK(camera_is_same(&camera, &same));
  conic_camera_resize(&camera, 32, 96);
  CHECK(camera.fx == 25.25 && camera.cx == 15.5 && camera.fy == 100.0 && camera.cy == 49.0);
}

/* --- what is refused --- */

static void check_text_fails(const char *text, const char *what) {
  conic_cameras cameras = {.count = 7};
  files_check_failed(text, read_text_as("c.json", text, &cameras), "c.json: ", what, (const char *)NULL);
  CHECK(cameras.count == 0);
}

static void test_wrong_json(void) {
  check_text_fails("[]", "object is expected");
  check_text_fails("[{\"rotation\": [[1,0,0],[0,1,0]]}]", "3 rows of 3");
  check_text_fails("[{\"rotation\": [[1,0,0],[0,1,0],[0,0,1]], \"position\": [1, 2]}]", "3 numbers");
  check_text_fails("[{\"rotation\": [[1,0,0],[0,1,0],[0,0,1]], \"position\": [1, 2, 3], \"fx\": 1, \"width\": 1.5, "
                   "\"height\": 3}]",
                   "whole numbers");
  check_text_fails("[{\"rotation\": [[1,0,0],[0,1,0],[0,0,-1]], \"position\": [1, 2, 3], \"fx\": 1, \"width\": 5, "
                   "\"height\": 3}]",
                   "the camera's cam_from_world mirrors (line 1)");
  check_text_fails("{\"frames\": []}", "no frames");
  check_text_fails("{\"frames\": [{}]}", "transform_matrix");
  check_text_fails("{\"frames\": [{\"transform_matrix\": [[1,0,0,0],[0,1,0,0]]}]}", "3 or 4 rows");
  check_text_fails("{\"frames\": [{\"transform_matrix\": [[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,2]]}]}", "3 or 4 rows");
  check_text_fails("{\"frames\": [{\"transform_matrix\": [[1,0,0,0],[0,1,0,0],[0,0,1,1e40]]}], \"w\": 3, \"h\": 4, "
                   "\"fl_x\": 5}",
                   "out of range");
  check_text_fails("{\"frames\": [{\"transform_matrix\": [[1,0,0,0],[0,1,0,0],[0,0,1,0]]}], \"w\": 3, \"h\": 4}",
                   "focal lengths");
  check_text_fails("{\"frames\": [{\"transform_matrix\": [[1,0,0,0],[0,1,0,0],[0,0,1,0]]}], \"w\": 3, \"h\": 0}",
                   "1 to 65535");
  check_text_fails("{\"frames\": [], \"camera_model\": \"FISHEYE624\"}", "camera_model is not read");
  check_text_fails("{\"asset\": {}, \"nodes\": [{}]}", "no cameras");
  check_text_fails("{\"asset\": {}, \"nodes\": [{\"camera\": 0}]}", "is not there");
  check_text_fails("{\"asset\": {}, \"nodes\": [{\"camera\": 0, \"children\": [0]}], \"cameras\": [{}]}", "too deeply");
  check_text_fails("{\"asset\": {}, \"nodes\": [{\"children\": [1]}, {\"children\": [1]}]}", "the child of two");
  check_text_fails("{\"asset\": {}, \"nodes\": [{\"camera\": 0, \"rotation\": [0,0,0,0]}], \"cameras\": [{}]}",
                   "rotation");
  check_text_fails("{\"asset\": {}, \"nodes\": [{\"camera\": 0}], \"cameras\": [{\"perspective\": {\"yfov\": 4}}]}",
                   "focal lengths");
}

static void test_kinds(void) {
  static const struct {
    const char *name, *text;
    int is_cameras;
  } files[] = {{"a.json", CAMERA_TRANSFORMS, 1}, {"b.json", CAMERA_LIST, 1}, {"c.json", CAMERA_JSON, 1},
               {"d.json", CAMERA_GLTF, 0},       {"e.json", "{}", 0},        {"f.txt", CAMERA_JSON, 0}};
  for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
    const char *path = files_write(files[i].name, files[i].text);
    CHECK(conic_cameras_is_file(context, path) == files[i].is_cameras);
    CHECK(unlink(path) == 0);
  }
  CHECK(!conic_cameras_is_file(context, files_folder));
  CHECK(files_message[0] == 0);
  for (int i = 0; i < CONIC_N_CAMERA_FILES; i++)
    CHECK(conic_camera_file_name((conic_camera_file)i));
  CHECK(!conic_camera_file_name(CONIC_N_CAMERA_FILES));
}

/* conic's own file can say what is no pinhole. */
static void test_own_lens(void) {
  conic_cameras cameras;
  conic_camera wanted = camera_example();
  wanted.kind = CONIC_CAMERA_FISHEYE;
  wanted.lens = CONIC_LENS_RADIAL;
  wanted.distortion[1] = 0.25;
  CHECK_OK(read_text_as("c.json",
                        "{\"kind\": \"fisheye\", \"lens\": \"radial\", \"distortion\": [0, 0.25], \"width\": 64, "
                        "\"height\": 48, \"fx\": 50.5, \"fy\": 50, \"cx\": 31, \"cy\": 24.5, "
                        "\"world_to_camera\": [[0,0,1,0.5],[1,0,0,-2],[0,1,0,3],[0,0,0,1]]}",
                        &cameras));
  camera_check_read(context, &cameras, CONIC_CAMERA_FILE_CONIC, "", &wanted);
  check_text_fails("{\"kind\": \"wide\"}", "kind is perspective");
  check_text_fails("{\"lens\": \"wide\"}", "lens is none");
  check_text_fails("{\"distortion\": [1,2,3,4,5,6,7,8,9]}", "at most 8");
}

int main(void) {
  context = files_context();
  test_doors();
  test_turned();
  test_transforms();
  test_no_size();
  test_numpy();
  test_numpy_wrong();
  test_gltf();
  files_message[0] = 0;
  test_kinds();
  test_find();
  test_resize();
  test_wrong_json();
  test_own_lens();
  files_end(context);
  return check_result();
}
