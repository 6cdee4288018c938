/* Reads symbols, bits and integers from arithmetically coded bytes.
 *
 * `value` is always below `length`, whatever the bytes are, so that every symbol is one of its model's. Bytes missing
 * at the end read as zeros, which is noted. */
#pragma once

#include "core/base/byte_order.h"
#include "core/laz/laz_models.h"

typedef struct conic_laz_stream {
  const unsigned char *next, *end;
  uint32_t value, length;
  int is_spoiled;
  conic_laz_arena *arena; /* where new models get their memory */
} conic_laz_stream;

void conic_laz_stream_begin(conic_laz_stream *stream, conic_laz_arena *arena, const unsigned char *bytes,
                            size_t n_bytes);

/* Shifts `n_bits` in, byte by byte, near the end of the bytes. */
void conic_laz_refill_at_end(conic_laz_stream *stream, unsigned n_bits);

/* Brings `length`, which is not 0, back to 2^24 or more, by whole bytes. */
static inline void conic_laz_refill(conic_laz_stream *stream) {
  unsigned n_bits = (unsigned)__builtin_clz(stream->length) & 24u;
  if (stream->end - stream->next < 4) {
    conic_laz_refill_at_end(stream, n_bits);
    return;
  }
  const unsigned char *b = stream->next;
  uint32_t ahead = conic_load_big_32(b);
  stream->value = stream->value << n_bits | ahead >> 1 >> (31 - n_bits);
  stream->length <<= n_bits;
  stream->next += n_bits >> 3;
}

/* Narrows the interval to the symbol's, from x to y, and counts the symbol. */
static inline void conic_laz_settle(conic_laz_stream *stream, conic_laz_model *model, unsigned symbol, uint32_t x,
                                    uint32_t y) {
  stream->value -= x;
  stream->length = y - x;
  conic_laz_refill(stream);
  model->count[symbol]++;
  if (--model->until_update == 0)
    conic_laz_model_update(model);
}

/* The next symbol, by a model of n symbols. The first call begins the model; n must be the same in every call. */
static inline unsigned conic_laz_symbol(conic_laz_stream *stream, conic_laz_model *model, unsigned n) {
  unsigned symbol = 0;
  if (!model->bound && !conic_laz_model_begin(model, stream->arena, n))
    return 0;
  uint32_t unit = stream->length >> CONIC_LAZ_PROBABILITY_BITS, x = 0, y = stream->length;
  const uint16_t *bound = model->bound;
  if (n <= CONIC_LAZ_SMALL_MODEL) {
    for (unsigned end = n, middle = n >> 1; middle != symbol; middle = (symbol + end) >> 1) {
      uint32_t product = unit * bound[middle];
      int is_below = product > stream->value;
      end = is_below ? middle : end;
      y = is_below ? product : y;
      symbol = is_below ? symbol : middle;
      x = is_below ? x : product;
    }
  } else {
    uint32_t place = stream->value / unit;
    symbol = (unsigned)model->table[place >> conic_laz_table_shift(n)] << (n > 256);
    while (bound[symbol + 1] <= place)
      symbol++;
    x = unit * bound[symbol];
    y = symbol + 1 < n ? unit * bound[symbol + 1] : y;
  }
  conic_laz_settle(stream, model, symbol, x, y);
  return symbol;
}

static inline unsigned conic_laz_bit(conic_laz_stream *stream, conic_laz_bit_model *model) {
  if (!model->total)
    conic_laz_bit_model_begin(model);
  uint32_t x = model->probability * (stream->length >> CONIC_LAZ_BIT_PROBABILITY_BITS);
  uint32_t bit = stream->value >= x, above = 0u - bit;
  stream->value -= x & above;
  stream->length = (x & ~above) + ((stream->length - x) & above);
  model->zeros += !bit;
  conic_laz_refill(stream);
  if (--model->until_update == 0)
    conic_laz_bit_model_update(model);
  return bit;
}

/* 1 to 19 bits without a model. */
static inline uint32_t conic_laz_few_bits(conic_laz_stream *stream, unsigned n_bits) {
  stream->length >>= n_bits;
  uint32_t bits = stream->value / stream->length;
  stream->value -= bits * stream->length;
  conic_laz_refill(stream);
  stream->is_spoiled |= (int)(bits >> n_bits != 0);
  return bits & ((1u << n_bits) - 1);
}

/* 1 to 32 bits without a model; of more than 19, the lower 16 come first. */
static inline uint32_t conic_laz_bits(conic_laz_stream *stream, unsigned n_bits) {
  if (n_bits <= 19)
    return conic_laz_few_bits(stream, n_bits);
  uint32_t low = conic_laz_few_bits(stream, 16);
  return conic_laz_few_bits(stream, n_bits - 16) << 16 | low;
}

/* An integer's difference from its prediction. First comes its number of bits k, by a model for the context; then come
 * the bits, the highest eight by a model for that k. */
enum { CONIC_LAZ_MOST_CONTEXTS = 22 };

typedef struct conic_laz_integer {
  unsigned k; /* of the last integer */
  conic_laz_model n_bits[CONIC_LAZ_MOST_CONTEXTS];
  conic_laz_bit_model one;
  conic_laz_model high[33];
} conic_laz_integer;

int32_t conic_laz_off(conic_laz_stream *stream, conic_laz_integer *integer, unsigned context, unsigned n_bits);

/* An integer of 32 bits, from its prediction. */
static inline int32_t conic_laz_integer_32(conic_laz_stream *stream, conic_laz_integer *integer, int32_t predicted,
                                           unsigned context) {
  return (int32_t)((uint32_t)predicted + (uint32_t)conic_laz_off(stream, integer, context, 32));
}

/* An integer of 16 bits, from its prediction, modulo 2^16. */
static inline uint32_t conic_laz_integer_16(conic_laz_stream *stream, conic_laz_integer *integer, uint32_t predicted,
                                            unsigned context) {
  return (predicted + (uint32_t)conic_laz_off(stream, integer, context, 16)) & 0xffffu;
}
