/* Reads the points of a LAZ file chunk by chunk; many at once, on all threads, where the file's table says where they
 * are. */
#ifndef CONIC_LAZ_READ_H
#define CONIC_LAZ_READ_H

#include "core/files/input.h"
#include "core/laz/laz.h"

/* Takes records, which are valid during the call only. An answer other than CONIC_OK ends the reading with that
 * status. */
typedef conic_status conic_laz_receiver(void *cookie, const unsigned char *records, size_t n);

/* Hands over, in their order, the points from number `first` to before `end` of n_points. The input is at the offset of
 * the points in the header. A file that ends early is read as far as its chunks are whole; a file without its table is
 * read, too. Both are logged unless `is_again`. A pipe is kept in memory. Errors: INPUT (a chunk is spoiled, or there
 * are no points), MEMORY, CANCELLED, the receiver's. */
conic_status conic_laz_read(conic_input *input, const conic_laz_format *format, uint64_t n_points, uint64_t first,
                            uint64_t end, unsigned wanted, int is_again, conic_laz_receiver *receive, void *cookie);

#endif
