#include "core/base/trigonometry.h"
#include "core/scenes/scene_kind.h"

/* The checkerboard's squares around the axis and from pole to pole. */
enum { MERIDIANS = 24, PARALLELS = 12 };

static const uint8_t ivory[3] = {0xf4, 0xe9, 0xd3}, teal[3] = {0x1c, 0x5d, 0x6b};

/* The heights of the parallels from the north pole on, without height 1. */
typedef struct scene_sphere {
  double parallels[PARALLELS - 1];
} scene_sphere;

static conic_status prepare_sphere(conic_scene *scene) {
  scene->area = 4.0 * CONIC_PI;
  scene_sphere *made = conic_scene_surface(scene, sizeof *made);
  if (!made)
    return CONIC_ERROR_MEMORY;
  for (int i = 0; i < PARALLELS - 1; i++)
    made->parallels[i] = conic_cos(CONIC_PI * (double)(i + 1) / PARALLELS);
  return CONIC_OK;
}

/* The Fibonacci lattice: heights in even steps (a zone's area is proportional to its height), longitudes turning by the
 * golden ratio. */
static void place_on_sphere(const conic_scene *scene, uint64_t i, conic_scene_point *point) {
  const scene_sphere *surface = scene->surface;
  uint64_t n = scene->options.count;
  double from_pole, turns;
  conic_scene_golden(i, n, &from_pole, &turns);
  double height = 1.0 - 2.0 * from_pole;
  /* sqrt(1 − height²) as a product of exact factors, so that nothing cancels at the poles. */
  double radius = sqrt((2.0 * (double)i + 1.0) * (2.0 * (double)(n - i) - 1.0)) / (double)n;
  double longitude = 2.0 * CONIC_PI * turns;
  point->normal[0] = radius * conic_sin(longitude);
  point->normal[1] = height;
  point->normal[2] = radius * conic_cos(longitude);
  int parallel = 0;
  while (parallel < PARALLELS - 1 && height < surface->parallels[parallel])
    parallel++;
  int is_ivory = ((int)(turns * MERIDIANS) + parallel) % 2;
  for (int c = 0; c < 3; c++) {
    point->position[c] = point->normal[c];
    point->color[c] = is_ivory ? ivory[c] : teal[c];
  }
}

const conic_scene_kind conic_scene_sphere = {.name = "sphere",
                                             .summary = "radius 1, the Fibonacci lattice, checker colours",
                                             .prepare = prepare_sphere,
                                             .place = place_on_sphere};
