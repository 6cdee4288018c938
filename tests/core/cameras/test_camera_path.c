/* A camera's way: through its keys, at rest where it stops, never past them, and smooth. */
#include "core/base/vectors.h"
#include "core/cameras/camera_path.h"
#include "tests/support/files.h"

static conic_context *context;
enum { A_SECOND = 64 };

static conic_status read_text(const char *text, conic_camera_path *path) {
  const int size[2] = {200, 100};
  const char *name = files_write("keys.json", text);
  conic_status status = conic_camera_path_read(context, name, size, path);
  CHECK(unlink(name) == 0);
  return status;
}

static void place_of(const conic_camera *camera, double place[3]) {
  for (int axis = 0; axis < 3; axis++) {
    place[axis] = 0.0;
    for (int row = 0; row < 3; row++)
      place[axis] -= camera->cam_from_world[row][axis] * camera->cam_from_world[row][3];
  }
}

/* It goes up, stands still from 1 to 2 s, goes down slowly, and fast. */
static void check_way(void) {
  conic_camera_path path;
  conic_cameras cameras = {.count = 0};
  double last = 0.0, last_step = 0.0;
  static const double heights[] = {0.0, 4.0, 4.0, 3.0, -5.0};
  CHECK_OK(read_text("{\"keys\": [{\"time\": 0, \"place\": [0, 9, 0], \"target\": [0, 0, 0], \"fov\": 90},"
                     "{\"time\": 1, \"place\": [0, 9, 4]}, {\"time\": 2}, {\"time\": 4, \"place\": [0, 9, 3]},"
                     "{\"time\": 5, \"place\": [0, 9, -5], \"fov\": 60}]}",
                     &path));
  CHECK(!path.has_up && path.n == 5);
  conic_camera_path_stand(&path, (const double[3]){0.0, 0.0, 1.0});
  CHECK_OK(conic_camera_path_list(context, &path, A_SECOND, &cameras));
  CHECK(cameras.count == 5 * A_SECOND + 1);
  for (size_t i = 0; i < cameras.count; i++) {
    const conic_camera *camera = &cameras.cameras[i];
    double place[3], time = (double)i / A_SECOND;
    place_of(camera, place);
    for (size_t k = 0; k < path.n; k++)
      if (path.keys[k].time == time)
        CHECK_NEAR(place[2], heights[k], 1e-12);
    CHECK(place[2] <= 4.0 + 1e-12 && place[2] >= -5.0 - 1e-12);
    if (time >= 1.0 && time <= 2.0)
      CHECK_NEAR(place[2], 4.0, 1e-12);
    if (i > 0 && time <= 1.0)
      CHECK(place[2] >= last - 1e-12);
    if (i > 0 && time > 2.0)
      CHECK(place[2] <= last + 1e-12);
    if (i > 1) /* the speed has no steps: what is added to it in 1/64 s is small */
      CHECK_NEAR(place[2] - last, last_step, 0.03);
    last_step = i > 0 ? place[2] - last : 0.0;
    last = place[2];
    CHECK_NEAR(place[0], 0.0, 1e-12);
    CHECK_NEAR(camera->cam_from_world[2][1] * place[1] + camera->cam_from_world[2][2] * place[2], -conic_length(place),
               1e-9); /* it looks at the origin, */
    CHECK(fabs(camera->cam_from_world[0][2]) < 1e-12 && camera->cam_from_world[1][2] < 0.0); /* upright */
  }
  CHECK_NEAR(cameras.cameras[0].fx, 50.0, 1e-9);
  CHECK_NEAR(cameras.cameras[cameras.count - 1].fy, 50.0 * sqrt(3.0), 1e-9);
  CHECK_NEAR(cameras.cameras[0].cx, 100.0, 0.0);
  conic_cameras_release(context, &cameras);
  conic_camera_path_release(context, &path);
}

/* A quarter turn of roll puts what was up to the left. */
static void check_roll(void) {
  conic_camera_path path;
  conic_cameras cameras = {.count = 0};
  CHECK_OK(read_text("{\"up\": [0, 2, 0], \"keys\": [{\"time\": 0, \"place\": [0, 0, 5], \"target\": [0, 0, 0]},"
                     "{\"time\": 1, \"roll\": 90}]}",
                     &path));
  CHECK(path.has_up);
  CHECK_OK(conic_camera_path_list(context, &path, 1.0, &cameras));
  CHECK_NEAR(cameras.cameras[0].cam_from_world[1][1], -1.0, 1e-12);
  CHECK_NEAR(cameras.cameras[1].cam_from_world[0][1], -1.0, 1e-12);
  conic_cameras_release(context, &cameras);
  conic_camera_path_release(context, &path);
}

static void check_refused(const char *text, const char *what) {
  conic_camera_path path;
  files_check_failed(text, read_text(text, &path), "keys.json: ", what, (const char *)NULL);
  CHECK(path.n == 0);
}

#define KEY "{\"time\": 0, \"place\": [0, 0, 5], \"target\": [0, 0, 0]}"

int main(void) {
  context = files_context();
  check_way();
  check_roll();
  check_refused("{\"keys\": [" KEY "]}", "two keys");
  check_refused("{\"keys\": [" KEY ", {\"time\": 0}]}", "later than");
  check_refused("{\"keys\": [" KEY ", {\"roll\": 1}]}", "has a time");
  check_refused("{\"keys\": [" KEY ", {\"time\": 1, \"fov\": 180}]}", "field of view");
  check_refused("{\"keys\": [" KEY ", {\"time\": 1, \"plaice\": 1}]}", "place, target");
  check_refused("{\"keys\": [{\"time\": 0}, {\"time\": 1}]}", "are one");
  check_refused("{\"up\": [0, 0, 0], \"keys\": [" KEY ", {\"time\": 1}]}", "direction is up");
  conic_context_destroy(context);
  return check_result();
}
