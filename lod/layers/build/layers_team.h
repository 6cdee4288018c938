/* Building one layered cloud by several processes, which all see the same disk: each takes in a part of the samples,
 * and grows a part of the tree. The file is the one that one process makes of all samples, those of the first process
 * first. */
#ifndef CONIC_LAYERS_TEAM_H
#define CONIC_LAYERS_TEAM_H

#include "conic/layers.h"
#include "core/base/team.h"

/* As conic_layers_builder_open, in every process of a team, which may be null. Each appends its own samples, and then
 * all finish. Whoever has failed abandons the builder, at which the others fail when they finish, with CANCELLED. The
 * statistics are whole in the first process. Collective: where it fails in one process, it does in all. */
conic_status conic_layers_builder_open_team(conic_context *context, const char *path,
                                            const conic_layers_options *options, const conic_team *team,
                                            conic_layers_builder **builder);

/* Whether all samples have colours, as the first batch of all has them; `batch` is the first one of this process, and
 * may have to wait for the processes before. Errors: MEMORY, CANCELLED. */
conic_status conic_layers_builder_meet(conic_layers_builder *builder, const conic_splats *batch, int *has_colors);

#endif
