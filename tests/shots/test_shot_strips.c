/* Pictures in strips: each file is to the byte the one that is written of the picture as a whole, whatever the memory,
 * the threads and the scene. What is not drawn in strips is refused, and leaves no file. */
#include "tests/support/shot_fixture.h"

enum { WIDTH = 150, HEIGHT = 203 };

static const unsigned all_planes = CONIC_DRAWN_PLANES, few_planes = 1u << CONIC_PLANE_Z | 1u << CONIC_PLANE_ID;

/* Whether two files are the same. */
static int are_same(const char *a, const char *b) {
  FILE *first = fopen(a, "rb"), *second = fopen(b, "rb");
  int one = 0, other = 0;
  long n = 0;
  for (; first && second && one == other && one != EOF; n++) {
    one = fgetc(first);
    other = fgetc(second);
  }
  if (first)
    fclose(first);
  if (second)
    fclose(second);
  return one == EOF && other == EOF && n > 1000;
}

static void write_whole(conic_source *source, conic_renderer *renderer, const conic_shot *shot, const char *path,
                        conic_context *context, conic_shot_outcome *outcome) {
  conic_image image;
  CHECK_OK(conic_image_allocate(context, shot->camera.width, shot->camera.height, shot->planes, &image));
  CHECK_OK(conic_shot_draw(source, renderer, shot, &image, outcome));
  CHECK_OK(conic_image_write(context, path, &image));
  conic_image_release(context, &image);
}

/* The least memory gives strips as low as there may be. */
static void compare(conic_context *context, conic_renderer *renderer, conic_source *source, const conic_shot *shot) {
  static const uint64_t memory[] = {0, 200000, UINT64_C(1) << 32};
  char whole[FOLDER_ROOM + 96], strips[FOLDER_ROOM + 96];
  conic_shot_outcome drawn, written;
  snprintf(whole, sizeof whole, "%s", files_path("whole.exr"));
  snprintf(strips, sizeof strips, "%s", files_path("strips.exr"));
  write_whole(source, renderer, shot, whole, context, &drawn);
  for (size_t i = 0; i < sizeof memory / sizeof *memory; i++) {
    CHECK_OK(conic_shot_write_strips(source, renderer, shot, strips, memory[i], &written));
    CHECK(are_same(whole, strips));
    CHECK(written.statistics.pixels_covered == drawn.statistics.pixels_covered && drawn.statistics.pixels_covered > 0);
    remove(strips);
  }
  remove(whole);
}

static void test_same(int threads) {
  conic_context *context = check_context(threads);
  conic_renderer *renderer;
  CHECK_OK(conic_renderer_create(context, &renderer));
  for (int scene = 0; scene < SHOT_N_SCENES; scene++) {
    conic_source *source = shot_open(context, scene);
    conic_shot shot = shot_of(source, CONIC_CAMERA_PERSPECTIVE, WIDTH, HEIGHT);
    compare(context, renderer, source, &shot);
    shot.eye.shift = 0.05;
    shot.planes = scene == SHOT_GAUSSIANS ? 1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_TRANSPARENCY : all_planes;
    shot.view.samples = 2;
    compare(context, renderer, source, &shot);
    if (scene != SHOT_GAUSSIANS)
      shot.planes = few_planes;
    shot.view.samples = 1;
    shot.view.error_px = scene == SHOT_LAYERS || scene == SHOT_OCTREE ? 2.0 : 0.0;
    compare(context, renderer, source, &shot);
    conic_source_close(source);
  }
  conic_renderer_destroy(renderer);
  conic_context_destroy(context);
}

static void expect_refusal(conic_source *source, conic_renderer *renderer, const conic_shot *shot, conic_status status,
                           const char *name) {
  conic_shot_outcome outcome;
  char path[FOLDER_ROOM + 96];
  snprintf(path, sizeof path, "%s", files_path(name));
  CHECK(conic_shot_write_strips(source, renderer, shot, path, 1 << 20, &outcome) == status);
  FILE *file = fopen(path, "rb");
  CHECK(!file);
  if (file)
    fclose(file);
}

static void test_refused(conic_context *context) {
  conic_renderer *renderer;
  CHECK_OK(conic_renderer_create(context, &renderer));
  conic_source *source = shot_open(context, SHOT_MESH);
  const conic_shot plain = shot_of(source, CONIC_CAMERA_PERSPECTIVE, WIDTH, HEIGHT);
  conic_shot shot = plain;
  shot.light.n_directions = 8;
  expect_refusal(source, renderer, &shot, CONIC_ERROR_UNSUPPORTED, "lit.exr");
  shot = plain;
  shot.n_samples = 4;
  expect_refusal(source, renderer, &shot, CONIC_ERROR_UNSUPPORTED, "mean.exr");
  shot = plain;
  shot.has_backdrop = 1;
  expect_refusal(source, renderer, &shot, CONIC_ERROR_UNSUPPORTED, "backdrop.exr");
  shot = plain;
  shot.planes |= 1u << CONIC_PLANE_POSITION;
  expect_refusal(source, renderer, &shot, CONIC_ERROR_UNSUPPORTED, "position.exr");
  shot = shot_of(source, CONIC_CAMERA_FISHEYE, WIDTH, HEIGHT);
  expect_refusal(source, renderer, &shot, CONIC_ERROR_UNSUPPORTED, "fisheye.exr");
  shot = plain;
  shot.planes |= 1u << CONIC_PLANE_TRANSPARENCY;
  expect_refusal(source, renderer, &shot, CONIC_ERROR_ARGUMENT, "other.exr");
  shot = plain;
  shot.size = 0;
  expect_refusal(source, renderer, &shot, CONIC_ERROR_ARGUMENT, "size.exr");
  expect_refusal(source, renderer, &plain, CONIC_ERROR_ARGUMENT, "picture.png");
  expect_refusal(source, renderer, &plain, CONIC_ERROR_IO, "none/picture.exr");
  conic_source_close(source);
  conic_renderer_destroy(renderer);
}

int main(void) {
  conic_context *context = files_context();
  shot_write_scenes(context);
  test_same(1);
  test_same(3);
  test_refused(context);
  for (int i = 0; i < SHOT_N_SCENES; i++)
    remove(shot_paths[i]);
  files_end(context);
  return check_result();
}
