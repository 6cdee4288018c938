/* One picture over a team's processes, in windows. */
#ifndef CONIC_WINDOWS_TEAM_H
#define CONIC_WINDOWS_TEAM_H

#include "cli/render/gather_picture.h"

/* Collective: conic_source_draw, after which the first process has the picture and the statistics, to the bits of one
 * process. The others' image may be without planes, and stays as it is. */
conic_status cli_draw_together(cli_session *session, cli_render_job *job, const cli_looking *looking,
                               conic_image *image, conic_render_statistics *statistics);

#endif
