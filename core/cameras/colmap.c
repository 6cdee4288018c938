/* COLMAP's sparse models: cameras and images, as text and binary. */

#include "core/base/base.h"
#include "core/base/byte_order.h"
#include "core/base/trigonometry.h"
#include "core/cameras/camera_list.h"
#include "core/files/number.h"

enum { MOST_PARAMETERS = 16, WORDS_OF_IMAGE = 9 };

/* One or two focal lengths and the centre come first, then the lens's numbers, in conic's order. */
typedef struct colmap_model {
  const char *name;
  int n_focal, n_lens;
  conic_camera_kind kind;
  conic_lens lens;
} colmap_model;

/* By COLMAP's numbers. */
static const colmap_model models[] = {
    {"SIMPLE_PINHOLE", 1, 0, CONIC_CAMERA_PERSPECTIVE, CONIC_LENS_NONE},
    {"PINHOLE", 2, 0, CONIC_CAMERA_PERSPECTIVE, CONIC_LENS_NONE},
    {"SIMPLE_RADIAL", 1, 1, CONIC_CAMERA_PERSPECTIVE, CONIC_LENS_RADIAL},
    {"RADIAL", 1, 2, CONIC_CAMERA_PERSPECTIVE, CONIC_LENS_RADIAL},
    {"OPENCV", 2, 4, CONIC_CAMERA_PERSPECTIVE, CONIC_LENS_OPENCV},
    {"OPENCV_FISHEYE", 2, 4, CONIC_CAMERA_FISHEYE, CONIC_LENS_RADIAL},
    {"FULL_OPENCV", 2, 8, CONIC_CAMERA_PERSPECTIVE, CONIC_LENS_OPENCV},
    {"FOV", 2, 1, CONIC_CAMERA_PERSPECTIVE, CONIC_LENS_FOV},
    {"SIMPLE_RADIAL_FISHEYE", 1, 1, CONIC_CAMERA_FISHEYE, CONIC_LENS_RADIAL},
    {"RADIAL_FISHEYE", 1, 2, CONIC_CAMERA_FISHEYE, CONIC_LENS_RADIAL},
    {"THIN_PRISM_FISHEYE", 2, 8, CONIC_CAMERA_FISHEYE, CONIC_LENS_THIN_PRISM},
    {"RAD_TAN_THIN_PRISM_FISHEYE", 0, 0, CONIC_N_CAMERA_KINDS, CONIC_LENS_NONE},
    {"SIMPLE_DIVISION", 1, 1, CONIC_CAMERA_PERSPECTIVE, CONIC_LENS_DIVISION},
    {"DIVISION", 2, 1, CONIC_CAMERA_PERSPECTIVE, CONIC_LENS_DIVISION},
    {"SIMPLE_FISHEYE", 1, 0, CONIC_CAMERA_FISHEYE, CONIC_LENS_NONE},
    {"FISHEYE", 2, 0, CONIC_CAMERA_FISHEYE, CONIC_LENS_NONE},
    {"EUCM", 2, 2, CONIC_CAMERA_PERSPECTIVE, CONIC_LENS_EUCM},
    {"EQUIRECTANGULAR", 0, 2, CONIC_CAMERA_EQUIRECTANGULAR, CONIC_LENS_NONE},
};

enum { N_MODELS = sizeof models / sizeof *models };

typedef struct colmap_camera {
  uint64_t id;
  conic_camera camera; /* without a place */
} colmap_camera;

typedef struct colmap_image {
  double quaternion[4], translation[3];
  uint64_t camera, line, byte; /* line, byte: where it is in the file */
  const char *name;
  size_t n_name;
} colmap_image;

typedef struct colmap_reader {
  conic_camera_list *list;
  const conic_colmap_file *file; /* the one being read */
  size_t at, line;               /* of text: the line from 1, or 0 */
  size_t line_end;               /* of text */
  colmap_camera *cameras;
  colmap_image *images;
  size_t n_cameras, camera_room, n_images, image_room;
} colmap_reader;

static conic_status colmap_wrong(const colmap_reader *reader, const char *what, const char *which) {
  return conic_fail(reader->list->context, CONIC_ERROR_INPUT, "%s: %s%s (%s %zu)", reader->file->name, what, which,
                    reader->line ? "line" : "at byte", reader->line ? reader->line : reader->at);
}

