/* COLMAP's files of cameras: what the models mean, in which folders they are found, and what is refused. */
#include <math.h>

#include "tests/support/camera_files.h"

static conic_context *context;

static void test_models(void) {
  static const struct {
    const char *name;
    uint64_t number;
    const char *text;
    double parameters[12];
    size_t n;
    double fy, cy;
    uint32_t kind, lens;
    double distortion[8];
  } models[] = {
      {"SIMPLE_PINHOLE", 0, "50 31 24", {50, 31, 24}, 3, 50, 24, CONIC_CAMERA_PERSPECTIVE, CONIC_LENS_NONE, {0}},
      {"PINHOLE", 1, "50 49 31 24", {50, 49, 31, 24}, 4, 49, 24, CONIC_CAMERA_PERSPECTIVE, CONIC_LENS_NONE, {0}},
      {"SIMPLE_RADIAL",
       2,
       "50 31 24 .1",
       {50, 31, 24, .1},
       4,
       50,
       24,
       CONIC_CAMERA_PERSPECTIVE,
       CONIC_LENS_RADIAL,
       {.1}},
      {"RADIAL",
       3,
       "50 31 24 .1 .2",
       {50, 31, 24, .1, .2},
       5,
       50,
       24,
       CONIC_CAMERA_PERSPECTIVE,
       CONIC_LENS_RADIAL,
       {.1, .2}},
      {"OPENCV",
       4,
       "50 49 31 24 .1 .2 .3 .4",
       {50, 49, 31, 24, .1, .2, .3, .4},
       8,
       49,
       24,
       CONIC_CAMERA_PERSPECTIVE,
       CONIC_LENS_OPENCV,
       {.1, .2, .3, .4}},
      {"OPENCV",
       4,
       "50 49 31 24 0 0 0 -0",
       {50, 49, 31, 24},
       8,
       49,
       24,
       CONIC_CAMERA_PERSPECTIVE,
       CONIC_LENS_NONE,
       {0}},
      {"OPENCV_FISHEYE",
       5,
       "50 49 31 24 .1 .2 .3 .4",
       {50, 49, 31, 24, .1, .2, .3, .4},
       8,
       49,
       24,
       CONIC_CAMERA_FISHEYE,
       CONIC_LENS_RADIAL,
       {.1, .2, .3, .4}},
      {"FULL_OPENCV",
       6,
       "50 49 31 24 1 2 3 4 5 6 7 8",
       {50, 49, 31, 24, 1, 2, 3, 4, 5, 6, 7, 8},
       12,
       49,
       24,
       CONIC_CAMERA_PERSPECTIVE,
       CONIC_LENS_OPENCV,
       {1, 2, 3, 4, 5, 6, 7, 8}},
      {"FOV", 7, "50 49 31 24 .9", {50, 49, 31, 24, .9}, 5, 49, 24, CONIC_CAMERA_PERSPECTIVE, CONIC_LENS_FOV, {.9}},
      {"SIMPLE_RADIAL_FISHEYE",
       8,
       "50 31 24 .1",
       {50, 31, 24, .1},
       4,
       50,
       24,
       CONIC_CAMERA_FISHEYE,
       CONIC_LENS_RADIAL,
       {.1}},
      {"RADIAL_FISHEYE",
       9,
       "50 31 24 .1 .2",
       {50, 31, 24, .1, .2},
       5,
       50,
       24,
       CONIC_CAMERA_FISHEYE,
       CONIC_LENS_RADIAL,
       {.1, .2}},
      {"THIN_PRISM_FISHEYE",
       10,
       "50 49 31 24 1 2 3 4 5 6 7 8",
       {50, 49, 31, 24, 1, 2, 3, 4, 5, 6, 7, 8},
       12,
       49,
       24,
       CONIC_CAMERA_FISHEYE,
       CONIC_LENS_THIN_PRISM,
       {1, 2, 3, 4, 5, 6, 7, 8}},
      {"SIMPLE_DIVISION",
       12,
       "50 31 24 -.1",
       {50, 31, 24, -.1},
       4,
       50,
       24,
       CONIC_CAMERA_PERSPECTIVE,
       CONIC_LENS_DIVISION,
       {-.1}},
      {"DIVISION",
       13,
       "50 49 31 24 .1",
       {50, 49, 31, 24, .1},
       5,
       49,
       24,
       CONIC_CAMERA_PERSPECTIVE,
       CONIC_LENS_DIVISION,
       {.1}},
      {"EUCM",
       16,
       "50 49 31 24 .5 1.5",
       {50, 49, 31, 24, .5, 1.5},
       6,
       49,
       24,
       CONIC_CAMERA_PERSPECTIVE,
       CONIC_LENS_EUCM,
       {.5, 1.5}},
      {"SIMPLE_FISHEYE", 14, "50 31 24", {50, 31, 24}, 3, 50, 24, CONIC_CAMERA_FISHEYE, CONIC_LENS_NONE, {0}},
      {"FISHEYE", 15, "50 49 31 24", {50, 49, 31, 24}, 4, 49, 24, CONIC_CAMERA_FISHEYE, CONIC_LENS_NONE, {0}},
  };
  for (size_t i = 0; i < sizeof models / sizeof *models; i++) {
    conic_cameras cameras;
    camera_bytes first, second;
    char line[256];
    conic_camera wanted = camera_example();
    wanted.fx = 50;
    wanted.fy = models[i].fy;
    wanted.cy = models[i].cy;
    wanted.kind = models[i].kind;
    wanted.lens = models[i].lens;
    memcpy(wanted.distortion, models[i].distortion, sizeof wanted.distortion);
    snprintf(line, sizeof line, "1 %s 64 48 %s\r\n", models[i].name, models[i].text);
    CHECK_OK(camera_read_colmap_text(context, line, CAMERA_COLMAP_IMAGES, &cameras));
    camera_check_read(context, &cameras, CONIC_CAMERA_FILE_COLMAP, "a/one.jpg", &wanted);
    camera_colmap_binary(models[i].number, models[i].parameters, models[i].n, &first, &second);
    CHECK_OK(camera_read_colmap(context, "bin", first.bytes, first.n, second.bytes, second.n, &cameras));
    camera_check_read(context, &cameras, CONIC_CAMERA_FILE_COLMAP, "a/one.jpg", &wanted);
  }
}

