#include "core/cameras/camera_path.h"

#include "core/base/trigonometry.h"
#include "core/base/vectors.h"
#include "core/files/file.h"
#include "core/files/json_read.h"
#include "core/image/view_arguments.h"

enum { MOST_KEYS = 1 << 20 };
static const double most_seconds = 1e6, largest_place = 1e29;

/* --- reading --- */

static conic_status add_key(conic_context *context, conic_camera_path *path, const conic_camera_key *key) {
  return conic_memory_append(context, &path->keys, &path->n, &path->room, key, sizeof *key);
}

static conic_status read_place(conic_json *json, double place[3]) {
  size_t n;
  conic_status status = conic_json_numbers(json, place, 3, &n);
  for (int i = 0; i < 3 && status == CONIC_OK; i++)
    if (n != 3 || !(fabs(place[i]) < largest_place))
      return conic_json_wrong(json, "a place or direction has three numbers");
  return status;
}

/* What a key leaves out is as in the key before. */
static conic_status read_key(conic_json *json, const conic_camera *camera, conic_camera_key *key) {
  char name[CONIC_JSON_KEY_ROOM];
  int shorter = camera->width < camera->height ? camera->width : camera->height, has_time = 0;
  double fov = 0.0, last = key->time;
  conic_json_begin_object(json);
  while (conic_json_next_member(json, name)) {
    if (strcmp(name, "time") == 0)
      has_time = conic_json_number(json, &key->time) == CONIC_OK;
    else if (strcmp(name, "place") == 0)
      read_place(json, key->values + CONIC_PATH_PLACE);
    else if (strcmp(name, "target") == 0)
      read_place(json, key->values + CONIC_PATH_TARGET);
    else if (strcmp(name, "roll") == 0)
      conic_json_number(json, &key->values[CONIC_PATH_ROLL]);
    else if (strcmp(name, "fov") != 0)
      conic_json_wrong(json, "a key has time, place, target, roll and fov");
    else if (conic_json_number(json, &fov) == CONIC_OK && !(fov >= 0.001 && fov <= 179.9))
      conic_json_wrong(json, "a field of view is 0.001 to 179.9 degrees");
    else
      for (int i = 0; i < 2; i++)
        key->values[CONIC_PATH_FOCAL + i] = 0.5 * shorter / conic_tan(conic_radians(0.5 * fov));
  }
  if (json->status == CONIC_OK && (!has_time || !(key->time > last) || !(key->time <= most_seconds)))
    return conic_json_wrong(json, "every key has a time in seconds, later than the key before");
  if (json->status == CONIC_OK && !(fabs(key->values[CONIC_PATH_ROLL]) <= 1e6))
    return conic_json_wrong(json, "a roll is at most a million degrees");
  const double *at = key->values, *target = at + CONIC_PATH_TARGET;
  if (json->status == CONIC_OK && at[0] == target[0] && at[1] == target[1] && at[2] == target[2]) /* 0 is −0 */
    return conic_json_wrong(json, "a key's place and target are one");
  return json->status;
}

static conic_status read_keys(conic_json *json, conic_camera_path *path) {
  const conic_camera *camera = &path->usual;
  double focal = 0.5 * (camera->width < camera->height ? camera->width : camera->height) / conic_tan(conic_radians(20));
  conic_camera_key key = {.time = -most_seconds,
                          .values = {[CONIC_PATH_FOCAL] = focal, focal, 0.5 * camera->width, 0.5 * camera->height}};
  conic_json_begin_array(json);
  while (conic_json_next_item(json)) {
    if (path->n == MOST_KEYS)
      return conic_json_wrong(json, "there are more than a million keys");
    conic_status status = read_key(json, camera, &key);
    if (status == CONIC_OK)
      status = add_key(json->context, path, &key);
    if (status != CONIC_OK)
      return status;
  }
  return json->status;
}

static conic_status read_file(conic_json *json, conic_camera_path *path) {
  char name[CONIC_JSON_KEY_ROOM];
  double up[3];
  conic_json_begin_object(json);
  while (conic_json_next_member(json, name)) {
    if (strcmp(name, "keys") == 0)
      read_keys(json, path);
    else if (strcmp(name, "up") != 0)
      conic_json_skip(json);
    else if (read_place(json, up) == CONIC_OK && !(conic_length(up) > 0.0))
      conic_json_wrong(json, "no direction is up");
    else
      path->has_up = 1;
  }
  conic_json_end(json);
  if (json->status == CONIC_OK && path->n < 2)
    conic_json_wrong(json, "a path has two keys or more");
  if (json->status == CONIC_OK && path->has_up)
    conic_camera_path_stand(path, up);
  return json->status;
}

