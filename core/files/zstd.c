#include "core/files/zstd.h"

#if CONIC_HAVE_ZSTD

#include <zstd.h>

/* The data are short and without repetitions; higher levels find nothing more. */
enum { LEVEL = 3 };

struct conic_zstd {
  ZSTD_CCtx *compressor;
  ZSTD_DCtx *decompressor;
  int level;
};

conic_status conic_zstd_create(conic_context *context, conic_zstd **zstd) {
  *zstd = conic_memory_allocate_zeroed(context, 1, sizeof **zstd);
  if (!*zstd)
    return CONIC_ERROR_MEMORY;
  (*zstd)->level = LEVEL;
  (*zstd)->compressor = ZSTD_createCCtx();
  (*zstd)->decompressor = ZSTD_createDCtx();
  if ((*zstd)->compressor && (*zstd)->decompressor)
    return CONIC_OK;
  conic_zstd_destroy(context, *zstd);
  *zstd = NULL;
  return conic_fail(context, CONIC_ERROR_MEMORY, "no memory for zstd");
}

void conic_zstd_destroy(conic_context *context, conic_zstd *zstd) {
  if (!zstd)
    return;
  ZSTD_freeCCtx(zstd->compressor);
  ZSTD_freeDCtx(zstd->decompressor);
  conic_memory_release(context, zstd);
}

void conic_zstd_set_level(conic_zstd *zstd, int level) {
  zstd->level = level;
}

size_t conic_zstd_bound(size_t n_bytes) {
  return ZSTD_compressBound(n_bytes);
}

size_t conic_zstd_pack_whole(conic_zstd *zstd, const unsigned char *from, size_t n_bytes, unsigned char *to) {
  size_t n = ZSTD_compressCCtx(zstd->compressor, to, ZSTD_compressBound(n_bytes), from, n_bytes, zstd->level);
  return ZSTD_isError(n) ? 0 : n;
}

size_t conic_zstd_pack(conic_zstd *zstd, const unsigned char *from, size_t n_bytes, unsigned char *to) {
  size_t n = conic_zstd_pack_whole(zstd, from, n_bytes, to);
  return n < n_bytes ? n : 0;
}

int conic_zstd_unpack(conic_zstd *zstd, const unsigned char *from, size_t n_packed, unsigned char *to, size_t n_bytes) {
  return ZSTD_decompressDCtx(zstd->decompressor, to, n_bytes, from, n_packed) == n_bytes;
}

#else

conic_status conic_zstd_create(conic_context *context, conic_zstd **zstd) {
  *zstd = NULL;
  return conic_fail(context, CONIC_ERROR_UNSUPPORTED, "zstd is needed, which is not in this build");
}

void conic_zstd_destroy(conic_context *context, conic_zstd *zstd) {
  (void)context, (void)zstd;
}

void conic_zstd_set_level(conic_zstd *zstd, int level) {
  (void)zstd, (void)level;
}

size_t conic_zstd_bound(size_t n_bytes) {
  return n_bytes;
}

size_t conic_zstd_pack_whole(conic_zstd *zstd, const unsigned char *from, size_t n_bytes, unsigned char *to) {
  return conic_zstd_pack(zstd, from, n_bytes, to);
}

size_t conic_zstd_pack(conic_zstd *zstd, const unsigned char *from, size_t n_bytes, unsigned char *to) {
  (void)zstd, (void)from, (void)n_bytes, (void)to;
  return 0;
}

int conic_zstd_unpack(conic_zstd *zstd, const unsigned char *from, size_t n_packed, unsigned char *to, size_t n_bytes) {
  (void)zstd, (void)from, (void)n_packed, (void)to, (void)n_bytes;
  return 0;
}

#endif
