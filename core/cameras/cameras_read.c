/* Finds the kind of a camera file, and the file in a folder. */

#include "core/base/byte_order.h"
#include "core/base/loan_find.h"
#include "core/cameras/camera_list.h"
#include "core/files/disk.h"
#include "core/files/file.h"
#include "core/files/mapping.h"

enum { PATH_ROOM = 4096 };

/* --- folders --- */

static int is_folder(const char *path) {
  conic_disk_entry found;
  return conic_disk_look(path, &found) && found.is_folder;
}

/* FOLDER/name, where that is a file. */
static int join_path(const char *folder, const char *name, char path[PATH_ROOM]) {
  int n = snprintf(path, PATH_ROOM, "%s%s%s", folder, *folder ? "/" : "", name);
  return n > 0 && n < PATH_ROOM && conic_file_is_there(path);
}

typedef struct colmap_paths {
  char cameras[PATH_ROOM], images[PATH_ROOM];
  int is_text;
} colmap_paths;

/* Both files of a model, in binary or else as text. */
static int find_colmap_pair(const char *folder, int is_text, colmap_paths *paths) {
  paths->is_text = is_text;
  return join_path(folder, is_text ? "cameras.txt" : "cameras.bin", paths->cameras) &&
         join_path(folder, is_text ? "images.txt" : "images.bin", paths->images);
}

static int find_colmap(const char *path, colmap_paths *paths) {
  static const char *const below[] = {"", "/sparse/0", "/sparse", "/colmap/sparse/0"};
  char folder[PATH_ROOM];
  for (size_t i = 0; i < sizeof below / sizeof *below; i++) {
    int n = snprintf(folder, sizeof folder, "%s%s", path, below[i]);
    if (n > 0 && n < PATH_ROOM && (find_colmap_pair(folder, 0, paths) || find_colmap_pair(folder, 1, paths)))
      return 1;
  }
  return 0;
}

/* Either file of a model names the model. */
static int is_colmap_file(const char *path) {
  static const char *const names[] = {"cameras.bin", "images.bin", "cameras.txt", "images.txt"};
  for (int i = 0; i < 4; i++)
    if (strcmp(conic_file_name(path), names[i]) == 0)
      return 1;
  return 0;
}

static int find_colmap_beside(const char *path, colmap_paths *paths) {
  char folder[PATH_ROOM];
  size_t n = (size_t)(conic_file_name(path) - path);
  if (n >= sizeof folder)
    return 0;
  snprintf(folder, sizeof folder, "%.*s", (int)n, path);
  if (n > 1)
    folder[n - 1] = 0; /* the slash */
  return find_colmap_pair(n ? folder : ".", conic_file_has_ending(path, "txt"), paths);
}

static int find_json_in(const char *folder, char path[PATH_ROOM]) {
  return join_path(folder, "transforms.json", path) || join_path(folder, "cameras.json", path);
}

/* --- content --- */

enum { NO_CAMERAS = CONIC_N_CAMERA_FILES };

/* The keys of JSON, as far as they tell its kind. Faults are left to the reader of that kind. */
typedef struct key_scan {
  const unsigned char *next, *end;
  int depth;
} key_scan;

/* Past a string; *length is 0 for one with escapes, which no known key has. */
static const unsigned char *scan_text(key_scan *scan, size_t *length) {
  const unsigned char *start = ++scan->next;
  int is_plain = 1;
  while (scan->next < scan->end && *scan->next != '"') {
    if (*scan->next == '\\' && scan->next + 1 < scan->end) {
      is_plain = 0;
      scan->next++;
    }
    scan->next++;
  }
  *length = is_plain ? (size_t)(scan->next - start) : 0;
  if (scan->next < scan->end)
    scan->next++;
  return start;
}

