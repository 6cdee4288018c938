#include "core/base/trigonometry.h"
#include "core/scenes/scene_kind.h"

#define RING_RADIUS 1.0
#define TUBE_RADIUS 0.4

/* The checkerboard's squares around the axis and around the tube. */
enum { SECTORS = 32, BANDS = 12 };

static const uint8_t cream[3] = {0xf7, 0xec, 0xdc}, coral[3] = {0xd8, 0x4f, 0x3c};

static conic_status prepare_torus(conic_scene *scene) {
  scene->area = 4.0 * CONIC_PI * CONIC_PI * RING_RADIUS * TUBE_RADIUS;
  return CONIC_OK;
}

static void place_on_torus(const conic_scene *scene, uint64_t i, conic_scene_point *point) {
  double around_axis, around_tube;
  conic_scene_golden(i, scene->options.count, &around_axis, &around_tube);
  double longitude = 2.0 * CONIC_PI * around_axis;
  /* The tube is longer outside than inside; angle 0 is the outside, hence the sign. */
  double angle = conic_scene_equal_area_angle(around_tube, -TUBE_RADIUS / RING_RADIUS);
  double east = conic_sin(longitude), south = conic_cos(longitude);
  double outward = conic_cos(angle), upward = conic_sin(angle);
  double radius = RING_RADIUS + TUBE_RADIUS * outward;
  *point = (conic_scene_point){.position = {radius * east, TUBE_RADIUS * upward, radius * south},
                               .normal = {outward * east, upward, outward * south}};
  int sector = (int)(around_axis * SECTORS);
  int band = (int)(angle * (BANDS / (2.0 * CONIC_PI))); /* the angle is in [0, 2π] */
  int is_cream = (sector + band) % 2;
  for (int c = 0; c < 3; c++)
    point->color[c] = is_cream ? cream[c] : coral[c];
}

const conic_scene_kind conic_scene_torus = {.name = "torus",
                                            .summary = "radii 1 and 0.4, around the y axis, checker colours",
                                            .prepare = prepare_torus,
                                            .place = place_on_torus};
