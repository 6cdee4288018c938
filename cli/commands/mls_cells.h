/* conic mls project by cells: from a set or a file of any size to a file. */
#ifndef CONIC_MLS_CELLS_H
#define CONIC_MLS_CELLS_H

#include "cli/session.h"

/* Projects the points of `points`, or where that is null those of the file `input` with its `columns`, and writes them;
 * *work_seconds is what it took until they were written. With no point left to write nothing is. */
conic_status cli_mls_clean(cli_session *session, const conic_clean_options *options, const conic_splats *points,
                           const char *input, const char *columns, const char *output, conic_surface_report *report,
                           double *work_seconds);

#endif
