#include "core/files/spool.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "core/base/memory.h"
#include "core/base/message.h"

void conic_spool_begin(conic_context *context, const char *path, size_t memory_bytes, conic_spool *spool) {
  memset(spool, 0, sizeof *spool);
  spool->context = context;
  spool->path = path;
  spool->descriptor = -1;
  spool->most_held = memory_bytes;
}

static void release_slabs(conic_spool *spool) {
  for (size_t i = 0; i < spool->n_slabs; i++)
    conic_memory_release(spool->context, spool->held[i]);
  conic_memory_release(spool->context, spool->held);
  spool->held = NULL;
  spool->n_slabs = spool->slab_room = spool->n_held = 0;
}

void conic_spool_end(conic_spool *spool) {
  if (!spool->context)
    return;
  if (spool->descriptor >= 0)
    close(spool->descriptor);
  release_slabs(spool);
  memset(spool, 0, sizeof *spool);
}

static conic_status cannot_write(const conic_spool *spool) {
  return conic_fail(spool->context, CONIC_ERROR_IO, "%s: cannot write a temporary file beside it: %s", spool->path,
                    strerror(errno));
}

/* Made beside PATH, so that it is on the disk that has to hold the result, and unlinked at once. */
static conic_status open_file(conic_spool *spool) {
  const char *slash = strrchr(spool->path, '/');
  int folder_length = slash ? (int)(slash - spool->path) + 1 : 0;
  size_t n = (size_t)folder_length + 64;
  char *name = conic_memory_allocate(spool->context, n, 1);
  if (!name)
    return CONIC_ERROR_MEMORY;
  for (int attempt = 0; attempt < 100 && spool->descriptor < 0; attempt++) {
    snprintf(name, n, "%.*s.conic-spool.%ld-%d", folder_length, spool->path, (long)getpid(), attempt);
    spool->descriptor = open(name, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
    if (spool->descriptor < 0 && errno != EEXIST)
      break;
  }
  conic_status status = spool->descriptor >= 0 ? CONIC_OK : cannot_write(spool);
  if (status == CONIC_OK)
    unlink(name);
  conic_memory_release(spool->context, name);
  return status;
}

static conic_status write_all(conic_spool *spool, const unsigned char *bytes, size_t n_bytes) {
  if (spool->descriptor < 0) {
    conic_status status = open_file(spool);
    if (status != CONIC_OK)
      return status;
  }
  while (n_bytes > 0) {
    ssize_t n = write(spool->descriptor, bytes, n_bytes);
    if (n < 0 && errno == EINTR)
      continue;
    if (n < 0)
      return cannot_write(spool);
    bytes += n;
    n_bytes -= (size_t)n;
    spool->file_bytes += (uint64_t)n;
  }
  return CONIC_OK;
}

/* Writes to the file what is held and gives its memory back. */
static conic_status flush(conic_spool *spool) {
  conic_status status = CONIC_OK;
  for (size_t i = 0, left = spool->n_held; left > 0 && status == CONIC_OK; i++) {
    size_t n = left < CONIC_SPOOL_SLAB ? left : CONIC_SPOOL_SLAB;
    status = write_all(spool, spool->held[i], n);
    left -= n;
  }
  release_slabs(spool);
  return status;
}

static conic_status add_slab(conic_spool *spool) {
  if (conic_memory_reserve(spool->context, &spool->held, spool->n_slabs, spool->n_slabs + 1, &spool->slab_room,
                           sizeof *spool->held) != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  unsigned char *slab = conic_memory_allocate(spool->context, CONIC_SPOOL_SLAB, 1);
  if (!slab)
    return CONIC_ERROR_MEMORY;
  spool->held[spool->n_slabs++] = slab;
  return CONIC_OK;
}

static conic_status hold(conic_spool *spool, const unsigned char *bytes, size_t n_bytes) {
  while (n_bytes > 0) {
    size_t i_slab = spool->n_held / CONIC_SPOOL_SLAB, at = spool->n_held % CONIC_SPOOL_SLAB;
    size_t n = n_bytes < CONIC_SPOOL_SLAB - at ? n_bytes : CONIC_SPOOL_SLAB - at;
    conic_status status = i_slab == spool->n_slabs ? add_slab(spool) : CONIC_OK;
    if (status != CONIC_OK)
      return status;
    memcpy(spool->held[i_slab] + at, bytes, n);
    spool->n_held += n;
    bytes += n;
    n_bytes -= n;
  }
  return CONIC_OK;
}

conic_status conic_spool_append(conic_spool *spool, const void *bytes, size_t n_bytes) {
  if (n_bytes == 0)
    return CONIC_OK;
  if (spool->file_bytes == 0 && n_bytes <= spool->most_held && spool->n_held <= spool->most_held - n_bytes)
    return hold(spool, bytes, n_bytes);
  conic_status status = spool->n_held ? flush(spool) : CONIC_OK;
  return status == CONIC_OK ? write_all(spool, bytes, n_bytes) : status;
}

conic_status conic_spool_read(const conic_spool *spool, uint64_t offset, void *bytes, size_t n_bytes) {
  unsigned char *to = bytes;
  while (n_bytes > 0 && offset < spool->file_bytes) {
    uint64_t left = spool->file_bytes - offset;
    ssize_t n = pread(spool->descriptor, to, n_bytes < left ? n_bytes : (size_t)left, (off_t)offset);
    if (n < 0 && errno == EINTR)
      continue;
    if (n <= 0)
      return conic_fail(spool->context, CONIC_ERROR_IO, "%s: cannot read a temporary file beside it: %s", spool->path,
                        n < 0 ? strerror(errno) : "it is too short");
    to += n;
    offset += (uint64_t)n;
    n_bytes -= (size_t)n;
  }
  while (n_bytes > 0) {
    size_t at = (size_t)(offset - spool->file_bytes), within = at % CONIC_SPOOL_SLAB;
    size_t n = n_bytes < CONIC_SPOOL_SLAB - within ? n_bytes : CONIC_SPOOL_SLAB - within;
    memcpy(to, spool->held[at / CONIC_SPOOL_SLAB] + within, n);
    to += n;
    offset += n;
    n_bytes -= n;
  }
  return CONIC_OK;
}