/* Whether a file is JSON with keys; little is said of others. */
static int has_keys(conic_context *context, const char *name) {
  conic_json json;
  char key[CONIC_JSON_KEY_ROOM];
  char head = 0;
  int is_found = 0;
  if (conic_file_read_head(name, &head, 1) != 1 || head != '{' || conic_json_open(context, name, &json) != CONIC_OK)
    return 0;
  json.is_silent = 1;
  for (conic_json_begin_object(&json); !is_found && conic_json_next_member(&json, key); conic_json_skip(&json))
    is_found = strcmp(key, "keys") == 0;
  conic_json_close(&json);
  return is_found;
}

static conic_status take_cameras(conic_context *context, const char *name, const conic_cameras *cameras,
                                 conic_camera_path *path) {
  conic_status status = CONIC_OK;
  path->has_up = 1;
  path->usual = cameras->cameras[0];
  for (size_t i = 0; i < cameras->count && status == CONIC_OK; i++) {
    const conic_camera *c = &cameras->cameras[i];
    conic_camera_key key = {.time = (double)i, .values = {[CONIC_PATH_FOCAL] = c->fx, c->fy, c->cx, c->cy}};
    for (int row = 0; row < 3; row++)
      for (int axis = 0; axis < 3; axis++)
        key.values[axis] -= c->cam_from_world[row][axis] * c->cam_from_world[row][3];
    for (int axis = 0; axis < 3; axis++) {
      key.values[CONIC_PATH_TARGET + axis] = key.values[axis] + c->cam_from_world[2][axis];
      key.values[CONIC_PATH_UP + axis] = -c->cam_from_world[1][axis];
    }
    int is_alike = c->width == path->usual.width && c->height == path->usual.height && c->kind == path->usual.kind &&
                   c->lens == path->usual.lens;
    status = is_alike
                 ? add_key(context, path, &key)
                 : conic_fail(context, CONIC_ERROR_INPUT, "%s: cameras of several sizes or kinds are no path", name);
  }
  return status == CONIC_OK && path->n < 2 ? conic_fail(context, CONIC_ERROR_INPUT, "%s: one camera is no path", name)
                                           : status;
}

/* --- smoothness --- */

/* Fritsch and Butland's mean of the two slopes beside a key: 0 where they turn, and at both ends. */
static void find_slopes(conic_camera_path *path) {
  for (size_t i = 1; i + 1 < path->n; i++) {
    conic_camera_key *key = &path->keys[i];
    double before = key->time - key[-1].time, after = key[1].time - key->time;
    for (int k = 0; k < CONIC_PATH_VALUES; k++) {
      double a = (key->values[k] - key[-1].values[k]) / before, b = (key[1].values[k] - key->values[k]) / after;
      double w = 2.0 * after + before, v = after + 2.0 * before;
      key->slopes[k] = a * b > 0.0 ? (w + v) / (w / a + v / b) : 0.0;
    }
  }
}

static double smooth_value(const conic_camera_key *key, double time, int k) {
  double h = key[1].time - key->time, t = (time - key->time) / h, u = 1.0 - t;
  return u * u * (1.0 + 2.0 * t) * key->values[k] + t * t * (3.0 - 2.0 * t) * key[1].values[k] +
         h * t * u * (u * key->slopes[k] - t * key[1].slopes[k]);
}

conic_status conic_camera_path_read(conic_context *context, const char *name, const int size[2],
                                    conic_camera_path *path) {
  conic_cameras_options options;
  conic_cameras cameras;
  conic_json json;
  memset(path, 0, sizeof *path);
  conic_cameras_options_init(&options);
  options.width = size[0];
  options.height = size[1];
  conic_status status;
  if (has_keys(context, name)) {
    path->usual = (conic_camera){.width = size[0] ? size[0] : 1024, .height = size[0] ? size[1] : 1024};
    status = conic_json_open(context, name, &json);
    if (status == CONIC_OK) {
      status = read_file(&json, path);
      conic_json_close(&json);
    }
  } else if ((status = conic_cameras_read(context, name, &options, &cameras)) == CONIC_OK) {
    status = take_cameras(context, name, &cameras, path);
    conic_cameras_release(context, &cameras);
  }
  if (status == CONIC_OK)
    find_slopes(path);
  else
    conic_camera_path_release(context, path);
  return status;
}

