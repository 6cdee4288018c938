/* Files that are mapped and used where they are: a header of 256 bytes, then arrays, each from a multiple of 64 bytes
 * on, with zeros between. The header has the sum of the arrays' sums. */
#pragma once

#include <stddef.h>
#include <stdio.h>

#include "conic/context.h"
#include "core/files/mapping.h"

/* Structures in files: members in the order of a table, little-endian, one after the other. One table serves reading
 * and writing, so that they cannot differ. */

/* A member, by its place in memory. */
typedef struct conic_file_field {
  size_t offset, n_bytes, word_bytes; /* word_bytes: turned round together; an array has several words */
} conic_file_field;

#define CONIC_FILE_FIELD(type, member)                                                                                 \
  { offsetof(type, member), sizeof(((type *)0)->member), __alignof__(((type *)0)->member) }

/* The bytes that so many fields take in a file. */
size_t conic_file_fields_bytes(const conic_file_field *fields, size_t n);

void conic_file_fields_write(const conic_file_field *fields, size_t n, const void *from, unsigned char *bytes);
void conic_file_fields_read(const conic_file_field *fields, size_t n, const unsigned char *bytes, void *to);

/* The 256 bytes at the start: eight bytes that name the kind of file, numbers, zeros, and the sum of all that. */

enum { CONIC_FILE_HEADER_BYTES = 256 };

typedef struct conic_file_kind {
  unsigned char magic[8];
  const char *ending; /* with the dot */
  uint32_t version;
  const conic_file_field *fields; /* the first is the version, a uint32_t */
  size_t n_fields;
  const char *(*fault)(const void *numbers); /* what is wrong in a header whose sum is right; or null */
  const char *made_by; /* what makes it again, where files of an older version may be about; null: none are */
} conic_file_kind;

/* Whether a regular file that can be read begins as this kind does. */
int conic_file_is_of_kind(const conic_file_kind *kind, const char *path);

void conic_file_make_header(const conic_file_kind *kind, const void *numbers,
                            unsigned char bytes[CONIC_FILE_HEADER_BYTES]);

/* Opens a file of that kind and reads its numbers. The caller closes the file, on failure too. Errors: UNSUPPORTED,
 * INPUT, MEMORY. */
conic_status conic_file_open_kind(conic_context *context, const char *path, const conic_file_kind *kind,
                                  conic_mapping *file, void *numbers);

/* Reads the numbers from the first n_bytes of a file. Errors: UNSUPPORTED, INPUT. */
conic_status conic_file_read_header(conic_context *context, const char *path, const conic_file_kind *kind,
                                    const unsigned char *bytes, size_t n_bytes, void *numbers);

/* Writes the numbers and the sum into a file's header and leaves the rest; without numbers, only the sum. For tests and
 * fuzzing, which the sums would otherwise stop. */
void conic_file_mend_header(const conic_file_kind *kind, const void *numbers, unsigned char *bytes);

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
