#include "lod/layers/format/layers_code.h"

#include <math.h>
#include <string.h>

#include "core/base/memory.h"
#include "lod/layers/format/layers_key.h"

/* Each stream is packed by itself: what is alike lies together. */
enum {
  STREAM_CLASSES = 0, /* of each key's difference to the one before: how many bits it has */
  STREAM_BITS = 1,    /* those bits, but for the first, which is set */
  STREAM_NORMALS = 2, /* two: differences to the sample before */
  STREAM_COLORS = 4,  /* three: green, and what red and blue differ by, likewise */
  MOST_STREAMS = 7
};

/* A stream's size in the cloud's first bytes, with this bit where it is packed. */
enum { SIZE_BYTES = 4 };
static const uint32_t is_packed_bit = UINT32_C(1) << 31;

static const int part_of_stream[MOST_STREAMS] = {CONIC_LAYERS_POSITION, CONIC_LAYERS_POSITION, CONIC_LAYERS_NORMAL,
                                                 CONIC_LAYERS_NORMAL,   CONIC_LAYERS_COLOR,    CONIC_LAYERS_COLOR,
                                                 CONIC_LAYERS_COLOR};

struct conic_layers_coder {
  conic_context *context;
  conic_zstd *zstd;
  size_t most_samples;
  int n_streams;
  unsigned char *streams[MOST_STREAMS];
  size_t n_bytes[MOST_STREAMS];
  unsigned char *packed;
};

/* A key has 63 bits at most; reading them goes on for some bytes past the end. */
static size_t bits_room(size_t n_samples) {
  return 8 * n_samples + 16;
}

