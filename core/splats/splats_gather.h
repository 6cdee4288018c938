/* What the library does with splat sets besides the public functions. */
#ifndef CONIC_SPLATS_GATHER_H
#define CONIC_SPLATS_GATHER_H

#include "conic/splats.h"

/* A new set whose splat i is splat sources[i] of `from`; without clip lines. On failure *gathered is empty.
 * Errors: MEMORY. */
conic_status conic_splats_gather(conic_context *context, const conic_splats *from, const uint32_t *sources,
                                 size_t count, conic_splats *gathered);

#endif
