/* The arrays behind the 256 bytes of core/files/file_header.h: each begins at a multiple of 64 bytes, with zeros
 * between. The header has the sum of their sums. */
#ifndef CONIC_FILE_BODY_H
#define CONIC_FILE_BODY_H

#include <stdio.h>

#include "core/files/file_header.h"
#include "core/files/mapping.h"

enum { CONIC_FILE_MOST_ARRAYS = 40 };

/* What an array's records are made of: the bytes of each member, "4" for floats, "1" for bytes, "422444444" … Several
 * members together are a power of two. */
typedef const char *conic_file_record;

typedef struct conic_file_array {
  size_t offset, n_bytes;
  conic_file_record record;
} conic_file_array;

/* Where everything is. Begins as {.n_bytes = CONIC_FILE_HEADER_BYTES}. */
typedef struct conic_file_layout {
  int n;
  conic_file_array arrays[CONIC_FILE_MOST_ARRAYS];
  size_t n_bytes; /* of the whole file */
} conic_file_layout;

void conic_file_add_array(conic_file_layout *layout, size_t n_bytes, conic_file_record record);

/* Where the arrays are in the bytes of a whole file. */
void conic_file_list_arrays(const conic_file_layout *layout, const unsigned char *bytes,
                            const void *arrays[CONIC_FILE_MOST_ARRAYS]);

/* The sum over the sums of arrays in memory. */
uint64_t conic_file_sum_arrays(conic_context *context, const conic_file_layout *layout, const void *const *arrays);
/* Over those in the bytes of a whole file; without a context, on this thread. */
uint64_t conic_file_sum_bytes(conic_context *context, const conic_file_layout *layout, const unsigned char *bytes);

/* Writes a file of header and arrays. Errors: MEMORY, IO, CANCELLED. */
conic_status conic_file_write_arrays(conic_context *context, const char *path, const conic_file_kind *kind,
                                     const void *numbers, const conic_file_layout *layout, const void *const *arrays);

/* Writes header and arrays to a stream, whose failures are seen by its owner. Errors: CANCELLED. */
conic_status conic_file_put_arrays(conic_context *context, FILE *stream, const conic_file_kind *kind,
                                   const void *numbers, const conic_file_layout *layout, const void *const *arrays);

/* Turns the arrays in the bytes of a file between its order and the machine's. */
void conic_file_turn_arrays(const conic_file_layout *layout, unsigned char *bytes);

/* Whether the file is as long as its layout tells, has nothing between its arrays, and has that sum. Then its arrays
 * can be used as they lie: where files are the other way round than memory, the mapping, which is private, is turned
 * around. Errors: INPUT. */
conic_status conic_file_take_arrays(conic_context *context, const char *path, conic_mapping *file,
                                    const conic_file_layout *layout, uint64_t sum);

#endif
