/* Normals of points that have none: across the neighbours' plane, and all of a surface on one side. */
#ifndef CONIC_NORMALS_H
#define CONIC_NORMALS_H

#include "core/estimate/neighbourhood.h"

/* Gives every slot that is GUESSED (and LISTED) its normal: the direction in which the slot and its neighbours spread
 * least, up to the sign. Errors: CANCELLED. */
conic_status conic_normals_guess(conic_context *context, conic_neighbourhood *neighbourhood, double from, double to);

/* Gives the GUESSED normals the sign that turns them to where their points were seen from, where that is clear; they
 * are then GUESSED no more. */
void conic_normals_turn_to_sights(conic_neighbourhood *neighbourhood, float *const sight[3]);

/* Settles the signs of the GUESSED normals along the most trustworthy links between neighbours (a minimum spanning
 * tree): like the given normals where a surface has some; else outwards, as seen from the middle of what hangs
 * together. Errors: MEMORY. */
conic_status conic_normals_orient(conic_context *context, conic_neighbourhood *neighbourhood);

#endif