void conic_camera_path_stand(conic_camera_path *path, const double up[3]) {
  for (size_t i = 0; i < path->n; i++)
    memcpy(path->keys[i].values + CONIC_PATH_UP, up, 3 * sizeof *up);
}

/* The picture's axes: level, where up says what that is, and then rolled. */
static void find_rows(const double values[CONIC_PATH_VALUES], double rows[3][3]) {
  const double *up = values + CONIC_PATH_UP;
  conic_subtract(values + CONIC_PATH_TARGET, values, rows[2]);
  conic_normalize(rows[2]);
  conic_cross(rows[2], up, rows[0]);
  if (!(conic_length(rows[0]) > 1e-9 * conic_length(up))) /* straight up or down */
    conic_cross(rows[2], fabs(rows[2][1]) < 0.9 ? (const double[3]){0, 1, 0} : (const double[3]){0, 0, 1}, rows[0]);
  conic_normalize(rows[0]);
  conic_cross(rows[2], rows[0], rows[1]);
  double c = conic_cos(conic_radians(values[CONIC_PATH_ROLL])), s = conic_sin(conic_radians(values[CONIC_PATH_ROLL]));
  for (int i = 0; i < 3; i++) {
    double right = rows[0][i], down = rows[1][i];
    rows[0][i] = c * right + s * down;
    rows[1][i] = c * down - s * right;
  }
}

static void place_camera(const conic_camera_path *path, double time, conic_camera *camera) {
  double values[CONIC_PATH_VALUES], rows[3][3];
  size_t i = 0;
  time = fmin(time, path->keys[path->n - 1].time);
  while (i + 2 < path->n && path->keys[i + 1].time <= time)
    i++;
  for (int k = 0; k < CONIC_PATH_VALUES; k++)
    values[k] = smooth_value(&path->keys[i], time, k);
  find_rows(values, rows);
  *camera = path->usual;
  camera->fx = values[CONIC_PATH_FOCAL];
  camera->fy = values[CONIC_PATH_FOCAL + 1];
  camera->cx = values[CONIC_PATH_FOCAL + 2];
  camera->cy = values[CONIC_PATH_FOCAL + 3];
  for (int row = 0; row < 3; row++) {
    memcpy(camera->cam_from_world[row], rows[row], sizeof rows[row]);
    camera->cam_from_world[row][3] = -conic_dot(rows[row], values);
  }
}

conic_status conic_camera_path_list(conic_context *context, const conic_camera_path *path, double fps,
                                    conic_cameras *cameras) {
  enum { MOST_FRAMES = 1000000 };
  double first = path->keys[0].time, count = floor((path->keys[path->n - 1].time - first) * fps + 0.5) + 1.0;
  conic_status status = CONIC_OK;
  if (count > MOST_FRAMES)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "the path has %.0f frames, more than %d", count, MOST_FRAMES);
  if (!cameras->cameras)
    status = conic_memory_allocate_these(context, CONIC_ZEROED(cameras->cameras, (size_t)count),
                                         CONIC_ZEROED(cameras->names, (size_t)count));
  for (; cameras->count < (size_t)count && status == CONIC_OK; cameras->count++) {
    cameras->names[cameras->count] = conic_memory_allocate_zeroed(context, 1, 1);
    status = cameras->names[cameras->count] ? CONIC_OK : CONIC_ERROR_MEMORY;
  }
  for (size_t i = 0; i < cameras->count && status == CONIC_OK; i++) {
    const double time = first + (double)i / fps;
    char wrong[CONIC_CAMERA_FAULT_ROOM];
    place_camera(path, time, &cameras->cameras[i]);
    if (conic_camera_is_wrong(&cameras->cameras[i], wrong))
      status =
          conic_fail(context, CONIC_ERROR_INPUT, "the path at %g s, which may be at its own target: %s", time, wrong);
  }
  return status;
}

void conic_camera_path_release(conic_context *context, conic_camera_path *path) {
  conic_memory_release(context, path->keys);
  memset(path, 0, sizeof *path);
}