/* A conic_camera_file, or NO_CAMERAS. */
static int kind_of_json(const unsigned char *bytes, size_t n_bytes) {
  static const struct {
    const char *key;
    int is_in_array, kind;
  } telling[] = {{"world_to_camera", 0, CONIC_CAMERA_FILE_CONIC},
                 {"frames", 0, CONIC_CAMERA_FILE_TRANSFORMS},
                 {"asset", 0, CONIC_CAMERA_FILE_GLTF},
                 {"rotation", 1, CONIC_CAMERA_FILE_LIST}};
  key_scan scan = {bytes, bytes + n_bytes, 0};
  int is_array = 0, has_opened = 0;
  while (scan.next < scan.end) {
    size_t length;
    if (*scan.next == '"') {
      const unsigned char *text = scan_text(&scan, &length);
      for (size_t i = 0; i < sizeof telling / sizeof *telling; i++)
        if (is_array == telling[i].is_in_array && scan.depth == 1 + is_array && length == strlen(telling[i].key) &&
            memcmp(text, telling[i].key, length) == 0)
          return telling[i].kind;
      continue;
    }
    if (!has_opened && *scan.next == '[')
      is_array = 1;
    has_opened |= *scan.next == '[' || *scan.next == '{';
    scan.depth += (*scan.next == '[' || *scan.next == '{') - (*scan.next == ']' || *scan.next == '}');
    scan.next++;
  }
  return NO_CAMERAS;
}

/* An archive whose first file is an array. */
static int is_npz(const unsigned char *bytes, size_t n_bytes) {
  size_t n_name = n_bytes > 30 ? conic_load_16(bytes + 26) : 0;
  return n_name > 4 && n_name <= n_bytes - 30 && memcmp(bytes, "PK\3\4", 4) == 0 &&
         memcmp(bytes + 30 + n_name - 4, ".npy", 4) == 0;
}

static int kind_of_content(const unsigned char *bytes, size_t n_bytes) {
  if (n_bytes >= 4 && memcmp(bytes, "glTF", 4) == 0)
    return CONIC_CAMERA_FILE_GLTF;
  return is_npz(bytes, n_bytes) ? CONIC_CAMERA_FILE_NUMPY : kind_of_json(bytes, n_bytes);
}

/* --- reading --- */

static conic_status read_colmap_paths(conic_camera_list *list, const colmap_paths *paths) {
  conic_mapping cameras, images;
  conic_status status = conic_mapping_open(list->context, paths->cameras, &cameras);
  if (status != CONIC_OK)
    return status;
  status = conic_mapping_open(list->context, paths->images, &images);
  if (status == CONIC_OK) {
    const conic_colmap_file first = {paths->cameras, cameras.bytes, cameras.n_bytes};
    const conic_colmap_file second = {paths->images, images.bytes, images.n_bytes};
    status = conic_camera_colmap_read(list, &first, &second, paths->is_text);
    conic_mapping_close(list->context, &images);
  }
  conic_mapping_close(list->context, &cameras);
  return status;
}

/* An unknown kind is read as conic's own, whose reader says what is missing. */
static conic_status read_camera_bytes(conic_camera_list *list, const unsigned char *bytes, size_t n_bytes) {
  size_t n_mark = 0;
  conic_status status = conic_text_byte_order_mark(list->context, list->name, bytes, n_bytes, &n_mark);
  if (status != CONIC_OK)
    return status;
  bytes += n_mark;
  n_bytes -= n_mark;
  switch (kind_of_content(bytes, n_bytes)) {
  case CONIC_CAMERA_FILE_TRANSFORMS:
    return conic_camera_transforms_read(list, bytes, n_bytes);
  case CONIC_CAMERA_FILE_LIST:
    return conic_camera_array_read(list, bytes, n_bytes);
  case CONIC_CAMERA_FILE_NUMPY:
    return conic_camera_numpy_read(list, bytes, n_bytes);
  case CONIC_CAMERA_FILE_GLTF:
    return conic_camera_gltf_read(list, bytes, n_bytes);
  default:
    return conic_camera_json_read(list, bytes, n_bytes);
  }
}

