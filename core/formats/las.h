/* The LAS reader: versions 1.0 to 1.5, point formats 0 to 10, as they are or packed (LAZ: core/laz).
 *
 * Positions are the file's integers times its scale. The origin is the first point's position in double, so that map
 * coordinates lose nothing. Colours are meant to have 16 bits, yet many programs store 8-bit codes: the values of the
 * whole file tell (core/splats/raw_colors.h). One other field of the points can be read as a scalar
 * (core/formats/las_fields.h). Other variable-length records, and everything after the points, are skipped. Wrong
 * counts of points and records are logged, and the existing ones are read. */
#ifndef CONIC_LAS_H
#define CONIC_LAS_H

#include "conic/model.h"
#include "core/files/input.h"
#include "core/formats/model_part.h"
#include "core/splats/builder.h"

/* Reads a model from the start of the file; with a delivery, the points go there. On failure *model is for the caller
 * to release. Errors: INPUT, MEMORY, CANCELLED, the receiver's. */
conic_status conic_las_read(conic_input *input, const conic_read_options *options, const conic_delivery *delivery,
                            conic_model *model);

/* Reads the shape from the header of a file at its start. Errors: INPUT, CANCELLED. */
conic_status conic_las_look(conic_input *input, conic_model_shape *shape);

#endif
