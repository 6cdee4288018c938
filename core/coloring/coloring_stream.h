/* Colours for points that come in batches; a first pass finds the range. */
#pragma once

#include "conic/coloring.h"
#include "core/coloring/value_limits.h"

/* Whether the ends of the ramp must be found: they are not given, and the ramp is neither of normals nor of classes. */
int conic_coloring_needs_range(const conic_coloring_options *options);

/* The meaning of colours made from a value of this name, which goes from the least to the greatest, mostly between the
 * typical two; `options` say more. Errors: ARGUMENT. */
conic_status conic_coloring_of_range(conic_context *context, const conic_coloring_options *options, const char *field,
                                     const double typical[2], double least, double greatest, conic_coloring *coloring);

/* Adds the values of a batch that its colours will be made of, a field's or the height. */
void conic_coloring_sample(const conic_coloring_options *options, const conic_splats *batch,
                           conic_value_sample *sample);
