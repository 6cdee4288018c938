/* Splats that are sent between the processes of a team. */
#pragma once

#include "core/splats/shares.h"

/* Collective: process k gets the splats list[begin[k]] to list[begin[k + 1] - 1] of this process's `from`, in their
 * order. *to becomes the splats that this process gets, and *ids their places among all splats, both in order. All
 * processes have the same origin, and the same choice of axes, colours and opacities; other arrays are not sent. On
 * success the caller releases both; on failure they are empty. Errors: MEMORY, CANCELLED. */
conic_status conic_splats_exchange(conic_context *context, const conic_splats_shares *shares, const conic_splats *from,
                                   const size_t *begin, const uint32_t *list, conic_splats *to, uint32_t **ids);
