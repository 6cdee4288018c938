/* The 256 bytes at the start of files that are mapped and used where they are: eight bytes that name the kind of file,
 * numbers, zeros, and the sum of all that. */
#ifndef CONIC_FILE_HEADER_H
#define CONIC_FILE_HEADER_H

#include "conic/context.h"
#include "core/files/file_fields.h"
#include "core/files/mapping.h"

enum { CONIC_FILE_HEADER_BYTES = 256 };

typedef struct conic_file_kind {
  unsigned char magic[8];
  const char *ending; /* with the dot */
  uint32_t version;
  const conic_file_field *fields; /* the first is the version, a uint32_t */
  size_t n_fields;
  const char *(*fault)(const void *numbers); /* what is wrong in a header whose sum is right; or null */
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

#endif
