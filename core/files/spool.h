/* Bytes that are stored and read again: in memory up to a bound, then in a file, except for the last ones. */
#pragma once

#include "core/files/scratch.h"

enum { CONIC_SPOOL_SLAB = 1 << 18 };

typedef struct conic_spool {
  conic_context *context;
  const char *path;     /* the file lies beside it; for messages too */
  conic_scratch file;   /* not open: everything is in memory */
  uint64_t file_bytes;  /* so many first bytes are in the file, the others in `held` */
  unsigned char **held; /* slabs of CONIC_SPOOL_SLAB bytes */
  size_t n_slabs, slab_room, n_held, most_held;
} conic_spool;

/* `path` must outlive the spool. Takes no memory yet. */
void conic_spool_begin(conic_context *context, const char *path, size_t memory_bytes, conic_spool *spool);
void conic_spool_end(conic_spool *spool);

/* Errors: MEMORY, IO. */
conic_status conic_spool_append(conic_spool *spool, const void *bytes, size_t n_bytes);

/* Copies bytes that were appended. Several threads may read while none appends. Errors: IO. */
conic_status conic_spool_read(const conic_spool *spool, uint64_t offset, void *bytes, size_t n_bytes);

static inline uint64_t conic_spool_bytes(const conic_spool *spool) {
  return spool->file_bytes + spool->n_held;
}
