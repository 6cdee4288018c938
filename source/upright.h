/* Which way up a model stands, as far as its shape tells. */
#ifndef CONIC_UPRIGHT_H
#define CONIC_UPRIGHT_H

#include "conic/source.h"
#include "core/splats/shares.h"

/* What tells for +z against +y. CONIC_UP_HABIT: nothing does. Looks at some 20,000 splats and triangles.
 * Collective where the splats are shared; then there are no triangles. Errors: MEMORY, CANCELLED. */
conic_status conic_upright_look(conic_context *context, const conic_splats_shares *shares, const conic_drawing *drawing,
                                conic_up_basis *basis);

#endif
