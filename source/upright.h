/* Which way up a model stands, if its shape tells. */
#pragma once

#include "conic/source.h"
#include "core/splats/shares.h"

/* What speaks for +z against +y (CONIC_UP_HABIT: nothing), and the mean of the normals by area, as they are and all
 * turned to +z: 0 where it says nothing. Looks at some 20,000 splats and triangles. Collective where the splats are
 * shared; there are no triangles then. Errors: MEMORY, CANCELLED. */
conic_status conic_upright_look(conic_context *context, const conic_splats_shares *shares, const conic_drawing *drawing,
                                conic_up_basis *basis, double fronts[2][3]);
