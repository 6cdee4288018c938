#include "lod/layers/format/layers_code.h"

#include "core/base/byte_order.h"

/* The first two streams are the keys'. */
enum {
  STREAM_CLASSES = 0, /* of each key's difference to the one before: how many bits it has */
  STREAM_BITS = 1     /* those bits, but for the first, which is set */
};

/* A stream's size in the cloud's first bytes, with this bit where it is packed. */
enum { SIZE_BYTES = 4, MOST_STREAMS = CONIC_LAYERS_MOST_ATTRIBUTES * CONIC_LAYERS_MOST_STREAMS };
static const uint32_t is_packed_bit = UINT32_C(1) << 31;

struct conic_layers_coder {
  conic_context *context;
  conic_zstd *zstd;
  size_t most_samples;
  conic_layers_schema schema;
  unsigned char *streams[MOST_STREAMS]; /* null: of an attribute that is not known, or not wanted */
  size_t n_bytes[MOST_STREAMS];
  unsigned char *packed;
};

/* A key has 63 bits at most, a sample up to two clip lines; reading bits goes on for some bytes past the end. */
static size_t stream_room(const conic_layers_coder *coder, uint32_t i_attribute) {
  conic_layers_kind kind = (conic_layers_kind)coder->schema.list[i_attribute].kind;
  return (kind == CONIC_LAYERS_POSITION ? 8 : kind == CONIC_LAYERS_CLIP ? 2 : 1) * coder->most_samples + 16;
}

static conic_status make_streams(conic_layers_coder *coder, const unsigned char *is_wanted) {
  size_t packed_room = (size_t)coder->schema.n_streams * SIZE_BYTES;
  for (uint32_t i = 0, k = 0; i < coder->schema.n; i++) {
    size_t room = stream_room(coder, i);
    for (uint32_t end = k + coder->schema.list[i].n_streams; k < end; k++) {
      if (coder->schema.list[i].kind >= CONIC_LAYERS_KINDS || (is_wanted && !is_wanted[i]))
        continue;
      coder->streams[k] = conic_memory_allocate(coder->context, room, 1);
      if (!coder->streams[k])
        return CONIC_ERROR_MEMORY;
      packed_room += conic_zstd_bound(room);
    }
  }
  coder->packed = is_wanted ? NULL : conic_memory_allocate(coder->context, packed_room, 1);
  return coder->packed || is_wanted ? CONIC_OK : CONIC_ERROR_MEMORY;
}

conic_status conic_layers_coder_create(conic_context *context, size_t most_samples, const conic_layers_schema *schema,
                                       const unsigned char *is_wanted, conic_layers_coder **coder) {
  *coder = NULL;
  conic_layers_coder *made = conic_memory_allocate_zeroed(context, 1, sizeof *made);
  if (!made)
    return CONIC_ERROR_MEMORY;
  made->context = context;
  made->most_samples = most_samples;
  made->schema = *schema;
  conic_status status = conic_zstd_create(context, &made->zstd);
  if (status == CONIC_OK)
    status = make_streams(made, is_wanted);
  if (status == CONIC_OK)
    *coder = made;
  else
    conic_layers_coder_destroy(made);
  return status;
}

void conic_layers_coder_destroy(conic_layers_coder *coder) {
  if (!coder)
    return;
  for (int i = 0; i < MOST_STREAMS; i++)
    conic_memory_release(coder->context, coder->streams[i]);
  conic_memory_release(coder->context, coder->packed);
  conic_zstd_destroy(coder->context, coder->zstd);
  conic_memory_release(coder->context, coder);
}

static unsigned n_bits_of(uint64_t value) {
  return value ? 64 - (unsigned)__builtin_clzll(value) : 0;
}

static void split_keys(conic_layers_coder *coder, const unsigned char *samples, size_t n, uint64_t first_key) {
  unsigned char *classes = coder->streams[STREAM_CLASSES], *bits = coder->streams[STREAM_BITS];
  uint64_t before = first_key, held = 0;
  unsigned n_held = 0;
  size_t at = 0;
  for (size_t i = 0; i < n; i++) {
    uint64_t key = conic_layers_sample_at(samples, coder->schema.sample_bytes, i)->key, difference = key - before;
    unsigned n_bits = n_bits_of(difference);
    before = key;
    classes[i] = (unsigned char)n_bits;
    for (unsigned left = n_bits ? n_bits - 1 : 0; left;) { /* at most 32 at a time, so that `held` has room */
      unsigned some = left < 32 ? left : 32;
      held |= (difference & ((UINT64_C(1) << some) - 1)) << n_held;
      difference >>= some;
      n_held += some;
      left -= some;
      for (; n_held >= 8; n_held -= 8, held >>= 8)
        bits[at++] = (unsigned char)held;
    }
  }
  if (n_held)
    bits[at++] = (unsigned char)held;
  coder->n_bytes[STREAM_CLASSES] = n;
  coder->n_bytes[STREAM_BITS] = at;
}

static size_t pack_layer_stream(conic_layers_coder *coder, uint32_t i, size_t at) {
  size_t packed = conic_zstd_pack(coder->zstd, coder->streams[i], coder->n_bytes[i], coder->packed + at);
  size_t size = packed ? packed : coder->n_bytes[i];
  if (!packed)
    memcpy(coder->packed + at, coder->streams[i], size);
  conic_store_32(coder->packed + (size_t)i * SIZE_BYTES, (uint32_t)size | (packed ? is_packed_bit : 0));
  return size;
}

