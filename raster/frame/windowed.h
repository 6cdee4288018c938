/* A chunk's splats in one window of the picture: which it needs, and which another window counts. */
#ifndef CONIC_WINDOWED_H
#define CONIC_WINDOWED_H

#include "raster/project/projected.h"
#include "raster/view/part.h"

/* The chunk is alone in `projected`. Drops its records that do not meet the window. The others' boxes are counted from
 * where the window begins, and cut off at its ends. */
void conic_chunk_keep_window(const conic_window *window, conic_projected *projected, conic_chunk *chunk);

/* The chunk has projected the splats from `begin` to before `end`, and has counted them all. Adds to `sum` the counts
 * of the splats whose `is_counted` is 0. */
void conic_chunk_count_others(const conic_view *view, const conic_splats *splats, size_t begin, size_t end,
                              const unsigned char *is_counted, const conic_projected *projected,
                              const conic_chunk *chunk, conic_chunk *sum);

#endif
