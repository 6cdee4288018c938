/* The arrays behind the 256 bytes of core/files/file_header.h: each begins at a multiple of 64 bytes, with zeros
 * between. The header has the sum of their sums. */
#ifndef CONIC_FILE_BODY_H
#define CONIC_FILE_BODY_H

#include <stdio.h>

#include "core/files/file_header.h"
#include "core/files/mapping.h"

enum { CONIC_FILE_MOST_ARRAYS = 40 };

/* The members of an array's records, in bytes: "4" for floats, "1" for bytes, "422444444" …. The sizes add up to a
 * power of two. */
typedef const char *conic_file_record;

typedef struct conic_file_array {
  size_t offset, n_bytes;
  conic_file_record record;
} conic_file_array;

/* The places of all arrays. Begins as {.n_bytes = CONIC_FILE_HEADER_BYTES}. */
typedef struct conic_file_layout {
  int n;
  conic_file_array arrays[CONIC_FILE_MOST_ARRAYS];
  size_t n_bytes; /* of the whole file */
} conic_file_layout;

void conic_file_add_array(conic_file_layout *layout, size_t n_bytes, conic_file_record record);

/* Finds the arrays in the bytes of a whole file. */
void conic_file_list_arrays(const conic_file_layout *layout, const unsigned char *bytes,
                            const void *arrays[CONIC_FILE_MOST_ARRAYS]);

/* The sum over the sums of arrays in memory. */
uint64_t conic_file_sum_arrays(conic_context *context, const conic_file_layout *layout, const void *const *arrays);
/* The same of the arrays in the bytes of a whole file; without a context, on this thread. */
uint64_t conic_file_sum_bytes(conic_context *context, const conic_file_layout *layout, const unsigned char *bytes);

/* Writes a file of header and arrays. Errors: MEMORY, IO, CANCELLED. */
conic_status conic_file_write_arrays(conic_context *context, const char *path, const conic_file_kind *kind,
                                     const void *numbers, const conic_file_layout *layout, const void *const *arrays);

/* Writes header and arrays to a stream, whose owner checks for failures. Errors: CANCELLED. */
conic_status conic_file_put_arrays(conic_context *context, FILE *stream, const conic_file_kind *kind,
                                   const void *numbers, const conic_file_layout *layout, const void *const *arrays);

/* Turns the arrays in a file's bytes between the file's byte order and the machine's. */
void conic_file_turn_arrays(const conic_file_layout *layout, unsigned char *bytes);

/* Checks that the file has the length of its layout, zeros between its arrays, and that sum. The arrays can then be
 * used where they are: if the byte orders differ, the mapping, which is private, is converted in place. Errors:
 * INPUT. */
conic_status conic_file_take_arrays(conic_context *context, const char *path, conic_mapping *file,
                                    const conic_file_layout *layout, uint64_t sum);

#endif