/* All around, whatever its parameters. */
static void test_panorama(void) {
  conic_cameras cameras;
  CHECK_OK(camera_read_colmap_text(context, "1 EQUIRECTANGULAR 64 32 64 32\n", CAMERA_COLMAP_IMAGES, &cameras));
  if (cameras.count == 1) {
    const conic_camera *c = cameras.cameras;
    CHECK(c->kind == CONIC_CAMERA_EQUIRECTANGULAR && c->cx == 32.0 && c->cy == 16.0);
    CHECK(fabs(c->fx * 3.14159265358979323846 - 32.0) < 1e-13 && fabs(c->fy * 3.14159265358979323846 - 32.0) < 1e-13);
  }
  conic_cameras_release(context, &cameras);
}

static void test_colmap_order(void) {
  static const char *const names[] = {"a.png", "a10.png", "a9.png", "b.png"};
  conic_cameras cameras;
  CHECK_OK(camera_read_colmap_text(context, "2 SIMPLE_PINHOLE 10 20 5 1 2\n\n# more\n1 SIMPLE_PINHOLE 30 40 6 1 2\n",
                                   "1 1 0 0 0 0 0 0 2 b.png\n\n3 1 0 0 0 0 0 0 1 a9.png\n1 2 3\n\n"
                                   "4 1 0 0 0 0 0 0 2 a10.png\n\n2 1 0 0 0 0 0 0 1 a.png",
                                   &cameras));
  CHECK(cameras.count == 4);
  for (size_t i = 0; i < cameras.count; i++) {
    CHECK(strcmp(cameras.names[i], names[i]) == 0);
    CHECK(cameras.cameras[i].width == (i % 2 ? 10 : 30));
  }
  conic_cameras_release(context, &cameras);
}

static void move_colmap(const char *below) {
  char folder[160], from[200], to[200];
  snprintf(folder, sizeof folder, "%s/%s", files_folder, below);
  for (char *c = folder + strlen(files_folder) + 1;; c++) /* folder by folder */
    if (*c == '/' || *c == 0) {
      char end = *c;
      *c = 0;
      conic_disk_make_folder(folder);
      *c = end;
      if (!end)
        break;
    }
  for (int i = 0; i < 2; i++) {
    snprintf(from, sizeof from, "%s/%s.txt", files_folder, i ? "images" : "cameras");
    snprintf(to, sizeof to, "%s/%s.txt", folder, i ? "images" : "cameras");
    CHECK(rename(from, to) == 0);
  }
}

