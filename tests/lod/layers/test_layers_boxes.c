/* Boxes of a layered cloud's places, in a picture: they hold all samples, a level has as many as it has places, and
 * what lies behind is faint. */
#include "core/coloring/color_ramp.h"
#include "tests/support/layers_fixture.h"

enum { SIDE = 200, N = 20000 };

static conic_camera look_at_sphere(void) {
  conic_camera camera = {.width = SIDE, .height = SIDE, .fx = SIDE, .fy = SIDE, .cx = 0.5 * SIDE, .cy = 0.5 * SIDE};
  for (int i = 0; i < 3; i++)
    camera.cam_from_world[i][i] = 1.0;
  camera.cam_from_world[2][3] = 5.0;
  return camera;
}

/* How many places' colours are seen in full, and the edges of all that is painted. */
static int count_colors(const conic_image *map, uint32_t n_places, int edges[4]) {
  const float *pixel = map->planes[CONIC_PLANE_RGBA];
  int n = 0;
  edges[0] = edges[1] = SIDE;
  edges[2] = edges[3] = -1;
  for (int y = 0; y < SIDE; y++)
    for (int x = 0; x < SIDE; x++)
      if (pixel[4 * (y * SIDE + x) + 3] > 0.0f) {
        edges[0] = x < edges[0] ? x : edges[0];
        edges[1] = y < edges[1] ? y : edges[1];
        edges[2] = x > edges[2] ? x : edges[2];
        edges[3] = y > edges[3] ? y : edges[3];
      }
  for (uint32_t place = 0; place < n_places; place++) {
    float color[3];
    int is_seen = 0;
    conic_number_color(place, color);
    for (size_t i = 0; i < (size_t)SIDE * SIDE && !is_seen; i++)
      is_seen = pixel[4 * i] == color[0] && pixel[4 * i + 1] == color[1] && pixel[4 * i + 2] == color[2];
    n += is_seen;
  }
  return n;
}

static void check_levels(conic_context *context, conic_layers *layers, conic_image *image) {
  const conic_camera camera = look_at_sphere();
  const int limit = (int)(0.5 * SIDE - SIDE / sqrt(24.0)) + 1; /* where the sphere's outline begins */
  for (int level = 0; level < 3; level++) {
    conic_image map;
    int edges[4];
    CHECK_OK(conic_layers_draw_boxes(layers, &camera, level, image, &map));
    CHECK(count_colors(&map, (1u << (level + 1)) - 1, edges) >= 1 << level);
    for (int i = 0; i < 2; i++)
      CHECK(edges[i] <= limit && edges[2 + i] >= SIDE - 1 - limit);
    conic_image_release(context, &map);
  }
}

int main(void) {
  conic_context *context = files_context();
  conic_layers_options options;
  conic_splats splats;
  conic_layers *layers;
  conic_image image, map;
  int edges[4];
  const char *path = files_path("boxes.lpc");
  conic_camera camera = look_at_sphere();
  conic_layers_options_init(&options);
  options.cloud_size = 512;
  layers_scene(context, CONIC_SCENE_SPHERE, N, 0.0, &splats);
  CHECK_OK(layers_build(context, &splats, path, &options, NULL));
  CHECK_OK(conic_layers_open(context, path, NULL, &layers));
  CHECK_OK(conic_image_allocate(context, SIDE, SIDE, 1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_Z, &image));
  memset(image.planes[CONIC_PLANE_RGBA], 0, sizeof(float) * 4 * SIDE * SIDE);
  memset(image.planes[CONIC_PLANE_Z], 0, sizeof(float) * SIDE * SIDE);
  check_levels(context, layers, &image);
  /* Behind what is drawn no line shows in full. */
  for (int i = 0; i < SIDE * SIDE; i++)
    ((float *)image.planes[CONIC_PLANE_Z])[i] = 1.0f;
  CHECK_OK(conic_layers_draw_boxes(layers, &camera, 0, &image, &map));
  CHECK(count_colors(&map, 1, edges) == 0 && edges[0] < SIDE / 2);
  conic_image_release(context, &map);
  camera.width = 64;
  CHECK(conic_layers_draw_boxes(layers, &camera, 0, &image, &map) == CONIC_ERROR_ARGUMENT);
  conic_image_release(context, &image);
  conic_layers_close(layers);
  unlink(path);
  conic_splats_release(context, &splats);
  files_end(context);
  return check_result();
}
