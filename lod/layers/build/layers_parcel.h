/* A branch as bytes, on its way to another process of the same program, or to one that goes on later. */
#ifndef CONIC_LAYERS_PARCEL_H
#define CONIC_LAYERS_PARCEL_H

#include "lod/layers/build/layers_branch.h"

/* The branch and all that hangs on it. The caller releases *bytes, on failure too. Errors: MEMORY, IO. */
conic_status conic_layers_parcel_pack(const conic_layers_branch *branch, unsigned char **bytes, size_t *n_bytes);

/* The other way. Errors: INPUT (the bytes are no branch; nothing is said), MEMORY. */
conic_status conic_layers_parcel_unpack(conic_layers_waiting *waiting, const unsigned char *bytes, size_t n_bytes,
                                        conic_layers_branch **branch);

#endif
