#include "core/files/pile.h"

conic_status conic_pile_begin(conic_context *context, const char *path, conic_pile *pile) {
  atomic_init(&pile->n_bytes, 0);
  return conic_scratch_open(context, path, &pile->file);
}

void conic_pile_end(conic_pile *pile) {
  conic_scratch_close(&pile->file);
}

conic_status conic_pile_append(conic_pile *pile, const void *bytes, size_t n_bytes, uint64_t *at) {
  *at = atomic_fetch_add_explicit(&pile->n_bytes, n_bytes, memory_order_relaxed);
  return conic_scratch_write(&pile->file, *at, bytes, n_bytes);
}

conic_status conic_pile_read(const conic_pile *pile, uint64_t at, void *bytes, size_t n_bytes) {
  return conic_scratch_read(&pile->file, at, bytes, n_bytes);
}
