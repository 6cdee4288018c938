#include "core/files/deflate.h"

/* Level 2. For pictures of splats, higher ones take up to twice as long for files that are 3 to 5 % smaller. */
enum { LEVEL = 2 };

#if CONIC_HAVE_LIBDEFLATE

#include <libdeflate.h>

size_t conic_deflate(conic_deflater *deflater, const void *from, size_t n, void *to, size_t room) {
  if (!deflater->compressor)
    deflater->compressor = libdeflate_alloc_compressor(LEVEL);
  return deflater->compressor ? libdeflate_zlib_compress(deflater->compressor, from, n, to, room) : 0;
}

void conic_deflater_end(conic_deflater *deflater) {
  if (deflater->compressor)
    libdeflate_free_compressor(deflater->compressor);
}

#elif CONIC_HAVE_ZLIB

#include <zlib.h>

size_t conic_deflate(conic_deflater *deflater, const void *from, size_t n, void *to, size_t room) {
  uLongf n_packed = (uLongf)room;
  (void)deflater;
  return compress2(to, &n_packed, from, (uLong)n, LEVEL) == Z_OK ? n_packed : 0;
}

void conic_deflater_end(conic_deflater *deflater) {
  (void)deflater;
}

#else

size_t conic_deflate(conic_deflater *deflater, const void *from, size_t n, void *to, size_t room) {
  (void)deflater, (void)from, (void)n, (void)to, (void)room;
  return 0;
}

void conic_deflater_end(conic_deflater *deflater) {
  (void)deflater;
}

#endif

size_t conic_deflate_exr(conic_deflater *deflater, const void *from, size_t n, void *scratch, void *to, size_t room) {
  const unsigned char *bytes = from;
  unsigned char *even = scratch, *odd = even + (n + 1) / 2, before = 0;
  for (size_t i = 0; i < n / 2; i++) {
    even[i] = bytes[2 * i];
    odd[i] = bytes[2 * i + 1];
  }
  if (n % 2)
    even[n / 2] = bytes[n - 1];
  for (size_t i = 0; i < n; i++) {
    unsigned char here = even[i];
    even[i] = (unsigned char)(i ? here - before + 128 : here);
    before = here;
  }
  return conic_deflate(deflater, scratch, n, to, room);
}
