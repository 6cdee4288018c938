/* The plane of motion against moved points: what each pixel shows is moved, with the camera or its input, and projected
 * again. */
#include "conic/motion.h"
#include "shots/way.h"
#include "source/source_kind.h"
#include "tests/support/shot_fixture.h"

enum {
  SIDE_PX = 64,
  PLANES = 1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_Z | 1u << CONIC_PLANE_POSITION | 1u << CONIC_PLANE_ID |
           1u << CONIC_PLANE_MOTION
};

/* Of two inputs between frames 0 and 1, there and back. */
static const double rest[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}},
                    turned[3][4] = {{0.8, -0.6, 0, 0.1}, {0.6, 0.8, 0, 0}, {0, 0, 1, 0}},
                    back[3][4] = {{0.8, 0.6, 0, -0.08}, {-0.6, 0.8, 0, 0.06}, {0, 0, 1, 0}},
                    shifted[3][4] = {{1, 0, 0, 0.25}, {0, 1, 0, 0}, {0, 0, 1, -0.5}},
                    unshifted[3][4] = {{1, 0, 0, -0.25}, {0, 1, 0, 0}, {0, 0, 1, 0.5}};
static const char keys[] = "[{\"input\": 0, \"frame\": 0, \"matrix\": [[1,0,0,0],[0,1,0,0],[0,0,1,0]]},"
                           " {\"input\": 0, \"frame\": 1, \"matrix\": [[0.8,-0.6,0,0.1],[0.6,0.8,0,0],[0,0,1,0]]},"
                           " {\"input\": 1, \"frame\": 0, \"matrix\": [[1,0,0,0],[0,1,0,0],[0,0,1,0]]},"
                           " {\"input\": 1, \"frame\": 1, \"matrix\": [[1,0,0,0.25],[0,1,0,0],[0,0,1,-0.5]]}]";

static void move(const double m[3][4], const double from[3], double to[3]) {
  for (int row = 0; row < 3; row++)
    to[row] = m[row][0] * from[0] + m[row][1] * from[1] + m[row][2] * from[2] + m[row][3];
}

/* How far pixel i's point goes to where the camera sees it once it is moved. */
static void expect_motion(const conic_image *image, size_t i, const double m[3][4], const conic_camera *then,
                          const float *motion) {
  const float *place = (const float *)image->planes[CONIC_PLANE_POSITION] + 3 * i;
  const double from[3] = {(double)place[0], (double)place[1], (double)place[2]};
  double to[3], seen[3];
  move(m, from, to);
  move(then->cam_from_world, to, seen);
  double depth = then->kind == CONIC_CAMERA_ORTHOGRAPHIC ? 1.0 : seen[2];
  CHECK_NEAR((double)motion[0], then->fx * seen[0] / depth + then->cx - ((double)(i % SIDE_PX) + 0.5), 1e-3);
  CHECK_NEAR((double)motion[1], then->fy * seen[1] / depth + then->cy - ((double)(i / SIDE_PX) + 0.5), 1e-3);
}

static conic_image draw(conic_source *source, conic_renderer *renderer, conic_shot *shot) {
  conic_image image;
  shot->planes = PLANES;
  CHECK_OK(conic_image_allocate(source->context, SIDE_PX, SIDE_PX, PLANES, &image));
  CHECK_OK(conic_shot_draw(source, renderer, shot, &image, NULL));
  return image;
}

/* With a camera that turns about the scene, of every kind of source. */
static void test_camera(conic_context *context, int scene, conic_camera_kind kind) {
  conic_source *source = shot_open(context, scene);
  conic_renderer *renderer;
  conic_shot shot = shot_of(source, kind, SIDE_PX, SIDE_PX);
  conic_camera then[2] = {shot.camera, shot.camera};
  size_t n = 0;
  CHECK_OK(conic_renderer_create(context, &renderer));
  shot.way =
      (conic_camera_way){.kind = CONIC_WAY_ORBIT, .frames_a_turn = 36.0, .center = {0.2, 0.1, 0}, .up = {0, 1, 0}};
  conic_image image = draw(source, renderer, &shot);
  conic_camera_orbit(shot.way.center, shot.way.up, 1.0 / 36.0, &then[0]);
  conic_camera_orbit(shot.way.center, shot.way.up, -1.0 / 36.0, &then[1]);
  const float *motion = image.planes[CONIC_PLANE_MOTION], *z = image.planes[CONIC_PLANE_Z];
  for (size_t i = 0; i < SIDE_PX * SIDE_PX; i++)
    for (int k = 0; k < 2; k++)
      if (z[i] > 0.0f) {
        expect_motion(&image, i, rest, &then[k], motion + 4 * i + 2 * k);
        n++;
      } else
        CHECK(motion[4 * i + 2 * (size_t)k] == 0.0f && motion[4 * i + 2 * (size_t)k + 1] == 0.0f);
  CHECK(n > 400);
  conic_image_release(context, &image);
  conic_renderer_destroy(renderer);
  conic_source_close(source);
}

