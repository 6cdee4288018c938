#include "surface/store.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "core/base/memory.h"
#include "core/base/message.h"

static conic_status complain(const conic_store *store, const char *what) {
  return conic_fail(store->context, CONIC_ERROR_IO, "%s: %s of what is put aside beside it failed: %s", store->path,
                    what, strerror(errno));
}

/* The file has lost its name before anything is in it: the system takes it away however the program ends. */
static conic_status open_file(conic_store *store) {
  static const char ending[] = ".cells-XXXXXX";
  size_t length = strlen(store->path);
  char *name = conic_memory_allocate(store->context, length + sizeof ending, 1);
  if (!name)
    return CONIC_ERROR_MEMORY;
  memcpy(name, store->path, length);
  memcpy(name + length, ending, sizeof ending);
  store->descriptor = mkstemp(name);
  conic_status status = store->descriptor < 0 ? complain(store, "making a file") : CONIC_OK;
  if (status == CONIC_OK)
    unlink(name);
  conic_memory_release(store->context, name);
  return status;
}

conic_status conic_store_begin(conic_context *context, const char *path, uint64_t count, size_t record_bytes,
                               conic_store *store) {
  *store = (conic_store){context, path, record_bytes, NULL, -1};
  if (path)
    return open_file(store);
  store->memory = conic_memory_allocate(context, (size_t)count, record_bytes);
  return store->memory ? CONIC_OK : CONIC_ERROR_MEMORY;
}

void conic_store_end(conic_store *store) {
  if (store->memory)
    conic_memory_release(store->context, store->memory);
  if (store->context && store->descriptor >= 0)
    close(store->descriptor);
  memset(store, 0, sizeof *store);
  store->descriptor = -1;
}

conic_status conic_store_write(conic_store *store, uint64_t first, size_t n, const void *records) {
  const unsigned char *bytes = records;
  size_t n_bytes = n * store->record_bytes;
  uint64_t at = first * store->record_bytes;
  if (store->memory) {
    memcpy(store->memory + at, bytes, n_bytes);
    return CONIC_OK;
  }
  while (n_bytes > 0) {
    ssize_t written = pwrite(store->descriptor, bytes, n_bytes, (off_t)at);
    if (written < 0 && errno == EINTR)
      continue;
    if (written <= 0)
      return complain(store, "writing");
    bytes += written;
    at += (uint64_t)written;
    n_bytes -= (size_t)written;
  }
  return CONIC_OK;
}

conic_status conic_store_read(const conic_store *store, uint64_t first, size_t n, void *records) {
  unsigned char *bytes = records;
  size_t n_bytes = n * store->record_bytes;
  uint64_t at = first * store->record_bytes;
  if (store->memory) {
    memcpy(bytes, store->memory + at, n_bytes);
    return CONIC_OK;
  }
  while (n_bytes > 0) {
    ssize_t got = pread(store->descriptor, bytes, n_bytes, (off_t)at);
    if (got < 0 && errno == EINTR)
      continue;
    if (got <= 0)
      return complain(store, "reading");
    bytes += got;
    at += (uint64_t)got;
    n_bytes -= (size_t)got;
  }
  return CONIC_OK;
}