/* --- cameras and images --- */

static int n_parameters(const colmap_model *model) {
  return model->kind == CONIC_CAMERA_EQUIRECTANGULAR ? 2 : model->n_focal + 2 + model->n_lens;
}

static conic_status add_colmap_camera(colmap_reader *reader, uint64_t id, const colmap_model *model,
                                      const double size[2], const double *numbers) {
  conic_camera camera = {.width = conic_camera_pixels(size[0]),
                         .height = conic_camera_pixels(size[1]),
                         .kind = model->kind,
                         .lens = model->lens};
  if (!camera.width || !camera.height)
    return colmap_wrong(reader, "a picture is 1 to 65535 pixels wide and high", "");
  if (model->kind == CONIC_CAMERA_EQUIRECTANGULAR) { /* it sees all around, whatever its numbers */
    camera.fx = camera.width / (2.0 * CONIC_PI);
    camera.fy = camera.height / CONIC_PI;
    camera.cx = 0.5 * camera.width;
    camera.cy = 0.5 * camera.height;
  } else {
    const double *center = numbers + model->n_focal;
    camera.fx = numbers[0];
    camera.fy = numbers[model->n_focal - 1];
    camera.cx = center[0];
    camera.cy = center[1];
    memcpy(camera.distortion, center + 2, (size_t)model->n_lens * sizeof *center);
  }
  const colmap_camera added = {id, camera};
  return conic_memory_append(reader->list->context, &reader->cameras, &reader->n_cameras, &reader->camera_room, &added,
                             sizeof added);
}

static conic_status add_colmap_image(colmap_reader *reader, colmap_image *image) {
  image->line = reader->line;
  image->byte = reader->at;
  return conic_memory_append(reader->list->context, &reader->images, &reader->n_images, &reader->image_room, image,
                             sizeof *image);
}

static const colmap_model *find_model(colmap_reader *reader, uint64_t number, conic_status *status) {
  const colmap_model *model = number < N_MODELS ? &models[number] : NULL;
  if (model && model->kind != CONIC_N_CAMERA_KINDS)
    return model;
  *status = model ? colmap_wrong(reader, "a camera's model is not read: ", model->name)
                  : colmap_wrong(reader, "a camera's model is none that is known", "");
  return NULL;
}

/* --- binary --- */

/* The next bytes, or null after a message. */
static const unsigned char *take_colmap_bytes(colmap_reader *reader, uint64_t n, conic_status *status) {
  const unsigned char *bytes = reader->file->bytes + reader->at;
  if (*status != CONIC_OK)
    return NULL;
  if (n > reader->file->n_bytes - reader->at) {
    *status = colmap_wrong(reader, "the file ends too early", "");
    return NULL;
  }
  reader->at += (size_t)n;
  return bytes;
}

static uint64_t take_colmap_word(colmap_reader *reader, size_t n_bytes, conic_status *status) {
  const unsigned char *bytes = take_colmap_bytes(reader, n_bytes, status);
  return bytes ? conic_load_bits(bytes, n_bytes) : 0;
}

static void take_numbers(colmap_reader *reader, double *numbers, int n, conic_status *status) {
  const unsigned char *bytes = take_colmap_bytes(reader, (uint64_t)n * 8, status);
  for (int i = 0; bytes && i < n; i++)
    numbers[i] = conic_load_double(bytes + 8 * (size_t)i);
}

static conic_status read_binary_cameras(colmap_reader *reader) {
  conic_status status = CONIC_OK;
  uint64_t n = take_colmap_word(reader, 8, &status);
  for (uint64_t i = 0; i < n && status == CONIC_OK; i++) {
    double numbers[MOST_PARAMETERS] = {0}, size[2];
    uint64_t id = take_colmap_word(reader, 4, &status), number = take_colmap_word(reader, 4, &status);
    const colmap_model *model = status == CONIC_OK ? find_model(reader, number, &status) : NULL;
    for (int axis = 0; axis < 2; axis++)
      size[axis] = (double)take_colmap_word(reader, 8, &status);
    if (model)
      take_numbers(reader, numbers, n_parameters(model), &status);
    if (status == CONIC_OK)
      status = add_colmap_camera(reader, id, model, size, numbers);
  }
  return status;
}

