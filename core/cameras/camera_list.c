#include "core/cameras/camera_list.h"

#include "core/base/byte_order.h"
#include "core/base/vectors.h"
#include "core/files/file.h"
#include "core/files/guard.h"
#include "core/image/view_arguments.h"
#include "core/pictures/image_foreign.h"

CONIC_DEFINE_NAMES(conic_camera_file_name, conic_camera_file, CONIC_N_CAMERA_FILES, "conic", "colmap", "transforms",
                   "cameras.json", "npz", "gltf")

CONIC_DEFINE_ZERO_OPTIONS(conic_cameras_options)

void conic_cameras_release(conic_context *context, conic_cameras *cameras) {
  if (!cameras)
    return;
  for (size_t i = 0; i < cameras->count; i++)
    conic_memory_release(context, cameras->names[i]);
  conic_memory_release_these(context, cameras->cameras, cameras->path, cameras->names);
  memset(cameras, 0, sizeof *cameras);
}

void conic_camera_resize(conic_camera *camera, int width, int height) {
  double across = (double)width / (double)camera->width, down = (double)height / (double)camera->height;
  if (width != camera->width) {
    camera->fx *= across;
    camera->cx *= across;
  }
  if (height != camera->height) {
    camera->fy *= down;
    camera->cy *= down;
  }
  camera->width = width;
  camera->height = height;
}

conic_status conic_camera_list_wrong(const conic_camera_list *list, const char *what) {
  return conic_fail(list->context, CONIC_ERROR_INPUT, "%s: %s (%s %llu)", list->name, what,
                    list->line ? "line" : "at byte", (unsigned long long)(list->line ? list->line : list->byte));
}

/* --- a camera --- */

char *conic_camera_text(conic_context *context, const char *name, size_t n_name) {
  char *copy = conic_memory_allocate(context, n_name + 1, 1);
  for (size_t i = 0; copy && i < n_name; i++)
    copy[i] = (char)((unsigned char)name[i] < 0x20 || name[i] == 0x7f ? '?' : name[i]);
  if (copy)
    copy[n_name] = 0;
  return copy;
}

conic_status conic_camera_list_add(conic_camera_list *list, const conic_camera *given, const char *name,
                                   size_t n_name) {
  conic_cameras *cameras = list->cameras;
  conic_camera camera = *given;
  char wrong[CONIC_CAMERA_FAULT_ROOM];
  conic_camera_settle_lens(&camera);
  if (n_name >= CONIC_CAMERA_NAME_ROOM)
    return conic_camera_list_wrong(list, "the name of a view is too long");
  int is_wrong = conic_camera_is_wrong(&camera, wrong);
  if (!is_wrong && list->options.width) {
    conic_camera_resize(&camera, list->options.width, list->options.height);
    is_wrong = conic_camera_is_wrong(&camera, wrong);
  }
  if (is_wrong)
    return conic_camera_list_wrong(list, wrong);
  conic_status status = conic_memory_reserve(list->context, &cameras->cameras, cameras->count, cameras->count + 1,
                                             &list->camera_room, sizeof *cameras->cameras);
  if (status == CONIC_OK)
    status = conic_memory_reserve(list->context, &cameras->names, cameras->count, cameras->count + 1, &list->name_room,
                                  sizeof *cameras->names);
  if (status != CONIC_OK)
    return status;
  char *copy = conic_camera_text(list->context, name, n_name);
  if (!copy)
    return CONIC_ERROR_MEMORY;
  cameras->cameras[cameras->count] = camera;
  cameras->names[cameras->count++] = copy;
  return CONIC_OK;
}

void conic_camera_settle_lens(conic_camera *camera) {
  for (int i = 0; i < 8; i++)
    if (camera->distortion[i] != 0.0)
      return;
  camera->lens = CONIC_LENS_NONE;
  memset(camera->distortion, 0, sizeof camera->distortion); /* -0 */
}

int conic_camera_rotation(const double quaternion[4], double rows[3][3]) {
  double length = sqrt(quaternion[0] * quaternion[0] + quaternion[1] * quaternion[1] + quaternion[2] * quaternion[2] +
                       quaternion[3] * quaternion[3]);
  if (!(length > 0.0 && length < 1e150))
    return 0;
  const double unit[4] = {quaternion[0] / length, quaternion[1] / length, quaternion[2] / length,
                          quaternion[3] / length};
  conic_rotation_of(unit, rows);
  return 1;
}

void conic_camera_place(const double world_from_camera[3][4], conic_camera *camera) {
  double eye[3];
  for (int axis = 0; axis < 3; axis++)
    eye[axis] = world_from_camera[axis][3];
  for (int i = 0; i < 3; i++) {
    double *row = camera->cam_from_world[i];
    for (int axis = 0; axis < 3; axis++)
      row[axis] = world_from_camera[axis][i];
    row[3] = 0.0 - conic_dot(row, eye); /* never -0 */
  }
}

