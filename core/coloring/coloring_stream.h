/* Colours for points that come in batches: the range is found in a first pass. */
#ifndef CONIC_COLORING_STREAM_H
#define CONIC_COLORING_STREAM_H

#include "conic/coloring.h"
#include "core/coloring/value_limits.h"

/* Whether the ends of the ramp are to be found: not given, and neither of normals nor of classes. */
int conic_coloring_needs_range(const conic_coloring_options *options);

/* Adds what a batch's colours are to be made of, a field or the height. */
void conic_coloring_sample(const conic_coloring_options *options, const conic_splats *batch,
                           conic_value_sample *sample);

#endif