static conic_status read_binary_images(colmap_reader *reader) {
  conic_status status = CONIC_OK;
  uint64_t n = take_colmap_word(reader, 8, &status);
  for (uint64_t i = 0; i < n && status == CONIC_OK; i++) {
    colmap_image image = {.name = NULL};
    take_colmap_word(reader, 4, &status);
    take_numbers(reader, image.quaternion, 4, &status);
    take_numbers(reader, image.translation, 3, &status);
    image.camera = take_colmap_word(reader, 4, &status);
    if (status != CONIC_OK)
      return status;
    image.name = (const char *)reader->file->bytes + reader->at;
    const char *end = memchr(image.name, 0, reader->file->n_bytes - reader->at);
    if (!end)
      return colmap_wrong(reader, "a name is not ended", "");
    image.n_name = (size_t)(end - image.name);
    reader->at += image.n_name + 1;
    uint64_t n_points = take_colmap_word(reader, 8, &status); /* of 24 bytes each */
    if (status == CONIC_OK && n_points > reader->file->n_bytes / 24)
      return colmap_wrong(reader, "the file ends too early", "");
    take_colmap_bytes(reader, n_points * 24, &status);
    if (status == CONIC_OK)
      status = add_colmap_image(reader, &image);
  }
  return status;
}

/* --- text --- */

/* To the start of the next line, of any kind; 0 at the end. */
static int next_text_line(colmap_reader *reader) {
  if (reader->line)
    reader->at = reader->line_end + 1;
  if (reader->at >= reader->file->n_bytes)
    return 0;
  const unsigned char *start = reader->file->bytes + reader->at;
  const unsigned char *end = memchr(start, '\n', reader->file->n_bytes - reader->at);
  reader->line++;
  reader->line_end = end ? reader->at + (size_t)(end - start) : reader->file->n_bytes;
  return 1;
}

static int is_text_blank(unsigned char c) {
  return c == ' ' || c == '\t' || c == '\r';
}

/* The next word of the line; its length is 0 at the end of the line. */
static const char *next_text_word(colmap_reader *reader, size_t *length) {
  const unsigned char *bytes = reader->file->bytes;
  while (reader->at < reader->line_end && is_text_blank(bytes[reader->at]))
    reader->at++;
  size_t start = reader->at;
  while (reader->at < reader->line_end && !is_text_blank(bytes[reader->at]))
    reader->at++;
  *length = reader->at - start;
  return (const char *)bytes + start;
}

/* To the next line with content: neither empty nor a comment. */
static int next_statement(colmap_reader *reader) {
  size_t length;
  while (next_text_line(reader)) {
    size_t start = reader->at;
    const char *word = next_text_word(reader, &length);
    reader->at = start;
    if (length && *word != '#')
      return 1;
  }
  return 0;
}

/* Up to `most` numbers of the line; returns most + 1 where there are more, -1 where a word is no number. */
static int take_line_numbers(colmap_reader *reader, double *numbers, int most) {
  size_t length;
  for (int n = 0;; n++) {
    const char *word = next_text_word(reader, &length);
    double value;
    if (length == 0)
      return n;
    if (conic_number_parse(word, length, &value) != length)
      return -1;
    if (n == most)
      return n + 1;
    numbers[n] = value;
  }
}

static int take_id(colmap_reader *reader, uint64_t *id) {
  size_t length;
  double value;
  const char *word = next_text_word(reader, &length);
  if (length == 0 || conic_number_parse(word, length, &value) != length || !(value >= 0.0 && value < 9e15) ||
      value != (double)(uint64_t)value)
    return 0;
  *id = (uint64_t)value;
  return 1;
}

static conic_status read_text_cameras(colmap_reader *reader) {
  conic_status status = CONIC_OK;
  while (status == CONIC_OK && next_statement(reader)) {
    double numbers[MOST_PARAMETERS + 2] = {0};
    uint64_t id, number = 0;
    size_t length;
    if (!take_id(reader, &id))
      return colmap_wrong(reader, "a camera begins with its number", "");
    const char *word = next_text_word(reader, &length);
    while (number < N_MODELS &&
           (strlen(models[number].name) != length || memcmp(models[number].name, word, length) != 0))
      number++;
    const colmap_model *model = find_model(reader, number, &status);
    if (!model)
      return status;
    if (take_line_numbers(reader, numbers, MOST_PARAMETERS + 2) != n_parameters(model) + 2)
      return colmap_wrong(reader, "these are not the numbers of a camera that is ", model->name);
    status = add_colmap_camera(reader, id, model, numbers, numbers + 2);
  }
  return status;
}

