#include "core/scenes/scene_kind.h"

/* A checkerboard of 8 × 8: white, and a grey of code 32; the square at (-½, -½) is dark. */
enum { SQUARES = 8, WHITE = 255, DARK = 32 };

/* The square root of the count, if it is a whole number; else 0. */
static uint64_t exact_root(uint64_t count) {
  uint64_t root = (uint64_t)(sqrt((double)count) + 0.5);
  return root * root == count ? root : 0;
}

static void place_on_plane(const conic_scene *scene, uint64_t i, conic_scene_point *point) {
  uint64_t count = scene->options.count, edge = exact_root(count);
  double u, v;
  if (edge) {
    uint64_t row = i / edge, column = i % edge;
    u = ((double)column + 0.5) / (double)edge;
    v = ((double)row + 0.5) / (double)edge;
  } else {
    conic_scene_golden(i, count, &v, &u);
  }
  int is_white = ((int)(u * SQUARES) + (int)(v * SQUARES)) % 2;
  *point = (conic_scene_point){.position = {u - 0.5, v - 0.5, 0.0}, .normal = {0.0, 0.0, 1.0}};
  for (int c = 0; c < 3; c++)
    point->color[c] = is_white ? WHITE : DARK;
}

static conic_status prepare_plane(conic_scene *scene) {
  scene->area = 1.0;
  return CONIC_OK;
}

const conic_scene_kind conic_scene_plane = {.name = "plane",
                                            .summary = "the unit square in z = 0, a checkerboard of 8 x 8",
                                            .prepare = prepare_plane,
                                            .place = place_on_plane};
