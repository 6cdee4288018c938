/* The box of all that a source draws. */
#pragma once

#include "shots/stage.h"

/* How far a splat of the source's usual size reaches from its centre; 0: it has none. */
double conic_splat_reach(const conic_shot_work *work);

/* The box of centres and corners, and what splats reach beyond it. */
void conic_find_reach(const conic_shot_work *work, double minimum[3], double maximum[3]);