static conic_status read_text_image(colmap_reader *reader) {
  colmap_image image;
  double numbers[7];
  uint64_t id;
  size_t length;
  int is_good = take_id(reader, &id);
  for (int i = 0; i < 7 && is_good; i++) {
    const char *word = next_text_word(reader, &length);
    is_good = length && conic_number_parse(word, length, &numbers[i]) == length;
  }
  if (!is_good || !take_id(reader, &image.camera))
    return colmap_wrong(reader, "an image is a number, a quaternion, a translation, a camera's number and a name", "");
  memcpy(image.quaternion, numbers, sizeof image.quaternion);
  memcpy(image.translation, numbers + 4, sizeof image.translation);
  image.name = next_text_word(reader, &length);
  const char *end = (const char *)reader->file->bytes + reader->line_end;
  while (end > image.name && is_text_blank((unsigned char)end[-1]))
    end--;
  image.n_name = (size_t)(end - image.name);
  return add_colmap_image(reader, &image);
}

/* The line after an image's lists its points, and may be empty. */
static conic_status read_text_images(colmap_reader *reader) {
  conic_status status = CONIC_OK;
  while (status == CONIC_OK && next_statement(reader)) {
    status = read_text_image(reader);
    next_text_line(reader);
  }
  return status;
}

/* --- both --- */

CONIC_DEFINE_ORDER(compare_ids, colmap_camera, id)

/* Equal names keep the file's order, which is their order in memory. */
static int compare_image_names(const void *a, const void *b) {
  const colmap_image *first = a, *second = b;
  size_t n = first->n_name < second->n_name ? first->n_name : second->n_name;
  int order = memcmp(first->name, second->name, n);
  if (order == 0)
    order = (first->n_name > second->n_name) - (first->n_name < second->n_name);
  return order ? order : (first->name > second->name) - (first->name < second->name);
}

static conic_status place_images(colmap_reader *reader) {
  conic_camera_list *list = reader->list;
  conic_status status = CONIC_OK;
  if (reader->n_images == 0)
    return colmap_wrong(reader, "there are no images in it", "");
  if (reader->n_cameras)
    qsort(reader->cameras, reader->n_cameras, sizeof *reader->cameras, compare_ids);
  qsort(reader->images, reader->n_images, sizeof *reader->images, compare_image_names);
  for (size_t i = 0; i < reader->n_images && status == CONIC_OK; i++) {
    const colmap_image *image = &reader->images[i];
    const colmap_camera key = {.id = image->camera};
    const colmap_camera *found =
        reader->n_cameras ? bsearch(&key, reader->cameras, reader->n_cameras, sizeof *reader->cameras, compare_ids)
                          : NULL;
    double rows[3][3];
    list->line = image->line;
    list->byte = image->byte;
    if (!found)
      return conic_camera_list_wrong(list, "an image's camera is not there");
    if (!conic_camera_rotation(image->quaternion, rows))
      return conic_camera_list_wrong(list, "an image's quaternion is no rotation");
    conic_camera camera = found->camera;
    for (int row = 0; row < 3; row++) {
      memcpy(camera.cam_from_world[row], rows[row], sizeof rows[row]);
      camera.cam_from_world[row][3] = image->translation[row];
    }
    status = conic_camera_list_add(list, &camera, image->name, image->n_name);
  }
  return status;
}

conic_status conic_camera_colmap_read(conic_camera_list *list, const conic_colmap_file *cameras,
                                      const conic_colmap_file *images, int is_text) {
  colmap_reader reader = {.list = list, .file = cameras};
  list->cameras->kind = CONIC_CAMERA_FILE_COLMAP;
  conic_status status = is_text ? read_text_cameras(&reader) : read_binary_cameras(&reader);
  reader.file = images;
  list->name = images->name;
  reader.at = reader.line = 0;
  if (status == CONIC_OK)
    status = is_text ? read_text_images(&reader) : read_binary_images(&reader);
  if (status == CONIC_OK)
    status = place_images(&reader);
  conic_memory_release_these(list->context, reader.cameras, reader.images);
  return status;
}
