/* Samples of the surface of a source that hands nothing over. */
#ifndef CONIC_SOURCE_SAMPLES_H
#define CONIC_SOURCE_SAMPLES_H

#include "source/source_kind.h"

/* Discs about what is seen of it from six sides. On success the caller releases them. Errors: as conic_source_draw. */
conic_status conic_source_take_samples(conic_source *source, conic_splats *samples);

#endif
