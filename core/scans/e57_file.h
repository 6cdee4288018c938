/* The bytes of an E57 file (ASTM E2807): pages whose last four bytes are the checksum of the others. */
#ifndef CONIC_E57_FILE_H
#define CONIC_E57_FILE_H

#include <stddef.h>
#include <stdint.h>

#include "core/files/input.h"
#include "core/files/mapping.h"

typedef struct conic_e57_file {
  conic_context *context;
  const char *name; /* for messages */
  conic_mapping mapping;
  unsigned char *copy; /* of a file that comes through a pipe; else null */
  const unsigned char *bytes;
  uint64_t n_bytes;
  uint64_t page_bytes, xml_offset, xml_bytes; /* of the XML: where it begins, in the file; and how long it is */
  uint64_t sound_page;                        /* the last whose sum was right; UINT64_MAX: none was looked at */
} conic_e57_file;

/* From the start of an input, which is not read on afterwards. On success the caller closes it; on failure it is
 * closed. Errors: INPUT, MEMORY, CANCELLED. */
conic_status conic_e57_file_open(conic_input *input, conic_e57_file *file);
void conic_e57_file_close(conic_e57_file *file);

/* Copies n bytes of content from *offset, in the file, on and moves it past them, over the sums of pages, which are
 * checked. Errors: INPUT. */
conic_status conic_e57_file_take(conic_e57_file *file, uint64_t *offset, void *to, size_t n);

/* The same without a copy. */
conic_status conic_e57_file_skip(conic_e57_file *file, uint64_t *offset, uint64_t n);

/* Makes the sums of a file's pages right, for tests and fuzzing, which would else see no further than these. */
void conic_e57_mend(unsigned char *bytes, size_t n_bytes);

/* Logs "FILE: what (at byte N)" and returns INPUT. */
conic_status conic_e57_wrong(const conic_e57_file *file, const char *what, uint64_t at);

#endif