static conic_source *open_both(conic_context *context) {
  const char *paths[2] = {shot_paths[SHOT_SPLATS], shot_paths[SHOT_MESH]};
  conic_source_options options;
  conic_source *source;
  conic_source_options_init(&options);
  options.as = CONIC_AS_MESH;
  options.place = "1:3,0,0,2,0,3,0,0,0,0,3,0"; /* beside the other, and as large */
  CHECK_OK(conic_source_open(context, paths, 2, &options, &source));
  return source;
}

/* Two inputs that go their own ways, at the first key's moment and at the last's. */
static void test_inputs(conic_context *context, double frame) {
  conic_source *source = open_both(context);
  conic_renderer *renderer;
  conic_shot shot = shot_of(source, CONIC_CAMERA_PERSPECTIVE, SIDE_PX, SIDE_PX);
  const char *path = files_path("keys.json");
  size_t n[2] = {0, 0};
  FILE *file = fopen(path, "w");
  CHECK(file && fputs(keys, file) >= 0 && fclose(file) == 0);
  CHECK_OK(conic_motion_read(context, path, 2, NULL, &shot.motion));
  CHECK_OK(conic_renderer_create(context, &renderer));
  shot.n_samples = 1;
  shot.frame = frame;
  conic_image image = draw(source, renderer, &shot);
  const float *motion = image.planes[CONIC_PLANE_MOTION];
  const uint32_t *id = image.planes[CONIC_PLANE_ID];
  for (size_t i = 0; i < SIDE_PX * SIDE_PX; i++) {
    if (id[i] == CONIC_NO_ID)
      continue;
    size_t input = conic_source_input_of(source, id[i]);
    expect_motion(&image, i, frame > 0.0 ? rest : input ? shifted : turned, &shot.camera, motion + 4 * i);
    expect_motion(&image, i, frame > 0.0 ? input ? unshifted : back : rest, &shot.camera, motion + 4 * i + 2);
    n[input]++;
  }
  CHECK(n[0] > 50 && n[1] > 50);
  conic_image_release(context, &image);
  conic_motion_destroy(shot.motion);
  conic_renderer_destroy(renderer);
  conic_source_close(source);
  remove(path);
}

static void test_refused(conic_context *context) {
  conic_source *source = shot_open(context, SHOT_SPLATS);
  conic_renderer *renderer;
  conic_shot shot = shot_of(source, CONIC_CAMERA_EQUIRECTANGULAR, SIDE_PX, SIDE_PX);
  conic_image image;
  const char *path = files_path("shapes.json");
  FILE *file = fopen(path, "w");
  CHECK(file && fprintf(file, "[{\"input\": 0, \"frame\": 1, \"file\": \"%s\"}]", shot_paths[SHOT_SPLATS]) > 0);
  fclose(file);
  CHECK_OK(conic_renderer_create(context, &renderer));
  CHECK_OK(conic_image_allocate(context, SIDE_PX, SIDE_PX, PLANES, &image));
  CHECK(conic_shot_draw(source, renderer, &shot, &image, NULL) == CONIC_ERROR_ARGUMENT);
  CHECK(strstr(files_message, "plane motion") != NULL);
  shot = shot_of(source, CONIC_CAMERA_PERSPECTIVE, SIDE_PX, SIDE_PX);
  shot.n_samples = 1;
  CHECK_OK(conic_motion_read(context, path, 1, NULL, &shot.motion));
  CHECK(conic_shot_draw(source, renderer, &shot, &image, NULL) == CONIC_ERROR_UNSUPPORTED);
  remove(path);
  conic_motion_destroy(shot.motion);
  conic_image_release(context, &image);
  conic_renderer_destroy(renderer);
  conic_source_close(source);
}

int main(void) {
  conic_context *context = files_context();
  shot_write_scenes(context);
  for (int scene = 0; scene < SHOT_N_SCENES; scene++)
    test_camera(context, scene, CONIC_CAMERA_PERSPECTIVE);
  test_camera(context, SHOT_MESH, CONIC_CAMERA_ORTHOGRAPHIC);
  test_inputs(context, 0.0);
  test_inputs(context, 1.0);
  test_refused(context);
  for (int i = 0; i < SHOT_N_SCENES; i++)
    remove(shot_paths[i]);
  files_end(context);
  return check_result();
}
