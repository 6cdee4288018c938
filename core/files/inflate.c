#include "core/files/inflate.h"

#if CONIC_HAVE_ZLIB

#include <zlib.h>

/* zlib counts in 32 bits. */
static const size_t most_at_once = 1u << 30;

static uInt piece(size_t left) {
  return (uInt)(left < most_at_once ? left : most_at_once);
}

int conic_inflate_is_there(void) {
  return 1;
}

static voidpf allocate_zeroed(voidpf cookie, uInt count, uInt size) {
  return conic_memory_allocate_zeroed(cookie, count, size);
}

static void release_zlib(voidpf cookie, voidpf pointer) {
  conic_memory_release(cookie, pointer);
}

/* NOLINTNEXTLINE(readability-non-const-parameter): zlib writes to it */
size_t conic_inflate(conic_deflate_wrapping wrapping, const unsigned char *from, size_t n_from, unsigned char *to,
                     size_t n_bytes, int *is_whole) {
  unsigned char rest[4096];
  z_stream stream = {.next_in = (z_const Bytef *)from, .next_out = to};
  size_t n_taken = 0, n_given = 0;
  if (inflateInit2(&stream, wrapping == CONIC_DEFLATE_GZIP ? 16 + MAX_WBITS : -MAX_WBITS) != Z_OK)
    return 0;
  int code = Z_OK;
  while (code == Z_OK && (n_given < n_bytes || is_whole)) {
    int is_rest = n_given == n_bytes;
    uInt n_in = stream.avail_in = piece(n_from - n_taken), n_out = is_rest ? sizeof rest : piece(n_bytes - n_given);
    stream.avail_out = n_out;
    if (is_rest)
      stream.next_out = rest;
    code = inflate(&stream, Z_NO_FLUSH);
    n_taken += n_in - stream.avail_in;
    n_given += is_rest ? 0 : n_out - stream.avail_out;
    if (code == Z_OK && n_in == stream.avail_in && n_out == stream.avail_out)
      break;
  }
  if (is_whole)
    *is_whole = code == Z_STREAM_END;
  inflateEnd(&stream);
  return n_given;
}

conic_status conic_gzip(conic_context *context, const unsigned char *from, size_t n_from, unsigned char **to,
                        size_t *n_to) {
  z_stream stream = {
      .next_in = (z_const Bytef *)from, .zalloc = allocate_zeroed, .zfree = release_zlib, .opaque = context};
  size_t n_taken = 0;
  int code = Z_OK;
  *n_to = 0;
  *to = NULL;
  if (deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, 16 + MAX_WBITS, 8, Z_DEFAULT_STRATEGY) != Z_OK)
    return CONIC_ERROR_MEMORY;
  size_t room = n_from + n_from / 1000 + 1024; /* more than zlib ever makes of n_from bytes */
  *to = conic_memory_allocate(context, room, 1);
  stream.next_out = *to;
  while (*to && code == Z_OK) {
    uInt n_in = stream.avail_in = piece(n_from - n_taken), n_out = stream.avail_out = piece(room - *n_to);
    code = deflate(&stream, n_taken + n_in == n_from ? Z_FINISH : Z_NO_FLUSH);
    n_taken += n_in - stream.avail_in;
    *n_to += n_out - stream.avail_out;
  }
  deflateEnd(&stream);
  if (code == Z_STREAM_END)
    return CONIC_OK;
  conic_memory_release(context, *to);
  *to = NULL;
  return CONIC_ERROR_MEMORY;
}

#else

int conic_inflate_is_there(void) {
  return 0;
}

size_t conic_inflate(conic_deflate_wrapping wrapping, const unsigned char *from, size_t n_from, unsigned char *to,
                     size_t n_bytes, int *is_whole) {
  (void)wrapping, (void)from, (void)n_from, (void)to, (void)n_bytes;
  if (is_whole)
    *is_whole = 0;
  return 0;
}

conic_status conic_gzip(conic_context *context, const unsigned char *from, size_t n_from, unsigned char **to,
                        size_t *n_to) {
  (void)from, (void)n_from;
  *to = NULL;
  *n_to = 0;
  return conic_fail(context, CONIC_ERROR_UNSUPPORTED, "gzip needs zlib, which is not in this build");
}

#endif
