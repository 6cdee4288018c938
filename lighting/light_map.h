/* A light's map: the depth of what it meets first, drawn from where it is, or for a light that is far away from so far
 * that its rays are parallel as good as. */
#ifndef CONIC_LIGHT_MAP_H
#define CONIC_LIGHT_MAP_H

#include "conic/lighting.h"
#include "lighting/receivers.h"

/* As receivers are compared with it. A receiver at p from their origin is at rotation·p in the map's camera space, z
 * measured from `distance` on. */
typedef struct conic_light_map {
  const float *z;
  int width, height;
  float rotation[3][3], distance;
  float focal, angle, center_x, center_y; /* angle: 1/focal, of a texel */
  float epsilon, flat_epsilon;            /* in world units; what of it z does not have in it already */
  int is_lamp;                            /* its rays part: receivers are measured from it, and `distance` is 0 */
} conic_light_map;

/* What of the texel's edge a surface may lie off its own plane before it hides itself, where it faces the light, and
 * what of that edge and of the splats' epsilon the slope adds: planes that are off by an angle part the faster the more
 * the light grazes them. */
#define CONIC_LIGHT_MAP_FLAT 0.15f
#define CONIC_LIGHT_MAP_SLOPE 0.3f

/* The cosine below which a receiver is taken to face the light no less: what a map says of one that is seen from its
 * edge is not known to a texel. */
#define CONIC_LIGHT_MAP_GRAZING 0.03f

/* Visible and facing of the receivers from begin to before end, at their places in the two arrays less `begin`: the
 * part of the light that nothing hides, 0 to 1 (0 where the receiver faces away), and the cosine of the angle between
 * normal and light, at least 0. A smooth map weighs the four nearest texels, another one takes the nearest. */
typedef void conic_receive_function(const conic_light_map *map, const conic_receivers *receivers, size_t begin,
                                    size_t end, int is_smooth, float *visible, float *facing);

/* Places a map for the light that comes from the unit `direction`, to hold all receivers; map->z is left. `texel` is in
 * world units; it grows where the map would be larger than `most`. near_z: of what has to be drawn. */
void conic_light_map_place(const conic_casters *casters, const conic_receivers *receivers, const double direction[3],
                           double texel, int most, conic_camera *camera, double *near_z, conic_light_map *map);

#endif