void conic_camera_place_opengl(const double world_from_camera[3][4], conic_camera *camera) {
  conic_camera_place(world_from_camera, camera);
  for (int i = 1; i < 3; i++)
    for (int k = 0; k < 4; k++)
      camera->cam_from_world[i][k] = 0.0 - camera->cam_from_world[i][k];
}

/* --- sizes --- */

int conic_camera_pixels(double value) {
  return value >= 1.0 && value <= 65535.0 && value == (double)(int)value ? (int)value : 0;
}

/* 0 where it is more than pictures have. */
static int load_png_side(const unsigned char bytes[4]) {
  uint32_t side = conic_load_big_32(bytes);
  return side < 65536 ? (int)side : 0;
}

static int find_picture_size(const char *path, int *width, int *height) {
  unsigned char start[24];
  FILE *file = conic_file_begins_with(path, "\x89PNG\r\n\x1a\n", 8) ? conic_disk_open_stream(path, "rb") : NULL;
  int is_read = file && fread(start, 1, sizeof start, file) == sizeof start;
  if (file)
    fclose(file);
  if (!is_read)
    return conic_foreign_size(path, width, height);
  *width = load_png_side(start + 16);
  *height = load_png_side(start + 20);
  return *width > 0 && *height > 0;
}

conic_status conic_camera_list_size(conic_camera_list *list, const char *picture, int *width, int *height) {
  static const char *const endings[] = {"", ".png", ".jpg", ".jpeg", ".webp", ".JPG", ".PNG"};
  int is_beside = list->path && picture && !conic_disk_is_absolute(picture);
  int n_folder = is_beside ? (int)(conic_file_name(list->path) - list->path) : 0;
  char path[4096];
  *width = *height = 0;
  for (size_t i = 0; *width == 0 && list->path && picture && *picture && i < sizeof endings / sizeof *endings; i++) {
    int n = snprintf(path, sizeof path, "%.*s%s%s", n_folder, list->path, picture, endings[i]);
    if (n < 0 || (size_t)n >= sizeof path || !conic_file_is_there(path))
      continue;
    conic_status status = conic_guard_note_path(list->context, path);
    if (status != CONIC_OK)
      return status;
    if (!find_picture_size(path, width, height))
      *width = 0;
  }
  if (*width == 0) {
    *width = list->options.width;
    *height = list->options.height;
  }
  return *width ? CONIC_OK
                : conic_camera_list_wrong(list, "it does not say how large its pictures are; give --size WxH, too");
}

/* --- finding one --- */

static size_t view_base(const char *name) {
  return (size_t)(conic_file_name(name) - name);
}

static int is_called(const char *name, const char *wanted, int how) {
  size_t begin = how > 0 ? view_base(name) : 0, length = strlen(name) - begin, n_wanted = strlen(wanted);
  const char *dot = strrchr(name + begin, '.');
  if (how == 2 && dot && dot > name + begin)
    length = (size_t)(dot - name) - begin;
  return length == n_wanted && memcmp(name + begin, wanted, length) == 0;
}

/* The index in a text; `none` where it is no number, or has leading zeros. */
static size_t take_view_index(const char *text, size_t none) {
  size_t value = 0, n = strlen(text);
  if (n == 0 || n > 9 || strspn(text, "0123456789") != n || (*text == '0' && n > 1))
    return none;
  for (; *text; text++)
    value = value * 10 + (size_t)(*text - '0');
  return value;
}

conic_status conic_cameras_find(conic_context *context, const conic_cameras *cameras, const char *name,
                                size_t *i_camera) {
  *i_camera = take_view_index(name, cameras->count);
  if (*i_camera < cameras->count)
    return CONIC_OK;
  for (int how = 0; how < 3; how++) {
    size_t n = 0;
    for (size_t i = 0; i < cameras->count; i++)
      if (*cameras->names[i] && is_called(cameras->names[i], name, how) && n++ == 0)
        *i_camera = i;
    if (n > 1)
      return conic_fail(context, CONIC_ERROR_ARGUMENT, "%s: %zu views are called %s, such as view %zu, %s",
                        cameras->path, n, name, *i_camera, cameras->names[*i_camera]);
    if (n == 1)
      return CONIC_OK;
  }
  const char *first = cameras->count ? cameras->names[0] : "",
             *last = cameras->count ? cameras->names[cameras->count - 1] : "";
  return conic_fail(context, CONIC_ERROR_ARGUMENT, "%s: there is no view %s; there are %zu%s%s%s%s", cameras->path,
                    name, cameras->count, *first ? ", from " : "", first, *last ? " to " : "", last);
}
