#include "surface/store.h"

#include <string.h>

#include "core/base/memory.h"

conic_status conic_store_begin(conic_context *context, const char *path, uint64_t count, size_t record_bytes,
                               conic_store *store) {
  *store = (conic_store){.context = context, .record_bytes = record_bytes, .file.descriptor = -1};
  if (path)
    return conic_scratch_open(context, path, &store->file);
  store->memory = conic_memory_allocate(context, (size_t)count, record_bytes);
  return store->memory ? CONIC_OK : CONIC_ERROR_MEMORY;
}

void conic_store_end(conic_store *store) {
  conic_memory_release(store->context, store->memory);
  conic_scratch_close(&store->file);
  store->memory = NULL;
}

conic_status conic_store_write(conic_store *store, uint64_t first, size_t n, const void *records) {
  uint64_t at = first * store->record_bytes;
  if (!store->memory)
    return conic_scratch_write(&store->file, at, records, n * store->record_bytes);
  memcpy(store->memory + at, records, n * store->record_bytes);
  return CONIC_OK;
}

conic_status conic_store_read(const conic_store *store, uint64_t first, size_t n, void *records) {
  uint64_t at = first * store->record_bytes;
  if (!store->memory)
    return conic_scratch_read(&store->file, at, records, n * store->record_bytes);
  memcpy(records, store->memory + at, n * store->record_bytes);
  return CONIC_OK;
}
