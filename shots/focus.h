/* Where a lens is sharp. */
#pragma once

#include "conic/shot.h"

/* Whether that takes a look at the picture through the middle of the lens. */
int conic_focus_is_seen(const conic_shot *shot);

/* The depth at which the shot is sharp, by the plane Z of that picture, where it is looked at. Errors: ARGUMENT (the
 * pixel lies outside), MEMORY. */
conic_status conic_focus_find(conic_context *context, const conic_shot *shot, const conic_image *middle, double *depth);
