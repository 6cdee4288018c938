/* Bytes that several threads at once append and read again, in a file without a name. */
#ifndef CONIC_PILE_H
#define CONIC_PILE_H

#include <stdatomic.h>

#include "core/files/scratch.h"

typedef struct conic_pile {
  conic_scratch file;
  _Atomic uint64_t n_bytes;
} conic_pile;

/* The file lies beside `path`, which must outlive the pile. Errors: MEMORY, IO. */
conic_status conic_pile_begin(conic_context *context, const char *path, conic_pile *pile);
void conic_pile_end(conic_pile *pile); /* zero is allowed */

/* Appends bytes; *at says where. Errors: IO. */
conic_status conic_pile_append(conic_pile *pile, const void *bytes, size_t n_bytes, uint64_t *at);

/* Copies bytes that were appended. Errors: IO. */
conic_status conic_pile_read(const conic_pile *pile, uint64_t at, void *bytes, size_t n_bytes);

#endif
