/* Directions of a sky over a team (core/base/team.h). */
#ifndef CONIC_SKY_TEAM_H
#define CONIC_SKY_TEAM_H

#include "core/base/team.h"
#include "lighting/lit_map.h"

/* Collective: of every receiver the part of what faces it that is visible to it, as conic_sky_sums_add and
 * conic_sky_sums_share have it. Each process draws some of the directions, and adds up those of all, in their order,
 * for some of the receivers. Errors: MEMORY, CANCELLED, the drawer's. */
conic_status conic_sky_share_visible(conic_map_room *room, const conic_lighting_options *options,
                                     const conic_team *team, float *visible);

#endif
