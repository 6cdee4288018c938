/* A light's map has the depth at which its rays first meet something. It is drawn from where the light is. A light far
 * away is taken to be so far that its rays are as good as parallel. */
#ifndef CONIC_LIGHT_MAP_H
#define CONIC_LIGHT_MAP_H

#include "conic/lighting.h"
#include "lighting/receivers.h"

/* The map as receivers are compared with it. A receiver at p from their origin is at rotation·p in the map's camera
 * space, z measured from `distance` on. */
typedef struct conic_light_map {
  const float *z;
  int width, height;
  float rotation[3][3], distance;
  float focal, angle, center_x, center_y; /* angle: 1/focal, of a texel */
  float epsilon, flat_epsilon;            /* in world units; the part that is not in z already */
  int is_lamp;                            /* its rays part: receivers are measured from it, and `distance` is 0 */
} conic_light_map;

/* A surface that faces the light may lie off its own plane by the first share of a texel's edge before it hides itself.
 * A slope adds the second share of that edge and of the splats' epsilon: the more the light grazes two planes that are
 * off by an angle, the faster they part. */
#define CONIC_LIGHT_MAP_FLAT 0.15f
#define CONIC_LIGHT_MAP_SLOPE 0.3f

/* A receiver's cosine counts as at least this: no map knows to a texel what it says of a receiver seen edge-on. */
#define CONIC_LIGHT_MAP_GRAZING 0.03f

/* Fills `visible` and `facing` for the receivers from begin to before end; both arrays start with receiver `begin`.
 * `visible` is the part of the light that nothing hides, 0 to 1 (0 where the receiver faces away). `facing` is the
 * cosine of the angle between normal and light, at least 0. A smooth map weighs the four nearest texels, another one
 * takes the nearest. */
typedef void conic_receive_function(const conic_light_map *map, const conic_receivers *receivers, size_t begin,
                                    size_t end, int is_smooth, float *visible, float *facing);

/* Places a map for the light that comes from the unit `direction`, to hold all receivers; map->z is left. `texel` is in
 * world units; it grows where the map would be larger than `most`. near_z: of what has to be drawn. */
void conic_light_map_place(const conic_casters *casters, const conic_receivers *receivers, const double direction[3],
                           double texel, int most, conic_camera *camera, double *near_z, conic_light_map *map);

#endif
