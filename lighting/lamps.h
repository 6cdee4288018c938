/* Lamps: the point that each shines from, how brightly, and what its light reaches. */
#pragma once

#include "lighting/lit_map.h"

/* The point that a lamp shines from. */
typedef struct conic_lamp_point {
  const conic_lamp *lamp;
  double place[3];  /* in the world */
  double normal[3]; /* of the lamp there, unit */
  int is_middle;    /* the middle of a sphere shines to all sides, a point of its surface to one */
  double nearest;   /* nearer places are lit as at this distance */
} conic_lamp_point;

/* What is wrong with the options' lamps; null: nothing. */
const char *conic_lamps_fault(const conic_lighting_options *options);

/* The point that a lamp shines from by the options, towards the scene around `onto`, for which the samples of a sphere
 * are chosen. */
void conic_lamp_shine(const conic_lamp *lamp, const conic_lighting_options *options, const double onto[3],
                      double nearest, conic_lamp_point *point);

/* The factor of the lamp's colour at a place of the world that faces it, and the unit direction from there to the
 * lamp. */
double conic_lamp_strength(const conic_lamp_point *point, const double at[3], double towards[3]);

/* How much of the lamp's light reaches each receiver unhidden, 0 to 1, into `visible`, with up to six maps. Errors:
 * MEMORY, the drawer's. */
conic_status conic_lamp_receive(conic_map_room *room, const conic_lamp_point *point, float *visible);
