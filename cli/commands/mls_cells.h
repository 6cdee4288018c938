/* conic mls project by cells: for sets and files of any size, to a file. */
#ifndef CONIC_MLS_CELLS_H
#define CONIC_MLS_CELLS_H

#include "cli/session.h"

/* Projects the points of `points`, or, if that is null, of the file `input` with its `columns`, and writes them.
 * *work_seconds is the time before writing. Writes nothing if no point is left. */
conic_status cli_mls_clean(cli_session *session, const conic_clean_options *options, const conic_splats *points,
                           const char *input, const char *columns, const char *output, conic_surface_report *report,
                           double *work_seconds);

#endif
