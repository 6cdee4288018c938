#include "core/pictures/cryptomatte.h"

#include "core/base/byte_order.h"

enum { N_LAYERS = 3, DEPTH = 2 * N_LAYERS };

static uint32_t turn_left(uint32_t bits, int n) {
  return bits << n | bits >> (32 - n);
}

static uint32_t stir(uint32_t word) {
  return turn_left(word * 0xcc9e2d51u, 15) * 0x1b873593u;
}

uint32_t conic_cryptomatte_hash(const char *text) {
  const unsigned char *bytes = (const unsigned char *)text;
  size_t n = strlen(text), rest = n % 4;
  uint32_t hash = 0;
  for (size_t i = 0; i + 4 <= n; i += 4)
    hash = turn_left(hash ^ stir(conic_load_32(bytes + i)), 13) * 5 + 0xe6546b64u;
  hash ^= stir((uint32_t)conic_load_bits(bytes + n - rest, rest)); /* a rest of no bytes stirs to 0 */
  hash ^= (uint32_t)n;
  hash = (hash ^ hash >> 16) * 0x85ebca6bu;
  hash = (hash ^ hash >> 13) * 0xc2b2ae35u;
  return hash ^ hash >> 16;
}

uint32_t conic_cryptomatte_bits(const char *name) {
  uint32_t hash = conic_cryptomatte_hash(name), exponent = hash >> 23 & 0xff;
  return exponent == 0 || exponent == 0xff ? hash ^ 1u << 23 : hash;
}

/* A thing in a pixel, and its coverage. */
typedef struct matte {
  uint32_t bits;
  double covered;
} matte;

static int goes_first(const matte *a, const matte *b) {
  return a->covered != b->covered ? a->covered > b->covered : a->bits < b->bits;
}

static double add_same(const uint32_t *bits, const float *shares, size_t n_samples, size_t first) {
  double sum = 0.0;
  for (size_t i = first; i < n_samples; i++)
    if (bits[i] == bits[first])
      sum += shares ? (double)shares[i] : 1.0;
  return shares ? sum : sum / (double)n_samples;
}

static int is_known(const uint32_t *bits, size_t i) {
  size_t before = 0;
  if (i > 0 && bits[i] == bits[i - 1])
    return 1;
  while (before < i && bits[before] != bits[i])
    before++;
  return before < i;
}

void conic_cryptomatte_rank(const uint32_t *bits, const float *shares, size_t n_samples, conic_image *image,
                            size_t pixel) {
  matte ranks[DEPTH + 1];
  size_t n = 0;
  for (size_t i = 0; i < n_samples; i++) {
    if (bits[i] == 0 || is_known(bits, i))
      continue;
    matte here = {bits[i], add_same(bits, shares, n_samples, i)};
    if (!(here.covered > 0.0))
      continue;
    size_t at = n;
    for (; at > 0 && goes_first(&here, &ranks[at - 1]); at--)
      ranks[at] = ranks[at - 1];
    ranks[at] = here;
    n = n < DEPTH ? n + 1 : DEPTH;
  }
  for (size_t i = 0; i < DEPTH; i++) {
    float *pair = (float *)image->planes[(size_t)CONIC_PLANE_MATTE_0 + i / 2] + 4 * pixel + 2 * (i % 2);
    pair[0] = pair[1] = 0.0f;
    if (i >= n)
      continue;
    memcpy(pair, &ranks[i].bits, sizeof ranks[i].bits);
    pair[1] = (float)ranks[i].covered;
  }
}

/* Writes a byte as a JSON text has it; returns how many bytes that takes, at most 6. */
static size_t write_byte(unsigned char byte, char *to) {
  char escaped[8];
  size_t n = 1;
  if (byte < 0x20)
    n = (size_t)snprintf(escaped, sizeof escaped, "\\u%04x", byte);
  else if (byte == '"' || byte == '\\')
    n = (size_t)snprintf(escaped, sizeof escaped, "\\%c", byte);
  else
    escaped[0] = (char)byte;
  memcpy(to, escaped, n);
  return n;
}

conic_status conic_cryptomatte_name(conic_context *context, conic_cryptomatte_manifest *manifest, const char *name) {
  size_t at = manifest->length, wanted = at + 6 * strlen(name) + 32;
  if (wanted > manifest->room) {
    conic_status status = conic_memory_reserve(context, &manifest->text, at, wanted, &manifest->room, 1);
    if (status != CONIC_OK)
      return status;
  }
  char *text = manifest->text;
  if (at == 0)
    text[at++] = '{';
  else
    text[at - 1] = ','; /* was the end */
  text[at++] = '"';
  for (const char *c = name; *c; c++)
    at += write_byte((unsigned char)*c, text + at);
  at += (size_t)snprintf(text + at, wanted - at, "\":\"%08x\"}", (unsigned)conic_cryptomatte_bits(name));
  manifest->length = at;
  return CONIC_OK;
}

void conic_cryptomatte_manifest_release(conic_context *context, conic_cryptomatte_manifest *manifest) {
  conic_memory_release(context, manifest->text);
  memset(manifest, 0, sizeof *manifest);
}
