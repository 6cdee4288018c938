/* Splats that change hands within a team. */
#ifndef CONIC_SPLAT_EXCHANGE_H
#define CONIC_SPLAT_EXCHANGE_H

#include "core/splats/shares.h"

/* Collective: process k gets the splats list[begin[k]] to list[begin[k + 1] - 1] of this one's `from`, which are in
 * their order. *to becomes what this process gets, and *ids the places that these have among all: in their order, too.
 * All have the same origin and the same of axes, colours and opacities; other arrays do not go along. On success the
 * caller releases both; on failure they are empty. Errors: MEMORY, CANCELLED. */
conic_status conic_splats_exchange(conic_context *context, const conic_splats_shares *shares, const conic_splats *from,
                                   const size_t *begin, const uint32_t *list, conic_splats *to, uint32_t **ids);

#endif
