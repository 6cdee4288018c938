/* Windows of a picture: the records of a chunk that a window needs, and those that another window counts. */
#ifndef CONIC_WINDOWED_H
#define CONIC_WINDOWED_H

#include "raster/project/projected.h"
#include "raster/view/part.h"

/* Drops the records of a chunk that do not meet the window. The boxes of the others are cut off at the window's ends,
 * and then count from where it begins. The chunk is alone in `projected`. */
void conic_chunk_keep_window(const conic_window *window, conic_projected *projected, conic_chunk *chunk);

/* Adds to `sum` the counts of those splats from `begin` to before `end` that `is_counted` leaves to another window.
 * `chunk` has been projected from these splats. */
void conic_chunk_count_others(const conic_view *view, const conic_splats *splats, size_t begin, size_t end,
                              const unsigned char *is_counted, const conic_projected *projected,
                              const conic_chunk *chunk, conic_chunk *sum);

#endif
