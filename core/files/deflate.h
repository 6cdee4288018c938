/* Packing whole blocks in zlib's format: by libdeflate where it is there, else by zlib. */
#pragma once

#include <stddef.h>

/* What packs; begins as zeros. Each thread has its own. */
typedef struct conic_deflater {
  void *compressor; /* libdeflate's, made by the first block */
} conic_deflater;

/* Packs n bytes; returns how many they become, or 0 where they do not fit or memory is missing; and 0 always without
 * either library. */
size_t conic_deflate(conic_deflater *deflater, const void *from, size_t n, void *to, size_t room);

/* conic_deflate of what EXR's ZIP and ZIPS pack: even bytes first, then odd ones, each as its difference from the one
 * before. `scratch` has room for n. */
size_t conic_deflate_exr(conic_deflater *deflater, const void *from, size_t n, void *scratch, void *to, size_t room);

void conic_deflater_end(conic_deflater *deflater);
