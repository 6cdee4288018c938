/* The reader of text with a point a line: XYZ, PTS, CSV and whatever else people call it. docs/reference/formats.md
 * says what is understood.
 *
 * The lines before the first point (names of columns, the number of points) and the first 256 points tell the dialect
 * (core/formats/text_dialect.h) and the columns (core/formats/text_columns.h). The rest is read line by line. A colour
 * is sRGB-encoded; the largest value of the whole file tells whether it is a fraction of 1, a code of 8 bits or one of
 * 16 (core/splats/raw_colors.h). Positions are kept in double, from the first finite one as the origin. */
#ifndef CONIC_XYZ_H
#define CONIC_XYZ_H

#include "conic/model.h"
#include "core/files/input.h"
#include "core/splats/builder.h"

/* Whether text begins like such a file: with numbers, after comments and names of columns. */
int conic_xyz_is_likely(const char *bytes, size_t n);

/* Reads a model from the start of the file; with a delivery the points go there. On failure *model is for the caller to
 * release. Errors: ARGUMENT (the options' columns), INPUT, MEMORY, CANCELLED, the receiver's. */
conic_status conic_xyz_read(conic_input *input, const conic_read_options *options, const conic_delivery *delivery,
                            conic_model *model);

#endif
