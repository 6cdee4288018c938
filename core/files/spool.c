#include "core/files/spool.h"

void conic_spool_begin(conic_context *context, const char *path, size_t memory_bytes, conic_spool *spool) {
  memset(spool, 0, sizeof *spool);
  spool->context = context;
  spool->path = path;
  spool->file.descriptor = -1;
  spool->most_held = memory_bytes;
}

/* Releases all but so many. */
static void release_slabs(conic_spool *spool, size_t n_kept) {
  while (spool->n_slabs > n_kept)
    conic_memory_release(spool->context, spool->held[--spool->n_slabs]);
  spool->n_held = 0;
}

void conic_spool_end(conic_spool *spool) {
  if (!spool->context)
    return;
  conic_scratch_close(&spool->file);
  release_slabs(spool, 0);
  conic_memory_release(spool->context, spool->held);
  memset(spool, 0, sizeof *spool);
}

static conic_status write_to_file(conic_spool *spool, const void *bytes, size_t n_bytes) {
  conic_status status = CONIC_OK;
  if (spool->file.descriptor < 0)
    status = conic_scratch_open(spool->context, spool->path, &spool->file);
  if (status == CONIC_OK)
    status = conic_scratch_write(&spool->file, spool->file_bytes, bytes, n_bytes);
  spool->file_bytes += status == CONIC_OK ? n_bytes : 0;
  return status;
}

/* Writes the held bytes to the file and gives their memory back, except for one slab. */
static conic_status flush(conic_spool *spool) {
  conic_status status = CONIC_OK;
  for (size_t i = 0, left = spool->n_held; left > 0 && status == CONIC_OK; i++) {
    size_t n = left < CONIC_SPOOL_SLAB ? left : CONIC_SPOOL_SLAB;
    status = write_to_file(spool, spool->held[i], n);
    left -= n;
  }
  release_slabs(spool, 1);
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

/* Once there is a file, one slab is held, so that few bytes are not written one by one. */
static int fits(const conic_spool *spool, size_t n_bytes) {
  size_t most = spool->most_held;
  if (spool->file_bytes && most > CONIC_SPOOL_SLAB)
    most = CONIC_SPOOL_SLAB;
  return n_bytes <= most && spool->n_held <= most - n_bytes;
}

conic_status conic_spool_append(conic_spool *spool, const void *bytes, size_t n_bytes) {
  if (n_bytes == 0)
    return CONIC_OK;
  if (fits(spool, n_bytes))
    return hold(spool, bytes, n_bytes);
  conic_status status = spool->n_held ? flush(spool) : CONIC_OK;
  if (status != CONIC_OK)
    return status;
  return spool->file_bytes && fits(spool, n_bytes) ? hold(spool, bytes, n_bytes) : write_to_file(spool, bytes, n_bytes);
}

conic_status conic_spool_read(const conic_spool *spool, uint64_t offset, void *bytes, size_t n_bytes) {
  unsigned char *to = bytes;
  if (offset < spool->file_bytes) {
    uint64_t left = spool->file_bytes - offset;
    size_t n = n_bytes < left ? n_bytes : (size_t)left;
    conic_status status = conic_scratch_read(&spool->file, offset, to, n);
    if (status != CONIC_OK)
      return status;
    to += n;
    offset += n;
    n_bytes -= n;
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
