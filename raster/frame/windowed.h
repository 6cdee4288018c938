/* What of a chunk a window of the picture needs, and what of it another window counts. */
#ifndef CONIC_WINDOWED_H
#define CONIC_WINDOWED_H

#include "raster/project/projected.h"
#include "raster/view/part.h"

/* Drops the records of a chunk, alone in `projected`, that do not meet the window, and moves the boxes of the others to
 * where the window begins, cut off at its ends. */
void conic_chunk_keep_window(const conic_window *window, conic_projected *projected, conic_chunk *chunk);

/* Adds to `sum` what the chunk of the splats from `begin` to before `end`, as it was projected, counts of those that
 * are not counted. */
void conic_chunk_count_others(const conic_view *view, const conic_splats *splats, size_t begin, size_t end,
                              const unsigned char *is_counted, const conic_projected *projected,
                              const conic_chunk *chunk, conic_chunk *sum);

#endif
