/* Bytes that several threads at once append and read again, in a file without a name. */
#pragma once

#include <stdatomic.h>

#include "core/files/scratch.h"

typedef struct conic_pile {
  conic_scratch file;
  _Atomic uint64_t n_bytes;
} conic_pile;

/* The file lies beside `path`, which must outlive the pile. Errors: MEMORY, IO. */
static inline conic_status conic_pile_begin(conic_context *context, const char *path, conic_pile *pile) {
  atomic_init(&pile->n_bytes, 0);
  return conic_scratch_open(context, path, &pile->file);
}

/* Zero is allowed. */
static inline void conic_pile_end(conic_pile *pile) {
  conic_scratch_close(&pile->file);
}

/* Appends bytes; *at says where. Errors: IO. */
static inline conic_status conic_pile_append(conic_pile *pile, const void *bytes, size_t n_bytes, uint64_t *at) {
  *at = atomic_fetch_add_explicit(&pile->n_bytes, n_bytes, memory_order_relaxed);
  return conic_scratch_write(&pile->file, *at, bytes, n_bytes);
}

/* Copies bytes that were appended. Errors: IO. */
static inline conic_status conic_pile_read(const conic_pile *pile, uint64_t at, void *bytes, size_t n_bytes) {
  return conic_scratch_read(&pile->file, at, bytes, n_bytes);
}
