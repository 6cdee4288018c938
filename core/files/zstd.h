/* zstd, where it is in this build: bytes to fewer bytes and back. */
#pragma once

#include "core/base/base.h"

/* One thread's state for zstd, which allocates that memory itself. */
typedef struct conic_zstd conic_zstd;

/* For packing and unpacking. Errors: MEMORY, UNSUPPORTED (not in this build). */
conic_status conic_zstd_create(conic_context *context, conic_zstd **zstd);
void conic_zstd_destroy(conic_context *context, conic_zstd *zstd);

/* How hard packing tries, 1 to 22; 3 at first. */
void conic_zstd_set_level(conic_zstd *zstd, int level);

/* Room that packing may need for so many bytes. */
size_t conic_zstd_bound(size_t n_bytes);

/* Packs; returns the number of bytes, or 0 where they are not fewer than before. */
size_t conic_zstd_pack(conic_zstd *zstd, const unsigned char *from, size_t n_bytes, unsigned char *to);

/* Packs even if the bytes become more; 0 where memory failed. */
size_t conic_zstd_pack_whole(conic_zstd *zstd, const unsigned char *from, size_t n_bytes, unsigned char *to);

/* Unpacks; returns whether that gives exactly n_bytes. */
int conic_zstd_unpack(conic_zstd *zstd, const unsigned char *from, size_t n_packed, unsigned char *to, size_t n_bytes);
