/* The six sides of the cube that a lamp sees, and the map of each. */
#ifndef CONIC_LAMP_MAP_H
#define CONIC_LAMP_MAP_H

#include "lighting/light_map.h"

enum { CONIC_LAMP_SIDES = 6, CONIC_NO_SIDE = 6 };

/* The extent of the points on side 2·axis, or 2·axis + 1 towards lower coordinates. */
typedef struct conic_lamp_side {
  size_t count;
  double low[2], high[2]; /* of x/z and y/z in the side's camera space */
  double nearest, farthest, sum_z;
} conic_lamp_side;

/* The side that a point is on; positions are measured from the lamp's place. */
int conic_lamp_side_of(const float position[3]);

void conic_lamp_side_init(conic_lamp_side *side);
/* Adds a point that lies on the side. */
void conic_lamp_side_add(conic_lamp_side *side, int i_side, const float position[3]);
/* Adds the extent of another. */
void conic_lamp_side_join(conic_lamp_side *side, const conic_lamp_side *other);

/* Places a map for all points on a side, at least one, of a lamp in the world; leaves map->z. `texel` is in world
 * units, at the points' mean z; it grows where the map would be larger than `most`. */
void conic_lamp_map_place(double epsilon, const double place[3], int i_side, const conic_lamp_side *side, double texel,
                          int most, conic_camera *camera, double *near_z, conic_light_map *map);

#endif