conic_status conic_layers_coder_create(conic_context *context, size_t most_samples, int has_colors,
                                       conic_layers_coder **coder) {
  *coder = NULL;
  conic_layers_coder *made = conic_memory_allocate_zeroed(context, 1, sizeof *made);
  if (!made)
    return CONIC_ERROR_MEMORY;
  made->context = context;
  made->most_samples = most_samples;
  made->n_streams = has_colors ? MOST_STREAMS : STREAM_COLORS;
  conic_status status = conic_zstd_create(context, &made->zstd);
  for (int i = 0; i < made->n_streams && status == CONIC_OK; i++) {
    made->streams[i] =
        conic_memory_allocate(context, i == STREAM_BITS ? bits_room(most_samples) : most_samples + 16, 1);
    status = made->streams[i] ? CONIC_OK : CONIC_ERROR_MEMORY;
  }
  if (status == CONIC_OK) {
    size_t room = (MOST_STREAMS - 1) * conic_zstd_bound(most_samples) + conic_zstd_bound(bits_room(most_samples));
    made->packed = conic_memory_allocate(context, room + (size_t)MOST_STREAMS * SIZE_BYTES, 1);
    status = made->packed ? CONIC_OK : CONIC_ERROR_MEMORY;
  }
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

static void split_keys(conic_layers_coder *coder, const conic_layers_sample *samples, size_t n, uint64_t first_key) {
  unsigned char *classes = coder->streams[STREAM_CLASSES], *bits = coder->streams[STREAM_BITS];
  uint64_t before = first_key, held = 0;
  unsigned n_held = 0;
  size_t at = 0;
  for (size_t i = 0; i < n; i++) {
    uint64_t difference = samples[i].key - before;
    unsigned n_bits = n_bits_of(difference);
    before = samples[i].key;
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

static void split_attributes(conic_layers_coder *coder, const conic_layers_sample *samples, size_t n) {
  static const conic_layers_sample zero;
  const conic_layers_sample *before = &zero;
  unsigned char *const *streams = coder->streams;
  for (size_t i = 0; i < n; i++) {
    const conic_layers_sample *sample = &samples[i];
    streams[STREAM_NORMALS][i] = (unsigned char)(sample->normal[0] - before->normal[0]);
    streams[STREAM_NORMALS + 1][i] = (unsigned char)(sample->normal[1] - before->normal[1]);
    if (coder->n_streams > STREAM_COLORS) {
      int green = sample->color[1] - before->color[1];
      streams[STREAM_COLORS][i] = (unsigned char)green;
      streams[STREAM_COLORS + 1][i] = (unsigned char)(sample->color[0] - before->color[0] - green);
      streams[STREAM_COLORS + 2][i] = (unsigned char)(sample->color[2] - before->color[2] - green);
    }
    before = sample;
  }
  for (int i = STREAM_NORMALS; i < coder->n_streams; i++)
    coder->n_bytes[i] = n;
}

static void put_size(unsigned char *to, uint32_t size) {
  for (int i = 0; i < SIZE_BYTES; i++)
    to[i] = (unsigned char)(size >> 8 * i);
}

static uint32_t get_size(const unsigned char *from) {
  uint32_t size = 0;
  for (int i = 0; i < SIZE_BYTES; i++)
    size |= (uint32_t)from[i] << 8 * i;
  return size;
}

size_t conic_layers_encode(conic_layers_coder *coder, const conic_layers_sample *samples, size_t n, uint64_t first_key,
                           const unsigned char **bytes, uint64_t part_bytes[CONIC_LAYERS_PARTS]) {
  size_t at = (size_t)coder->n_streams * SIZE_BYTES;
  split_keys(coder, samples, n, first_key);
  split_attributes(coder, samples, n);
  for (int i = 0; i < coder->n_streams; i++) {
    size_t packed = conic_zstd_pack(coder->zstd, coder->streams[i], coder->n_bytes[i], coder->packed + at);
    size_t size = packed ? packed : coder->n_bytes[i];
    if (!packed)
      memcpy(coder->packed + at, coder->streams[i], size);
    put_size(coder->packed + (size_t)i * SIZE_BYTES, (uint32_t)size | (packed ? is_packed_bit : 0));
    part_bytes[part_of_stream[i]] += size + SIZE_BYTES;
    at += size;
  }
  *bytes = coder->packed;
  return at;
}

/* Where each stream's bytes are; whether they take all the cloud's. */
static int find_streams(const conic_layers_coder *coder, const unsigned char *bytes, size_t n_bytes,
                        const unsigned char *from[MOST_STREAMS], uint32_t sizes[MOST_STREAMS]) {
  size_t at = (size_t)coder->n_streams * SIZE_BYTES;
  for (int i = 0; i < coder->n_streams && at <= n_bytes; i++) {
    sizes[i] = get_size(bytes + (size_t)i * SIZE_BYTES);
    from[i] = bytes + at;
    size_t size = sizes[i] & ~is_packed_bit;
    if (size > n_bytes - at)
      return 0;
    at += size;
  }
  return at == n_bytes;
}

static int unpack_stream(conic_layers_coder *coder, int i, const unsigned char *from, uint32_t size, size_t n_bytes) {
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
  uint64_t word = 0;
  unsigned shift = (unsigned)(at & 7);
  bytes += at >> 3;
  for (int i = 0; i < 8; i++)
    word |= (uint64_t)bytes[i] << 8 * i;
  return shift ? word >> shift | (uint64_t)bytes[8] << (64 - shift) : word;
}

static const char *join_keys(const conic_layers_coder *coder, size_t n, uint64_t first_key, uint64_t last_key,
                             conic_layers_sample *samples) {
  const unsigned char *classes = coder->streams[STREAM_CLASSES], *bits = coder->streams[STREAM_BITS];
  uint64_t key = first_key;
  size_t at = 0;
  for (size_t i = 0; i < n; i++) {
    unsigned n_bits = classes[i];
    if (n_bits) {
      uint64_t top = UINT64_C(1) << (n_bits - 1), difference = top | (bits_at(bits, at) & (top - 1));
      if (difference > last_key - key)
        return "a sample is outside of its place";
      key += difference;
      at += n_bits - 1;
    }
    samples[i].key = key;
  }
  return NULL;
}

static void join_attributes(const conic_layers_coder *coder, size_t n, conic_layers_sample *samples) {
  unsigned char *const *streams = coder->streams;
  uint8_t x = 0, y = 0, red = 0, green = 0, blue = 0;
  for (size_t i = 0; i < n; i++) {
    samples[i].normal[0] = x = (uint8_t)(x + streams[STREAM_NORMALS][i]);
    samples[i].normal[1] = y = (uint8_t)(y + streams[STREAM_NORMALS + 1][i]);
    if (coder->n_streams > STREAM_COLORS) {
      uint8_t difference = streams[STREAM_COLORS][i];
      samples[i].color[0] = red = (uint8_t)(red + streams[STREAM_COLORS + 1][i] + difference);
      samples[i].color[1] = green = (uint8_t)(green + difference);
      samples[i].color[2] = blue = (uint8_t)(blue + streams[STREAM_COLORS + 2][i] + difference);
    }
  }
}

const char *conic_layers_unpack(conic_layers_coder *coder, const unsigned char *bytes, size_t n_bytes, size_t n,
                                uint64_t first_key, uint64_t last_key, conic_layers_sample *samples) {
  const unsigned char *from[MOST_STREAMS];
  uint32_t sizes[MOST_STREAMS];
  if (n > coder->most_samples)
    return "it has more samples than the largest";
  if (n_bytes < (size_t)coder->n_streams * SIZE_BYTES || !find_streams(coder, bytes, n_bytes, from, sizes))
    return "its streams are not as long as its bytes";
  for (int i = 0; i < coder->n_streams; i++) {
    size_t n_expected = i == STREAM_BITS ? count_bits(coder->streams[STREAM_CLASSES], n) : n;
    if (n_expected == SIZE_MAX || !unpack_stream(coder, i, from[i], sizes[i], n_expected))
      return "a stream cannot be unpacked";
    if (i == STREAM_BITS)
      memset(coder->streams[i] + n_expected, 0, 16);
  }
  const char *wrong = join_keys(coder, n, first_key, last_key, samples);
  if (!wrong)
    join_attributes(coder, n, samples);
  return wrong;
}

/* Codes 0 to 254 are −1 to 1, so that the axes are exact. */
enum { NORMAL_HALF = 127 };

static int round_to_int(float value) {
  return (int)floorf(value + 0.5f);
}

void conic_layers_code_normal(const float normal[3], uint8_t code[2]) {
  float sum = fabsf(normal[0]) + fabsf(normal[1]) + fabsf(normal[2]);
  float x = normal[0] / sum, y = normal[1] / sum;
  if (normal[2] < 0.0f) { /* the lower half is folded out */
    float folded = (1.0f - fabsf(y)) * (x < 0.0f ? -1.0f : 1.0f);
    y = (1.0f - fabsf(x)) * (y < 0.0f ? -1.0f : 1.0f);
    x = folded;
  }
  code[0] = (uint8_t)round_to_int((x + 1.0f) * (float)NORMAL_HALF);
  code[1] = (uint8_t)round_to_int((y + 1.0f) * (float)NORMAL_HALF);
}

void conic_layers_normal_of(const uint8_t code[2], float normal[3]) {
  float x = ((float)code[0] - (float)NORMAL_HALF) / (float)NORMAL_HALF;
  float y = ((float)code[1] - (float)NORMAL_HALF) / (float)NORMAL_HALF;
  float z = 1.0f - fabsf(x) - fabsf(y);
  if (z < 0.0f) {
    float folded = (1.0f - fabsf(y)) * (x < 0.0f ? -1.0f : 1.0f);
    y = (1.0f - fabsf(x)) * (y < 0.0f ? -1.0f : 1.0f);
    x = folded;
  }
  float length = sqrtf(x * x + y * y + z * z);
  normal[0] = x / length;
  normal[1] = y / length;
  normal[2] = z / length;
}
