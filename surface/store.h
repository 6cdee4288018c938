/* Records of one size, in memory or in a file without a name. */
#ifndef CONIC_STORE_H
#define CONIC_STORE_H

#include <stddef.h>
#include <stdint.h>

#include "core/files/scratch.h"

typedef struct conic_store {
  conic_context *context;
  size_t record_bytes;
  unsigned char *memory; /* null: the records are in the file */
  conic_scratch file;
} conic_store;

/* Makes room for `count` records, contents undefined, in a file beside `path`, or for a null path in memory. On failure
 * the store is empty. Errors: MEMORY, IO. */
conic_status conic_store_begin(conic_context *context, const char *path, uint64_t count, size_t record_bytes,
                               conic_store *store);
void conic_store_end(conic_store *store);

/* Writes or reads the records from number `first` on. Errors: IO. */
conic_status conic_store_write(conic_store *store, uint64_t first, size_t n, const void *records);
conic_status conic_store_read(const conic_store *store, uint64_t first, size_t n, void *records);

#endif
