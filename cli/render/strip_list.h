/* Which strips of a picture processes draw, one after the other from the top. */
#ifndef CONIC_STRIP_LIST_H
#define CONIC_STRIP_LIST_H

#include "source/source_parts.h"

/* Strips over the whole width, of a multiple of `step` rows but where a band of the windows ends, and of `most_rows` at
 * most. For several processes the first are half of a process's share of the work, as far as it can be told, and the
 * later ones smaller and smaller, so that all end together. The caller frees *strips. Errors: MEMORY. */
conic_status cli_list_strips(const conic_source_windows *windows, int step, int most_rows, int n_processes,
                             conic_window **strips, size_t *n);

#endif
