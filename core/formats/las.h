/* The LAS reader: versions 1.0 to 1.5, point formats 0 to 10, as they are or packed (LAZ: core/laz).
 *
 * Positions are the file's integers times its scale; what the first point and the offset give in double is the origin,
 * so that map coordinates lose nothing. Colours are meant to have 16 bits, yet many programs store 8-bit codes: the
 * values of the whole file tell (core/splats/raw_colors.h). Of everything else that a point has one field can be read
 * (core/formats/las_fields.h); other variable-length records and whatever follows the points are passed over. Counts of
 * points and records that are off are told, and what is there is read. */
#ifndef CONIC_LAS_H
#define CONIC_LAS_H

#include "conic/model.h"
#include "core/files/input.h"
#include "core/formats/model_part.h"
#include "core/splats/builder.h"

/* Reads a model from the start of the file; with a delivery the points go there. On failure *model is for the caller to
 * release. Errors: INPUT, MEMORY, CANCELLED, the receiver's. */
conic_status conic_las_read(conic_input *input, const conic_read_options *options, const conic_delivery *delivery,
                            conic_model *model);

/* What the header says of a file that stands at its start. Errors: INPUT, CANCELLED. */
conic_status conic_las_look(conic_input *input, conic_model_shape *shape);

#endif
