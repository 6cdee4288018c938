/* Plain rows of a PLY file, read by all threads. */
#pragma once

#include "core/formats/ply_source.h"

/* Fewer are not worth it. */
enum { CONIC_PLY_SHARED_ROWS = 1 << 14 };

typedef struct conic_ply_taker {
  /* Takes n rows, the first of which is the `first` of those that are shared. `room` is the thread's own. */
  void (*take)(void *data, const unsigned char *bytes, size_t n, size_t first, void *room);
  void *data;
  size_t room_bytes;
} conic_ply_taker;

/* Reads the next n rows of a file that has_size, or those that surely are there, in any order; all that needs an order
 * is done by then. The source's i_row tells how far that was. A file that another program cuts meanwhile is left to who
 * reads on, from the same row. Errors: INPUT, MEMORY, CANCELLED. */
conic_status conic_ply_share_rows(conic_ply_source *source, uint64_t n, const conic_ply_taker *taker);