static conic_status read_camera_file(conic_camera_list *list, const char *path) {
  conic_mapping mapping;
  conic_status status = conic_mapping_open(list->context, path, &mapping);
  if (status != CONIC_OK)
    return status;
  const unsigned char nothing = 0; /* an empty file has no bytes, which are no address */
  status = read_camera_bytes(list, mapping.n_bytes ? mapping.bytes : &nothing, mapping.n_bytes);
  conic_mapping_close(list->context, &mapping);
  return status;
}

static conic_status read_camera_path(conic_camera_list *list, const char *path) {
  colmap_paths paths;
  char inside[PATH_ROOM];
  int is_directory = is_folder(path);
  if (is_directory && find_colmap(path, &paths))
    return read_colmap_paths(list, &paths);
  if (is_directory && find_json_in(path, inside)) {
    list->name = list->path = inside;
    conic_status status = read_camera_file(list, inside);
    list->name = list->path = path;
    return status;
  }
  if (is_directory)
    return conic_fail(list->context, CONIC_ERROR_INPUT,
                      "%s: the directory holds no cameras: neither COLMAP's cameras and images, also in sparse/0, nor "
                      "transforms.json or cameras.json",
                      path);
  if (is_colmap_file(path) && conic_file_is_there(path))
    return find_colmap_beside(path, &paths)
               ? read_colmap_paths(list, &paths)
               : conic_fail(list->context, CONIC_ERROR_INPUT, "%s: COLMAP's cameras and images lie side by side", path);
  return read_camera_file(list, path);
}

conic_status conic_cameras_read(conic_context *context, const char *path, const conic_cameras_options *options,
                                conic_cameras *cameras) {
  int is_standard = strcmp(path, "-") == 0;
  conic_camera_list list = {.context = context,
                            .name = is_standard ? "standard input" : path,
                            .path = is_standard ? NULL : path,
                            .cameras = cameras};
  memset(cameras, 0, sizeof *cameras);
  conic_cameras_options_init(&list.options);
  const conic_cameras_options *own = &list.options;
  if ((options && !conic_options_take(&list.options, options)) || own->width < 0 || own->width > 65535 ||
      own->height < 0 || own->height > 65535 || !own->width != !own->height)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "%s: the options of its cameras make no sense", path);
  cameras->path = conic_camera_text(context, list.name, strlen(list.name));
  const conic_camera *lent = conic_loan_find(context, path, "camera");
  conic_status status = !cameras->path ? CONIC_ERROR_MEMORY
                        : lent         ? conic_camera_list_add(&list, lent, "", 0)
                                       : read_camera_path(&list, path);
  if (status != CONIC_OK)
    conic_cameras_release(context, cameras);
  return status;
}

conic_status conic_camera_read(conic_context *context, const char *path, conic_camera *camera) {
  conic_cameras cameras;
  conic_status status = conic_cameras_read(context, path, NULL, &cameras);
  if (status == CONIC_OK && cameras.count != 1)
    status = conic_fail(context, CONIC_ERROR_INPUT, "%s: it has %zu cameras, and one is needed (at byte 0)", path,
                        cameras.count);
  if (status == CONIC_OK)
    *camera = cameras.cameras[0];
  conic_cameras_release(context, &cameras);
  return status;
}

int conic_cameras_is_file(conic_context *context, const char *path) {
  colmap_paths paths;
  conic_mapping mapping;
  char inside[PATH_ROOM];
  if (is_folder(path))
    return find_colmap(path, &paths) || find_json_in(path, inside);
  if (!conic_file_is_there(path))
    return 0;
  if (is_colmap_file(path))
    return find_colmap_beside(path, &paths);
  if (!conic_file_begins_with(path, "PK\3\4", 4) && !conic_file_has_ending(path, "json"))
    return 0;
  if (conic_mapping_open(context, path, &mapping) != CONIC_OK)
    return 0;
  int kind = kind_of_content(mapping.bytes, mapping.n_bytes);
  conic_mapping_close(context, &mapping);
  return kind != NO_CAMERAS && kind != CONIC_CAMERA_FILE_GLTF;
}
