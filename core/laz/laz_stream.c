#include "core/laz/laz_stream.h"

enum { HIGH_BITS = 8 };

void conic_laz_stream_begin(conic_laz_stream *stream, conic_laz_arena *arena, const unsigned char *bytes,
                            size_t n_bytes) {
  *stream = (conic_laz_stream){.next = bytes, .end = bytes + n_bytes, .length = UINT32_MAX, .arena = arena};
  if (n_bytes < 4) {
    stream->is_spoiled = 1;
    stream->next = stream->end;
    return;
  }
  stream->value = conic_load_big_32(bytes);
  stream->next += 4;
  if (stream->value == UINT32_MAX) {
    stream->is_spoiled = 1;
    stream->value--;
  }
}

void conic_laz_refill_at_end(conic_laz_stream *stream, unsigned n_bits) {
  for (; n_bits; n_bits -= 8) {
    int is_there = stream->next < stream->end;
    stream->value = stream->value << 8 | (is_there ? *stream->next++ : 0u);
    stream->length <<= 8;
    stream->is_spoiled |= !is_there;
  }
}

/* With k bits the numbers go from −(2^k − 1) to 2^k, without those of fewer bits. */
int32_t conic_laz_off(conic_laz_stream *stream, conic_laz_integer *integer, unsigned context, unsigned n_bits) {
  unsigned k = n_bits == 32 ? conic_laz_symbol(stream, &integer->n_bits[context], 33)
                            : conic_laz_symbol(stream, &integer->n_bits[context], 17);
  uint32_t off;
  integer->k = k;
  if (k == 0)
    return (int32_t)conic_laz_bit(stream, &integer->one);
  if (k == 32)
    return INT32_MIN;
  if (k <= 4)
    /* NOLINTNEXTLINE(bugprone-branch-clone): the compiler is to know that a model of so few has no table */
    off = conic_laz_symbol(stream, &integer->high[k], 1u << k);
  else if (k <= HIGH_BITS)
    off = conic_laz_symbol(stream, &integer->high[k], 1u << k);
  else {
    off = conic_laz_symbol(stream, &integer->high[k], 1u << HIGH_BITS) << (k - HIGH_BITS);
    off |= conic_laz_bits(stream, k - HIGH_BITS);
  }
  return (int32_t)(off + 1 - ((off >> (k - 1) ^ 1u) << k)); /* the upper half is positive; without a branch */
}
