/* The samples of a mean, by several processes. */
#pragma once

#include "shots/stage.h"

/* Collective: conic_accumulate by all, after which the first process has the sums; the others' are empty. The work's
 * keeper keeps what there is at every power of two. Errors: as conic_accumulate. */
conic_status conic_accumulate_together(const conic_shot_work *work, const conic_accumulate_options *options,
                                       conic_accumulation *sums);
