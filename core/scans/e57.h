/* E57 (ASTM E2807): scans of one or more stations, each with its pose. */
#ifndef CONIC_E57_H
#define CONIC_E57_H

#include "core/files/input.h"
#include "core/splats/builder.h"

/* Whether a file with these first bytes is an E57. */
int conic_e57_is(const char *bytes, size_t n);

/* Reads all scans, each moved and turned by its pose, without points that were not measured. Colours are delivered as
 * codes of 16 bits. On failure *model is for the caller to release. Errors: INPUT, MEMORY, UNSUPPORTED, CANCELLED. */
conic_status conic_e57_read(conic_input *input, const conic_read_options *options, const conic_delivery *delivery,
                            conic_model *model);

#endif
