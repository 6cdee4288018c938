/* Files of one camera, in every format that is read: what tests compare, and what fuzzing starts from. */
#pragma once

#include "core/base/byte_order.h"
#include "core/cameras/camera_list.h"
#include "core/files/zip.h"
#include "tests/support/files.h"

typedef struct camera_bytes {
  unsigned char bytes[8192];
  size_t n;
} camera_bytes;

static inline void camera_put(camera_bytes *to, const void *bytes, size_t n) {
  if (to->n + n > sizeof to->bytes)
    exit(1);
  memcpy(to->bytes + to->n, bytes, n);
  to->n += n;
}

static inline void camera_put_word(camera_bytes *to, uint64_t value, size_t n_bytes) {
  unsigned char bytes[8];
  conic_store_64(bytes, value);
  camera_put(to, bytes, n_bytes);
}

static inline void camera_put_numbers(camera_bytes *to, const double *numbers, size_t n) {
  for (size_t i = 0; i < n; i++)
    camera_put_word(to, conic_bits_of_double(numbers[i]), 8);
}

static inline void camera_put_text(camera_bytes *to, const char *text) {
  camera_put(to, text, strlen(text));
}

/* 64 × 48 pixels, focal lengths 50.5 and 50, centred at 31, 24.5; rows (0 0 1) (1 0 0) (0 1 0), at (0.5, -2, 3). */
static inline conic_camera camera_example(void) {
  return (conic_camera){.width = 64,
                        .height = 48,
                        .fx = 50.5,
                        .fy = 50,
                        .cx = 31,
                        .cy = 24.5,
                        .cam_from_world = {{0, 0, 1, 0.5}, {1, 0, 0, -2}, {0, 1, 0, 3}}};
}

#define CAMERA_JSON                                                                                                    \
  "{\"width\": 64, \"height\": 48, \"fx\": 50.5, \"fy\": 50, \"cx\": 31, \"cy\": 24.5,\n"                              \
  "\"world_to_camera\": [[0,0,1,0.5],[1,0,0,-2],[0,1,0,3],[0,0,0,1]]}"
#define CAMERA_COLMAP_CAMERAS "# by hand\n1 PINHOLE 64 48 50.5 50 31 24.5\n"
#define CAMERA_COLMAP_IMAGES "# by hand\n7 .5 .5 .5 .5 0.5 -2 3 1 a/one.jpg\n10.5 20 -1 3 4 17\n"
#define CAMERA_MATRIX "[[0,-1,0,2],[0,0,-1,-3],[1,0,0,-0.5],[0,0,0,1]]"
#define CAMERA_TRANSFORMS                                                                                              \
  "{\"frames\": [{\"file_path\": \"a/one.jpg\", \"transform_matrix\": " CAMERA_MATRIX ", \"more\": [1]}],\n"           \
  "\"w\": 64, \"h\": 48, \"fl_x\": 50.5, \"fl_y\": 50, \"cx\": 31, \"cy\": 24.5, \"camera_model\": \"OPENCV\"}"
/* centred, as all such cameras are */
#define CAMERA_LIST                                                                                                    \
  "[{\"id\": 0, \"img_name\": \"one\", \"width\": 64, \"height\": 48, \"position\": [2, -3, -0.5],\n"                  \
  "\"rotation\": [[0,1,0],[0,0,1],[1,0,0]], \"fy\": 50, \"fx\": 50.5}]"
/* with a focal length of half the height, at a node whose parent moves it */
#define CAMERA_GLTF                                                                                                    \
  "{\"asset\": {\"version\": \"2.0\"}, \"cameras\": [{\"type\": \"perspective\", \"perspective\": "                    \
  "{\"yfov\": 1.5707963267948966, \"znear\": 0.1, \"aspectRatio\": 1.5}}, {\"type\": \"orthographic\", "               \
  "\"orthographic\": {\"xmag\": 2, \"ymag\": 1, \"znear\": 0, \"zfar\": 9}}],\n\"nodes\": [{\"name\": \"one\", "       \
  "\"camera\": 0, \"rotation\": [0.5, -0.5, 0.5, 0.5], \"translation\": [1, 0, 0]},\n{\"children\": [0, 2], "          \
  "\"matrix\": [2,0,0,0, 0,2,0,0, 0,0,2,0, 0,-3,-0.5,1]}, {\"name\": \"two\", \"camera\": 1}]}"

/* cameras.bin and images.bin of the example, its lens by a model of such a number with these parameters. */
static inline void camera_colmap_binary(uint64_t model, const double *parameters, size_t n, camera_bytes *cameras,
                                        camera_bytes *images) {
  static const double place[7] = {0.5, 0.5, 0.5, 0.5, 0.5, -2, 3}, point[2] = {10.5, 20};
  cameras->n = images->n = 0;
  camera_put_word(cameras, 1, 8);
  camera_put_word(cameras, 1, 4);
  camera_put_word(cameras, model, 4);
  camera_put_word(cameras, 64, 8);
  camera_put_word(cameras, 48, 8);
  camera_put_numbers(cameras, parameters, n);
  camera_put_word(images, 1, 8);
  camera_put_word(images, 7, 4);
  camera_put_numbers(images, place, 7);
  camera_put_word(images, 1, 4);
  camera_put(images, "a/one.jpg", 10);
  camera_put_word(images, 1, 8);
  camera_put_numbers(images, point, 2);
  camera_put_word(images, 3, 8);
}

