/* A light's map: a depth picture of what the light meets first, drawn from the light. A light that is far away is drawn
 * from so far that its rays are practically parallel. */
#pragma once

#include "conic/lighting.h"
#include "core/lanes/instruction_sets.h"
#include "lighting/receivers.h"
#include "raster/tiles/finish.h"

/* A map as receivers are compared with it. A receiver at p, from the receivers' origin, is at rotation·p in the map's
 * camera space, with z measured from `distance` on. */
typedef struct conic_light_map {
  const float *z;
  const float *through; /* of each texel: the part of the light that comes as far as z; null: all does */
  int width, height;
  float rotation[3][3], distance;
  float focal, angle, center_x, center_y; /* angle: 1/focal, the width of a texel at the distance 1 */
  float epsilon, flat_epsilon;            /* in world units: the casters' ε; flat_epsilon is the same, or 0 if z
                                             includes it already */
  int is_lamp;                            /* receivers are measured from the lamp, whose rays spread; `distance` is 0 */
} conic_light_map;

/* A surface may be so far off its own plane before it hides itself. FLAT: where it faces the light, in texel edges.
 * SLOPE: what its slope adds, in texel edges and in splats' epsilons. Planes at an angle to each other part faster the
 * more the light grazes them. */
#define CONIC_LIGHT_MAP_FLAT 0.15f
#define CONIC_LIGHT_MAP_SLOPE 0.3f

/* The least cosine between a receiver and the light that the map uses: seen from its edge, a receiver's depth is not
 * known to a texel. */
#define CONIC_LIGHT_MAP_GRAZING 0.03f

/* Finds `visible` and `facing` of the receivers from begin to before end; receiver i's values are at i - begin.
 * visible: the part of the light that nothing hides, 0 to 1, and 0 where the receiver faces away. facing: the cosine of
 * the angle between normal and light, at least 0. A smooth map weighs the four nearest texels, another one takes the
 * nearest. */
typedef void conic_receive_function(const conic_light_map *map, const conic_receivers *receivers, size_t begin,
                                    size_t end, int is_smooth, float *visible, float *facing);

/* Places a map for the light from the unit `direction`, large enough for all receivers; leaves map->z. `texel` is in
 * world units; it grows where the map would be larger than `most`. *near_z is the near distance for drawing the map. */
void conic_light_map_place(const conic_casters *casters, const conic_receivers *receivers, const double direction[3],
                           double texel, int most, conic_camera *camera, double *near_z, conic_light_map *map);

/* A row of a picture's pixels. */
typedef struct conic_shaded_row {
  const conic_finish *finish;
  const conic_camera_rays *rays;
  const float *albedo, *normal; /* 3 a pixel; albedo is of what covers the pixel, times its coverage */
  const float *coverage;        /* 1 a pixel; where it is 0, colours are no numbers */
  size_t y;
} conic_shaded_row;

/* Fills `shaded`, 3 a pixel, with the colours of what the pixels from begin to before end show, as if it covered them,
 * by the lights of `finish`; the first pixel's is at 0. */
typedef void conic_shade_function(const conic_shaded_row *row, size_t begin, size_t end, float *shaded);

/* The loops that take most of the time of receiving light. */

typedef struct conic_lighting_loops {
  conic_receive_function *receive;
  conic_shade_function *shade;
} conic_lighting_loops;

CONIC_DECLARE_LOOPS(conic_lighting_loops);
