/* The samples of one picture over a team's processes. */
#ifndef CONIC_ACCUMULATE_TEAM_H
#define CONIC_ACCUMULATE_TEAM_H

#include "cli/scene/render_job.h"

/* What the first process does with the sums whenever they are together. */
typedef conic_status cli_sums_keeper(void *cookie, const conic_accumulation *sums);

/* Collective: conic_accumulate for sums that the first process has, perhaps with samples, and all others without any.
 * Every process adds to its own sums the samples that it is given, and they come together where it is decided whether
 * they are enough: so for the same samples there are the same bits. At the end the first process has all. `keep` may be
 * null. */
conic_status cli_accumulate_together(cli_session *session, cli_render_job *job, const conic_accumulate_options *options,
                                     cli_sums_keeper *keep, conic_accumulation *sums);

#endif