/* An array as .npy. */
static inline camera_bytes camera_npy(const char *type, const char *order, const char *shape, const void *numbers,
                                      size_t n_bytes) {
  camera_bytes made = {.n = 0};
  char header[128];
  int n = snprintf(header, sizeof header, "{'descr': '%s', 'fortran_order': %s, 'shape': %s, }", type, order, shape);
  memset(header + n, ' ', 118 - (size_t)n);
  header[117] = '\n';
  camera_put(&made, "\x93NUMPY\1\0", 8);
  camera_put_word(&made, 118, 2);
  camera_put(&made, header, 118);
  camera_put(&made, numbers, n_bytes);
  if (*type == '<')
    conic_turn_words(made.bytes + made.n - n_bytes, n_bytes / (size_t)(type[2] - '0'), (size_t)(type[2] - '0'));
  return made;
}

typedef struct camera_part {
  const char *name;
  camera_bytes npy;
} camera_part;

static inline camera_bytes camera_npz(const camera_part *parts, size_t n) {
  camera_bytes made = {.n = 0};
  conic_zip_writer zip = {.to = tmpfile()};
  for (size_t i = 0; i < n; i++)
    if (!zip.to || !conic_zip_add(&zip, parts[i].name, parts[i].npy.bytes, parts[i].npy.n))
      exit(1);
  if (!conic_zip_end(&zip) || fseek(zip.to, 0, SEEK_SET) != 0)
    exit(1);
  made.n = fread(made.bytes, 1, sizeof made.bytes, zip.to);
  fclose(zip.to);
  return made;
}

static const double camera_npz_matrix[16] = {0, 0, 1, 0.5, 1, 0, 0, -2, 0, 1, 0, 3, 0, 0, 0, 1};
static const double camera_npz_k[9] = {50.5, 0, 31, 0, 50, 24.5, 0, 0, 1};

/* The example as gsplat's examples have theirs. */
static inline camera_bytes camera_npz_example(void) {
  static const int64_t width = 64, height = 48;
  const camera_part parts[] = {
      {"viewmats.npy", camera_npy("<f8", "False", "(1, 4, 4)", camera_npz_matrix, sizeof camera_npz_matrix)},
      {"Ks.npy", camera_npy("<f8", "False", "(1, 3, 3)", camera_npz_k, sizeof camera_npz_k)},
      {"width.npy", camera_npy("<i8", "False", "()", &width, sizeof width)},
      {"height.npy", camera_npy("<i8", "False", "()", &height, sizeof height)}};
  return camera_npz(parts, 4);
}

/* Both files of COLMAP as one: the length of the first in four bytes, then t or b (text, binary), then the files. */
static inline camera_bytes camera_join_colmap(char kind, const camera_bytes *cameras, const camera_bytes *images) {
  camera_bytes made = {.n = 0};
  camera_put_word(&made, cameras->n, 4);
  camera_put(&made, &kind, 1);
  camera_put(&made, cameras->bytes, cameras->n);
  camera_put(&made, images->bytes, images->n);
  return made;
}

static inline conic_status camera_read_joined(conic_context *context, const char *name, const unsigned char *bytes,
                                              size_t n, conic_cameras *cameras) {
  conic_camera_list list = {.context = context, .name = name, .cameras = cameras};
  uint32_t n_first = 0;
  memset(cameras, 0, sizeof *cameras);
  if (n >= 5)
    n_first = conic_load_32(bytes);
  size_t n_files = n >= 5 ? n - 5 : 0, split = n_first < n_files ? n_first : n_files;
  const unsigned char *files = bytes + (n - n_files);
  const conic_colmap_file first = {name, files, split}, second = {name, files + split, n_files - split};
  conic_status status = conic_camera_colmap_read(&list, &first, &second, n >= 5 && bytes[4] == 't');
  if (status != CONIC_OK)
    conic_cameras_release(context, cameras);
  return status;
}

/* Of a folder with both files, named so. */
static inline conic_status camera_read_colmap(conic_context *context, const char *ending, const void *cameras_bytes,
                                              size_t n_cameras, const void *images, size_t n_images,
                                              conic_cameras *cameras) {
  char name[2][32];
  snprintf(name[0], sizeof name[0], "cameras.%s", ending);
  snprintf(name[1], sizeof name[1], "images.%s", ending);
  const char *first = files_write_bytes(name[0], cameras_bytes, n_cameras);
  const char *second = files_write_bytes(name[1], images, n_images);
  conic_status status = conic_cameras_read(context, files_folder, NULL, cameras);
  CHECK(unlink(first) == 0 && unlink(second) == 0);
  return status;
}

static inline conic_status camera_read_colmap_text(conic_context *context, const char *cameras_text, const char *images,
                                                   conic_cameras *cameras) {
  return camera_read_colmap(context, "txt", cameras_text, strlen(cameras_text), images, strlen(images), cameras);
}

static inline int camera_is_same(const conic_camera *a, const conic_camera *b) {
  return memcmp(a, b, sizeof *a) == 0;
}

/* The one camera, which is released. */
static inline void camera_check_read(conic_context *context, conic_cameras *cameras, conic_camera_file kind,
                                     const char *name, const conic_camera *wanted) {
  CHECK(cameras->count == 1 && cameras->kind == (uint32_t)kind);
  if (cameras->count == 1) {
    CHECK(camera_is_same(cameras->cameras, wanted));
    CHECK(strcmp(cameras->names[0], name) == 0);
  }
  conic_cameras_release(context, cameras);
}
