/* cameras.json of 3D Gaussian splatting: an array of centred cameras with their places in the world. */

#include "core/cameras/camera_list.h"
#include "core/files/json_read.h"

typedef enum array_number { WIDE, HIGH, FOCAL_X, FOCAL_Y, N_NUMBERS } array_number;

typedef struct array_camera {
  double numbers[N_NUMBERS], world_from_camera[3][4];
  int is_given[N_NUMBERS], has_position, has_rotation;
  char name[CONIC_CAMERA_NAME_ROOM];
} array_camera;

static void read_position(conic_json *json, array_camera *camera) {
  double position[3];
  size_t n;
  if (conic_json_numbers(json, position, 3, &n) != CONIC_OK)
    return;
  if (n != 3)
    conic_json_wrong(json, "a position has 3 numbers");
  for (int axis = 0; axis < 3 && n == 3; axis++)
    camera->world_from_camera[axis][3] = position[axis];
  camera->has_position = 1;
}

static void read_rotation_rows(conic_json *json, array_camera *camera) {
  int n_rows = 0;
  size_t n = 3;
  conic_json_begin_array(json);
  while (conic_json_next_item(json))
    if (n_rows == 3 || conic_json_numbers(json, camera->world_from_camera[n_rows++], 3, &n) != CONIC_OK || n != 3)
      conic_json_wrong(json, "a rotation has 3 rows of 3 numbers");
  if (n_rows != 3)
    conic_json_wrong(json, "a rotation has 3 rows of 3 numbers");
  camera->has_rotation = 1;
}

static void read_array_member(conic_json *json, const char *key, array_camera *camera) {
  static const char *const names[N_NUMBERS] = {"width", "height", "fx", "fy"};
  for (int i = 0; i < N_NUMBERS; i++)
    if (strcmp(key, names[i]) == 0) {
      camera->is_given[i] = 1;
      conic_json_number(json, &camera->numbers[i]);
      return;
    }
  if (strcmp(key, "position") == 0)
    read_position(json, camera);
  else if (strcmp(key, "rotation") == 0)
    read_rotation_rows(json, camera);
  else if (strcmp(key, "img_name") == 0)
    conic_json_text(json, camera->name, sizeof camera->name);
  else
    conic_json_skip(json);
}

static conic_status add_array_camera(conic_camera_list *list, conic_json *json, const array_camera *found) {
  list->line = json->line;
  conic_camera camera = {.width = conic_camera_pixels(found->numbers[WIDE]),
                         .height = conic_camera_pixels(found->numbers[HIGH]),
                         .fx = found->numbers[FOCAL_X],
                         .fy = found->numbers[found->is_given[FOCAL_Y] ? FOCAL_Y : FOCAL_X]};
  if (!found->has_position || !found->has_rotation || !found->is_given[FOCAL_X])
    return conic_json_wrong(json, "a camera has a position, a rotation, width, height, fx and fy");
  if (!found->is_given[WIDE] && !found->is_given[HIGH]) {
    conic_status status = conic_camera_list_size(list, NULL, &camera.width, &camera.height);
    if (status != CONIC_OK)
      return status;
  }
  if (!camera.width || !camera.height)
    return conic_json_wrong(json, "width and height are whole numbers from 1 to 65535");
  camera.cx = 0.5 * camera.width;
  camera.cy = 0.5 * camera.height;
  conic_camera_place(found->world_from_camera, &camera);
  return conic_camera_list_add(list, &camera, found->name, strlen(found->name));
}

conic_status conic_camera_array_read(conic_camera_list *list, const unsigned char *bytes, size_t n_bytes) {
  conic_json json;
  char key[CONIC_JSON_KEY_ROOM];
  list->cameras->kind = CONIC_CAMERA_FILE_LIST;
  conic_status status = conic_json_take(list->context, list->name, bytes, n_bytes, &json);
  if (status != CONIC_OK)
    return status;
  status = conic_json_begin_array(&json);
  while (status == CONIC_OK && conic_json_next_item(&json)) {
    array_camera camera = {.has_position = 0};
    conic_json_begin_object(&json);
    while (conic_json_next_member(&json, key))
      read_array_member(&json, key, &camera);
    status = json.status == CONIC_OK ? add_array_camera(list, &json, &camera) : json.status;
  }
  if (status == CONIC_OK)
    status = conic_json_end(&json);
  if (status == CONIC_OK && list->cameras->count == 0)
    status = conic_json_wrong(&json, "there are no cameras in it");
  conic_json_close(&json);
  return status;
}
