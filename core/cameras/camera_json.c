/* conic's own JSON of one camera. */

#include "core/cameras/camera_list.h"
#include "core/files/json_read.h"
#include "core/image/camera_shutter.h"
#include "core/image/view_arguments.h"

/* From KIND on they may be missing. */
typedef enum camera_key {
  WIDTH,
  HEIGHT,
  FX,
  FY,
  CX,
  CY,
  MATRIX,
  KIND,
  LENS,
  DISTORTION,
  SHUTTER,
  END,
  N_KEYS
} camera_key;

static const char *const key_names[N_KEYS] = {
    "width",           "height", "fx",   "fy",         "cx",      "cy",
    "world_to_camera", "kind",   "lens", "distortion", "shutter", "world_to_camera_end"};

static conic_status read_size(conic_json *json, int *size) {
  double value;
  conic_status status = conic_json_number(json, &value);
  if (status != CONIC_OK)
    return status;
  if (!(value >= 1.0 && value <= 65535.0) || value != (double)(int)value)
    return conic_json_wrong(json, "width and height are whole numbers from 1 to 65535");
  *size = (int)value;
  return CONIC_OK;
}

/* Drawing takes cameras within these limits. */
static const double largest_pixel_value = 1e12, largest_matrix_value = 1e30;

static conic_status read_bounded(conic_json *json, double limit, double *value) {
  conic_status status = conic_json_number(json, value);
  if (status == CONIC_OK && !(fabs(*value) < limit))
    return conic_json_wrong(json, "a number is too large");
  return status;
}

static conic_status read_focal_length(conic_json *json, double *value) {
  conic_status status = read_bounded(json, largest_pixel_value, value);
  if (status == CONIC_OK && !(*value > 0.0))
    return conic_json_wrong(json, "focal lengths are above 0");
  return status;
}

static const char wrong_shape[] = "world_to_camera has 4 rows of 4 numbers";

static conic_status read_matrix_row(conic_json *json, double row[4]) {
  int n = 0;
  conic_json_begin_array(json);
  while (conic_json_next_item(json)) {
    if (n == 4)
      return conic_json_wrong(json, wrong_shape);
    read_bounded(json, largest_matrix_value, &row[n++]);
  }
  return n == 4 ? json->status : conic_json_wrong(json, wrong_shape);
}

static conic_status check_matrix(conic_json *json, double rows[4][4]) {
  if (rows[3][0] != 0.0 || rows[3][1] != 0.0 || rows[3][2] != 0.0 || rows[3][3] != 1.0)
    return conic_json_wrong(json, "the last row of world_to_camera is 0 0 0 1");
  const char *fault = conic_rotation_fault((const double(*)[4])rows);
  char wrong[96];
  snprintf(wrong, sizeof wrong, "world_to_camera %s", fault ? fault : "");
  return fault ? conic_json_wrong(json, wrong) : CONIC_OK;
}

static conic_status read_matrix(conic_json *json, double cam_from_world[3][4]) {
  double rows[4][4];
  int n = 0;
  conic_json_begin_array(json);
  while (conic_json_next_item(json)) {
    if (n == 4)
      return conic_json_wrong(json, wrong_shape);
    read_matrix_row(json, rows[n++]);
  }
  if (json->status != CONIC_OK)
    return json->status;
  if (n != 4)
    return conic_json_wrong(json, wrong_shape);
  memcpy(cam_from_world, rows, 3 * sizeof *rows);
  return check_matrix(json, rows);
}

/* A word: one of conic_camera_kind_name or of conic_lens_name. */
static conic_status read_word(conic_json *json, int is_lens, uint32_t *number) {
  char text[32];
  conic_status status = conic_json_text(json, text, sizeof text);
  for (uint32_t i = 0; i < (is_lens ? CONIC_N_LENSES : CONIC_N_CAMERA_KINDS) && status == CONIC_OK; i++)
    if (strcmp(text, is_lens ? conic_lens_name((conic_lens)i) : conic_camera_kind_name((conic_camera_kind)i)) == 0) {
      *number = i;
      return CONIC_OK;
    }
  return conic_json_wrong(json, is_lens ? "a camera's lens is none, radial, opencv, thin-prism or fov"
                                        : "a camera's kind is perspective, fisheye, orthographic, equirectangular or "
                                          "cube");
}

