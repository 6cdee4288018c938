/* One picture over a team's processes, in windows. */
#ifndef CONIC_WINDOWS_TEAM_H
#define CONIC_WINDOWS_TEAM_H

#include "cli/render/gather_picture.h"
#include "cli/session_team.h"
#include "source/source_parts.h"

/* What windows are drawn of; other planes are made of these later. */
#define CLI_WINDOWS_PLANES                                                                                             \
  (CONIC_DRAWN_PLANES | 1u << CONIC_PLANE_CLUSTER | (CONIC_GAUSSIAN_PLANES & ~(1u << CONIC_PLANE_DOUBT)))

/* What a process has counted of the windows that it drew; zero at first. */
typedef struct cli_window_counts {
  uint64_t n_windows;
  conic_render_statistics statistics;
} cli_window_counts;

/* Collective, with a team: where the source deals out windows, who draws each of the list, which the caller frees, also
 * after a failure, that all then know; else null. */
conic_status cli_windows_deal(cli_session *session, conic_source_windows *windows, const conic_window *list, size_t n,
                              int is_in_order, int **owners);

void cli_windows_count(const conic_source_windows *windows, const conic_render_statistics *drawn,
                       cli_window_counts *counts);
/* Collective, with a team; once all are drawn. The first process's counts become the picture's. */
conic_status cli_windows_sum(cli_team *team, conic_source_windows *windows, cli_window_counts *counts);

/* Collective: conic_source_draw, after which the first process has the picture and the statistics, to the bits of one
 * process. The others' image may be without planes, and stays as it is. */
conic_status cli_draw_together(cli_session *session, cli_render_job *job, const cli_looking *looking,
                               conic_image *image, conic_render_statistics *statistics);

#endif
