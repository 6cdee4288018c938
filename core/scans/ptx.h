/* PTX: scans as text, each a grid of points as its scanner saw them, with its pose. */
#ifndef CONIC_PTX_H
#define CONIC_PTX_H

#include "core/files/input.h"
#include "core/splats/builder.h"

/* Whether the bytes begin like a PTX: two lines of one number each, then four of three numbers and four of four. */
int conic_ptx_is_likely(const char *bytes, size_t n);

/* Reads all scans, each moved and turned by its matrix, without places of the grid where nothing was measured. On
 * failure *model is for the caller to release. Errors: INPUT, MEMORY, CANCELLED. */
conic_status conic_ptx_read(conic_input *input, const conic_read_options *options, const conic_delivery *delivery,
                            conic_model *model);

#endif
