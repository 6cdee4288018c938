/* Lamps: from where each shines, how brightly, and what it meets. */
#ifndef CONIC_LAMPS_H
#define CONIC_LAMPS_H

#include "lighting/lit_map.h"

/* The one point that a lamp shines from. */
typedef struct conic_lamp_point {
  const conic_lamp *lamp;
  double place[3];  /* in the world */
  double normal[3]; /* of the lamp there, unit */
  int is_middle;    /* which of a sphere shines to all sides, but its surface to one */
  double nearest;   /* what is nearer is lit as from that far */
} conic_lamp_point;

/* What is wrong with the options' lamps; null: nothing. */
const char *conic_lamps_fault(const conic_lighting_options *options);

/* Where a lamp shines from by the options, onto what lies about a place: of a ball, the samples tell best what is sent
 * there. */
void conic_lamp_shine(const conic_lamp *lamp, const conic_lighting_options *options, const double onto[3],
                      double nearest, conic_lamp_point *point);

/* What its colour is multiplied by at a place of the world that faces it, and the unit direction from there to it. */
double conic_lamp_strength(const conic_lamp_point *point, const double at[3], double towards[3]);

/* What of its light nothing hides from receivers, 0 to 1 each, by up to six maps, `visible`. Errors: MEMORY, the
 * drawer's. */
conic_status conic_lamp_receive(conic_map_room *room, const conic_lamp_point *point, float *visible);

#endif
