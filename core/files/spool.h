/* Bytes that are put aside and read again: in memory up to a bound, beyond it in a file, but for the last. */
#ifndef CONIC_SPOOL_H
#define CONIC_SPOOL_H

#include <stddef.h>
#include <stdint.h>

#include "conic/context.h"
#include "core/files/scratch.h"

enum { CONIC_SPOOL_SLAB = 1 << 18 };

typedef struct conic_spool {
  conic_context *context;
  const char *path;     /* beside which the file lies; for messages too */
  conic_scratch file;   /* not open: all is in memory */
  uint64_t file_bytes;  /* the first so many are in the file, the others in `held` */
  unsigned char **held; /* slabs of CONIC_SPOOL_SLAB bytes */
  size_t n_slabs, slab_room, n_held, most_held;
} conic_spool;

/* `path` must outlive the spool. Nothing is taken yet. */
void conic_spool_begin(conic_context *context, const char *path, size_t memory_bytes, conic_spool *spool);
void conic_spool_end(conic_spool *spool);

/* Errors: MEMORY, IO. */
conic_status conic_spool_append(conic_spool *spool, const void *bytes, size_t n_bytes);

/* Copies bytes that are there. Several threads may read while none appends. Errors: IO. */
conic_status conic_spool_read(const conic_spool *spool, uint64_t offset, void *bytes, size_t n_bytes);

static inline uint64_t conic_spool_bytes(const conic_spool *spool) {
  return spool->file_bytes + spool->n_held;
}

#endif
