/* Normals for points that have none: across the neighbours' plane, with one side for a whole surface. */
#ifndef CONIC_NORMALS_H
#define CONIC_NORMALS_H

#include "core/estimate/neighbourhood.h"

/* Gives every GUESSED (and LISTED) slot its normal, up to the sign: the direction in which the slot and its neighbours
 * spread least. Errors: CANCELLED. */
conic_status conic_normals_guess(conic_context *context, conic_neighbourhood *neighbourhood, double from, double to);

/* Turns GUESSED normals to where their points were seen from, where that is clear; these are then no longer GUESSED. */
void conic_normals_turn_to_sights(conic_neighbourhood *neighbourhood, float *const sight[3]);

/* Settles the signs of the GUESSED normals along the most reliable links between neighbours (a minimum spanning tree):
 * like the given normals where a surface has some; else outwards, as seen from the middle of the connected part.
 * Errors: MEMORY. */
conic_status conic_normals_orient(conic_context *context, conic_neighbourhood *neighbourhood);

#endif
