/* The 256 bytes that files begin with which are mapped and used as they lie: eight that say what the file is, numbers,
 * zeros, and the sum of all that. */
#ifndef CONIC_FILE_HEADER_H
#define CONIC_FILE_HEADER_H

#include "conic/context.h"
#include "core/files/file_fields.h"
#include "core/files/mapping.h"

enum { CONIC_FILE_HEADER_BYTES = 256 };

typedef struct conic_file_kind {
  unsigned char magic[8];
  const char *ending; /* with its dot */
  uint32_t version;
  const conic_file_field *fields; /* the first is the version, a uint32_t */
  size_t n_fields;
  const char *(*fault)(const void *numbers); /* what is wrong with a header whose sum is right, or null */
} conic_file_kind;

/* Whether a regular file that can be read begins like that. */
int conic_file_is_of_kind(const conic_file_kind *kind, const char *path);

void conic_file_make_header(const conic_file_kind *kind, const void *numbers,
                            unsigned char bytes[CONIC_FILE_HEADER_BYTES]);

/* Opens a file of that kind, which the caller closes, on failure too, and reads its numbers. Errors: UNSUPPORTED,
 * INPUT, MEMORY. */
conic_status conic_file_open_kind(conic_context *context, const char *path, const conic_file_kind *kind,
                                  conic_mapping *file, void *numbers);

/* Reads the numbers of the first bytes of a file, of which there are n_bytes. Errors: UNSUPPORTED, INPUT. */
conic_status conic_file_read_header(conic_context *context, const char *path, const conic_file_kind *kind,
                                    const unsigned char *bytes, size_t n_bytes, void *numbers);

/* Writes the numbers and the sum into a file's header and leaves the rest as it is; without numbers, only the sum. For
 * tests and fuzzing, which would else see no further than the sums. */
void conic_file_mend_header(const conic_file_kind *kind, const void *numbers, unsigned char *bytes);

#endif
