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
  unsigned char *copy; /* of a file from a pipe; else null */
  const unsigned char *bytes;
  uint64_t n_bytes;
  uint64_t page_bytes, xml_offset, xml_bytes; /* where the XML begins in the file, and how long it is */
  uint64_t sound_page;                        /* the last page whose sum was right; UINT64_MAX: none was checked */
} conic_e57_file;

/* Opens the file at the start of an input, which is not read any further afterwards. On success the caller closes it;
 * on failure it is closed. Errors: INPUT, MEMORY, CANCELLED. */
conic_status conic_e57_file_open(conic_input *input, conic_e57_file *file);
void conic_e57_file_close(conic_e57_file *file);

/* Copies n bytes of content from *offset in the file, and moves *offset past them. Skips the sums of pages, and checks
 * them. Errors: INPUT. */
conic_status conic_e57_file_take(conic_e57_file *file, uint64_t *offset, void *to, size_t n);

/* The same without a copy. */
conic_status conic_e57_file_skip(conic_e57_file *file, uint64_t *offset, uint64_t n);

/* Corrects the sums of a file's pages, for tests and fuzzing, which the sums would otherwise stop. */
void conic_e57_mend(unsigned char *bytes, size_t n_bytes);

/* Logs "FILE: what (at byte N)" and returns INPUT. */
conic_status conic_e57_wrong(const conic_e57_file *file, const char *what, uint64_t at);

#endif
