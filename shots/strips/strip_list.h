/* Which strips of a picture processes draw, one after the other from the top. */
#pragma once

#include "source/source_parts.h"

/* Rows of the picture's whole width; kept ones are not drawn. */
typedef struct conic_strip {
  int32_t y_begin, y_end, is_kept;
} conic_strip;

/* All strips of a picture from the top: those that are kept, and between them others, of a multiple of `step` rows but
 * where a band of the windows or a kept strip ends, and of `most_rows` at most. For several processes the first are
 * half of a process's share of the work, as far as it can be told, and the later ones smaller and smaller, so that all
 * end together. The caller releases *strips through
 * the context's memory. Errors: MEMORY. */
conic_status conic_list_strips(const conic_source_windows *windows, const conic_strip *kept, size_t n_kept, int step,
                               int most_rows, int n_processes, conic_strip **strips, size_t *n);