static void test_folders(void) {
  static const char *const folders[] = {"sparse/0", "sparse", "colmap/sparse/0"};
  conic_cameras cameras;
  for (size_t i = 0; i < 3; i++) {
    char file[64];
    files_write("cameras.txt", CAMERA_COLMAP_CAMERAS);
    files_write("images.txt", CAMERA_COLMAP_IMAGES);
    move_colmap(folders[i]);
    CHECK(conic_cameras_is_file(context, files_folder));
    CHECK_OK(conic_cameras_read(context, files_folder, NULL, &cameras));
    CHECK(cameras.count == 1 && cameras.kind == CONIC_CAMERA_FILE_COLMAP);
    conic_cameras_release(context, &cameras);
    snprintf(file, sizeof file, "%s/images.txt", folders[i]);
    CHECK_OK(conic_cameras_read(context, files_path(file), NULL, &cameras));
    CHECK(cameras.count == 1 && cameras.kind == CONIC_CAMERA_FILE_COLMAP);
    conic_cameras_release(context, &cameras);
    unlink(files_path(file));
    files_check_failed("one file", conic_cameras_read(context, files_folder, NULL, &cameras), "holds no cameras",
                       (const char *)NULL);
    snprintf(file, sizeof file, "%s/cameras.txt", folders[i]);
    files_check_failed("one file", conic_cameras_read(context, files_path(file), NULL, &cameras), "side by side",
                       (const char *)NULL);
    unlink(files_path(file));
  }
  rmdir(files_path("sparse/0"));
  rmdir(files_path("sparse"));
  rmdir(files_path("colmap/sparse/0"));
  rmdir(files_path("colmap/sparse"));
  rmdir(files_path("colmap"));
  files_write("cameras.json", CAMERA_LIST);
  CHECK_OK(conic_cameras_read(context, files_folder, NULL, &cameras));
  CHECK(cameras.count == 1 && cameras.kind == CONIC_CAMERA_FILE_LIST);
  conic_cameras_release(context, &cameras);
  unlink(files_path("cameras.json"));
}

/* --- what is refused --- */

static void check_colmap_fails(const char *cameras_text, const char *images, const char *what, const char *where) {
  conic_cameras cameras;
  files_check_failed(cameras_text, camera_read_colmap_text(context, cameras_text, images, &cameras), what, where,
                     (const char *)NULL);
}

static void test_wrong_colmap(void) {
  static const char sound[] = CAMERA_COLMAP_CAMERAS;
  camera_bytes first, second;
  conic_cameras cameras;
  check_colmap_fails("1 PINHOLE 64 48 50 50 31\n", "", "not the numbers of a camera that is PINHOLE", "line 1");
  check_colmap_fails("\n1 PINHOLE 64 48 50 50 31 24 1\n", "", "not the numbers", "line 2");
  check_colmap_fails("1 PINHOLE 64 48.5 50 50 31 24\n", "", "1 to 65535", "line 1");
  check_colmap_fails("1 RAD_TAN_THIN_PRISM_FISHEYE 64 48 50\n", "", "RAD_TAN_THIN_PRISM_FISHEYE", "line 1");
  check_colmap_fails("1 EUCM 64 48 50\n", "", "not the numbers of a camera that is EUCM", "line 1");
  check_colmap_fails("1 WHAT 64 48 50\n", "", "none that is known", "line 1");
  check_colmap_fails("x PINHOLE 64 48 50\n", "", "begins with its number", "line 1");
  check_colmap_fails(sound, "", "no images", "images.txt");
  check_colmap_fails(sound, "1 1 0 0 0 0 0 0\n", "an image is", "line 1");
  check_colmap_fails(sound, "1 1 0 0 0 0 0 0 9 a\n", "images.txt: an image's camera is not there", "line 1");
  check_colmap_fails(sound, "1 0 0 0 0 0 0 0 1 a\n", "no rotation", "line 1");
  camera_colmap_binary(1, (const double[]){50.5, 50, 31, 24.5}, 4, &first, &second);
  for (size_t n = 0; n < first.n; n++)
    files_check_failed("cut cameras",
                       camera_read_colmap(context, "bin", first.bytes, n, second.bytes, second.n, &cameras),
                       "cameras.bin: the file ends too early", (const char *)NULL);
  for (size_t n = 0; n < second.n; n++)
    files_check_failed("cut images",
                       camera_read_colmap(context, "bin", first.bytes, first.n, second.bytes, n, &cameras),
                       "images.bin: ", (const char *)NULL);
  memset(first.bytes + 12, 0xff, 4);
  files_check_failed("a model",
                     camera_read_colmap(context, "bin", first.bytes, first.n, second.bytes, second.n, &cameras),
                     "none that is known", (const char *)NULL);
}

int main(void) {
  context = files_context();
  test_models();
  test_panorama();
  test_colmap_order();
  test_folders();
  test_wrong_colmap();
  files_end(context);
  return check_result();
}
