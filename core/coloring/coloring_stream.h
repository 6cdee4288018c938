/* Colours for points that come in batches: the range is found in a first pass. */
#ifndef CONIC_COLORING_STREAM_H
#define CONIC_COLORING_STREAM_H

#include "conic/coloring.h"
#include "core/coloring/value_limits.h"

/* Whether the ends of the ramp are to be found: not given, and neither of normals nor of classes. */
int conic_coloring_needs_range(const conic_coloring_options *options);

/* What colours mean that are made of a value of this name from the least to the greatest, most of it between the
 * typical two: `options` say more. Errors: ARGUMENT. */
conic_status conic_coloring_of_range(conic_context *context, const conic_coloring_options *options, const char *field,
                                     const double typical[2], double least, double greatest, conic_coloring *coloring);

/* Adds what a batch's colours are to be made of, a field or the height. */
void conic_coloring_sample(const conic_coloring_options *options, const conic_splats *batch,
                           conic_value_sample *sample);

#endif
