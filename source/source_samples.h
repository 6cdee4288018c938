/* Samples of the surface of a source that hands nothing over. */
#pragma once

#include "source/source_kind.h"

/* Takes discs of what is seen of the source from six sides. On success the caller releases them. Errors: as
 * conic_source_draw. */
conic_status conic_source_take_samples(conic_source *source, conic_splats *samples);

/* Limits the time for samples: from now on they show what arrives within so many seconds, and coarser parts for the
 * rest. */
void conic_source_limit_samples(conic_source *source, double seconds);

/* Collective, after each process of a team has opened the source, or failed with `status`: takes the samples that
 * conic_source_stand and conic_source_fit will use; each process takes those of some sides. Does nothing where the
 * source hands everything over, or the team is null. Errors: as those of conic_source_take_samples, CANCELLED. */
conic_status conic_source_share_samples(conic_source *source, const conic_team *team, conic_status status);