size_t conic_layers_encode(conic_layers_coder *coder, const unsigned char *samples, size_t n, uint64_t first_key,
                           const unsigned char **bytes, uint64_t attribute_bytes[CONIC_LAYERS_MOST_ATTRIBUTES]) {
  const conic_layers_schema *schema = &coder->schema;
  size_t at = (size_t)schema->n_streams * SIZE_BYTES;
  split_keys(coder, samples, n, first_key);
  for (uint32_t i = 0, k = 0; i < schema->n; i++) {
    uint32_t end = k + schema->list[i].n_streams;
    if (i > 0)
      conic_layers_split(schema, i, samples, n, &coder->streams[k], &coder->n_bytes[k]);
    for (; k < end; k++) {
      size_t size = pack_layer_stream(coder, k, at);
      attribute_bytes[i] += size + SIZE_BYTES;
      at += size;
    }
  }
  *bytes = coder->packed;
  return at;
}

static int unpack_stream(conic_layers_coder *coder, uint32_t i, const unsigned char *from, uint32_t size,
                         size_t n_bytes) {
  size_t n_packed = size & ~is_packed_bit;
  if (size & is_packed_bit)
    return conic_zstd_unpack(coder->zstd, from, n_packed, coder->streams[i], n_bytes);
  if (n_packed == n_bytes)
    memcpy(coder->streams[i], from, n_bytes);
  return n_packed == n_bytes;
}

/* How many bytes the bits of the keys take; SIZE_MAX where a class is none. */
static size_t count_bits(const unsigned char *classes, size_t n) {
  size_t n_bits = 0;
  for (size_t i = 0; i < n; i++) {
    if (classes[i] > 3 * CONIC_LAYERS_MOST_BITS)
      return SIZE_MAX;
    n_bits += classes[i] ? classes[i] - 1u : 0;
  }
  return (n_bits + 7) / 8;
}

/* 64 bits from any bit on; eight bytes behind them may be read too. */
static uint64_t bits_at(const unsigned char *bytes, size_t at) {
  unsigned shift = (unsigned)(at & 7);
  bytes += at >> 3;
  uint64_t word = conic_load_64(bytes);
  return shift ? word >> shift | (uint64_t)bytes[8] << (64 - shift) : word;
}

static const char *join_keys(const conic_layers_coder *coder, size_t n, uint64_t first_key, uint64_t last_key,
                             unsigned char *samples) {
  const unsigned char *classes = coder->streams[STREAM_CLASSES], *bits = coder->streams[STREAM_BITS];
  uint64_t key = first_key;
  size_t at = 0;
  for (size_t i = 0; i < n; i++) {
    unsigned n_bits = classes[i]; /* NOLINT(clang-analyzer-core.NullDereference): keys are always unpacked */
    if (n_bits) {
      uint64_t top = UINT64_C(1) << (n_bits - 1), difference = top | (bits_at(bits, at) & (top - 1));
      if (difference > last_key - key)
        return "a sample is outside of its place";
      key += difference;
      at += n_bits - 1;
    }
    conic_layers_sample_in(samples, coder->schema.sample_bytes, i)->key = key;
  }
  return NULL;
}

/* The sum of the streams' sizes from the first up to one; SIZE_MAX where they are more than the cloud's bytes. */
static size_t skip_streams(const conic_layers_coder *coder, const unsigned char *bytes, size_t n_bytes) {
  size_t at = (size_t)coder->schema.n_streams * SIZE_BYTES;
  if (n_bytes < at)
    return SIZE_MAX;
  for (uint32_t i = 0; i < coder->schema.n_streams; i++) {
    size_t size = conic_load_32(bytes + (size_t)i * SIZE_BYTES) & ~is_packed_bit;
    if (size > n_bytes - at)
      return SIZE_MAX;
    at += size;
  }
  return at;
}

/* How long stream k of attribute i is, now that those before it are there. SIZE_MAX: they make no sense. */
static size_t expected_bytes(const conic_layers_coder *coder, uint32_t i, uint32_t k, uint32_t first, size_t n) {
  if (i == 0)
    return k == STREAM_BITS ? count_bits(coder->streams[STREAM_CLASSES], n) : n;
  return coder->schema.list[i].kind == CONIC_LAYERS_CLIP && k > first
             ? conic_layers_count_lines(coder->streams[first], n)
             : n;
}

const char *conic_layers_unpack(conic_layers_coder *coder, const unsigned char *bytes, size_t n_bytes, size_t n,
                                uint64_t first_key, uint64_t last_key, unsigned char *samples) {
  const conic_layers_schema *schema = &coder->schema;
  const char *wrong = NULL;
  if (n > coder->most_samples)
    return "it has more samples than the largest";
  if (skip_streams(coder, bytes, n_bytes) != n_bytes)
    return "its streams are not as long as its bytes";
  memset(samples, 0, n * schema->sample_bytes);
  size_t at = (size_t)schema->n_streams * SIZE_BYTES;
  for (uint32_t i = 0, k = 0; i < schema->n && !wrong; i++) {
    uint32_t first = k;
    int is_passed_over = !coder->streams[first];
    for (uint32_t end = k + schema->list[i].n_streams; k < end; k++) {
      uint32_t size = conic_load_32(bytes + (size_t)k * SIZE_BYTES);
      size_t n_expected = is_passed_over ? 0 : expected_bytes(coder, i, k, first, n);
      if (!is_passed_over && (n_expected == SIZE_MAX || !unpack_stream(coder, k, bytes + at, size, n_expected)))
        return "a stream cannot be unpacked";
      if (k == STREAM_BITS && !is_passed_over)
        memset(coder->streams[k] + n_expected, 0, 16);
      at += size & ~is_packed_bit;
    }
    if (i == 0)
      wrong = join_keys(coder, n, first_key, last_key, samples);
    else if (!is_passed_over)
      conic_layers_join(schema, i, n, (const unsigned char *const *)&coder->streams[first], samples);
  }
  return wrong;
}
