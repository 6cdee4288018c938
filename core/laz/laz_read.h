/* The points of a LAZ file, chunk after chunk: many at a time on all threads where the file's table says where they
 * are. */
#ifndef CONIC_LAZ_READ_H
#define CONIC_LAZ_READ_H

#include "core/files/input.h"
#include "core/laz/laz.h"

/* Takes records, which are valid during the call only. An answer other than CONIC_OK ends the reading with it. */
typedef conic_status conic_laz_receiver(void *cookie, const unsigned char *records, size_t n);

/* Of n_points from where the input stands, which is the offset of the points that the header states, hands over those
 * from number `first` to before `end` in their order. A file that ends early is read as far as its chunks are whole,
 * which is told unless `is_again`; so is one whose table is missing. A pipe is kept in memory. Errors: INPUT (a chunk
 * is spoiled, or there are no points), MEMORY, CANCELLED, the receiver's. */
conic_status conic_laz_read(conic_input *input, const conic_laz_format *format, uint64_t n_points, uint64_t first,
                            uint64_t end, unsigned wanted, int is_again, conic_laz_receiver *receive, void *cookie);

#endif