static conic_status read_shutter(conic_json *json, uint32_t *shutter) {
  char text[32];
  conic_status status = conic_json_text(json, text, sizeof text);
  for (uint32_t i = 0; i < CONIC_N_SHUTTERS && status == CONIC_OK; i++)
    if (strcmp(text, conic_shutter_name((conic_shutter)i)) == 0) {
      *shutter = i;
      return CONIC_OK;
    }
  return conic_json_wrong(json, "a camera's shutter is global, top-to-bottom, left-to-right, bottom-to-top or "
                                "right-to-left");
}

static conic_status read_distortion(conic_json *json, double distortion[8]) {
  size_t n;
  conic_status status = conic_json_numbers(json, distortion, 8, &n);
  return status == CONIC_OK && n > 8 ? conic_json_wrong(json, "a distortion has at most 8 numbers") : status;
}

static conic_status read_value(conic_json *json, camera_key key, conic_camera *camera, conic_camera *end) {
  switch (key) {
  case WIDTH:
    return read_size(json, &camera->width);
  case HEIGHT:
    return read_size(json, &camera->height);
  case FX:
    return read_focal_length(json, &camera->fx);
  case FY:
    return read_focal_length(json, &camera->fy);
  case CX:
    return read_bounded(json, largest_pixel_value, &camera->cx);
  case CY:
    return read_bounded(json, largest_pixel_value, &camera->cy);
  case MATRIX:
    return read_matrix(json, camera->cam_from_world);
  case KIND:
    return read_word(json, 0, &camera->kind);
  case LENS:
    return read_word(json, 1, &camera->lens);
  case DISTORTION:
    return read_distortion(json, camera->distortion);
  case SHUTTER:
    return read_shutter(json, &camera->shutter);
  case END:
    return read_matrix(json, end->cam_from_world);
  case N_KEYS:
    break;
  }
  return conic_json_skip(json);
}

static conic_status read_camera(conic_json *json, conic_camera *camera) {
  char key[CONIC_JSON_KEY_ROOM], missing[64];
  int is_given[N_KEYS] = {0};
  conic_camera end = {.width = 0};
  conic_json_begin_object(json);
  while (conic_json_next_member(json, key)) {
    int i_key = 0;
    while (i_key < N_KEYS && strcmp(key, key_names[i_key]) != 0)
      i_key++;
    if (i_key < N_KEYS && is_given[i_key]++)
      return conic_json_wrong(json, "a key is given twice");
    read_value(json, (camera_key)i_key, camera, &end);
  }
  conic_json_end(json);
  for (int i = 0; i < KIND; i++)
    if (!is_given[i]) {
      snprintf(missing, sizeof missing, "the camera lacks %s", key_names[i]);
      return conic_json_wrong(json, missing);
    }
  if (is_given[END] != (camera->shutter != CONIC_SHUTTER_GLOBAL))
    return conic_json_wrong(json, "a rolling shutter, and none else, has world_to_camera_end");
  if (is_given[END])
    conic_camera_shutter_between(&end, camera);
  return json->status;
}

conic_status conic_camera_json_read(conic_camera_list *list, const unsigned char *bytes, size_t n_bytes) {
  conic_json json;
  conic_camera found = {.width = 0};
  list->cameras->kind = CONIC_CAMERA_FILE_CONIC;
  conic_status status = conic_json_take(list->context, list->name, bytes, n_bytes, &json);
  if (status != CONIC_OK)
    return status;
  status = read_camera(&json, &found);
  list->line = json.line;
  conic_json_close(&json);
  return status == CONIC_OK ? conic_camera_list_add(list, &found, "", 0) : status;
}
