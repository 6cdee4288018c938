#include "core/files/sha256.h"

#include "core/base/byte_order.h"

/* The first 32 bits of the fractions of the cube roots of the first 64 primes. */
static const uint32_t round_constants[64] = {
    0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5,
    0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174,
    0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
    0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967,
    0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
    0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070,
    0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
    0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2};

static uint32_t turned_right(uint32_t x, int n) {
  return x >> n | x << (32 - n);
}

/* One of the 64 steps. Two of the eight numbers change; their places turn with the step's number. */
static inline void take_step(uint32_t s[8], int i, uint32_t added) {
  const uint32_t a = s[-i & 7], b = s[(1 - i) & 7], c = s[(2 - i) & 7], e = s[(4 - i) & 7], f = s[(5 - i) & 7],
                 g = s[(6 - i) & 7];
  uint32_t *h = &s[(7 - i) & 7];
  uint32_t t = *h + (turned_right(e, 6) ^ turned_right(e, 11) ^ turned_right(e, 25)) + ((e & f) ^ (~e & g)) + added;
  s[(3 - i) & 7] += t;
  *h = t + (turned_right(a, 2) ^ turned_right(a, 13) ^ turned_right(a, 22)) + ((a & b) ^ (a & c) ^ (b & c));
}

static void mix_block(uint32_t state[8], const unsigned char block[64]) {
  uint32_t w[64], s[8];
  for (int i = 0; i < 16; i++)
    w[i] = conic_load_big_32(&block[4 * (size_t)i]);
  for (int i = 16; i < 64; i++) {
    uint32_t a = w[i - 15], b = w[i - 2];
    w[i] = w[i - 16] + (turned_right(a, 7) ^ turned_right(a, 18) ^ a >> 3) + w[i - 7] +
           (turned_right(b, 17) ^ turned_right(b, 19) ^ b >> 10);
  }
  memcpy(s, state, sizeof s);
  for (int i = 0; i < 64; i += 8) { /* in eights, so that all of s stays in registers */
    take_step(s, 0, round_constants[i] + w[i]);
    take_step(s, 1, round_constants[i + 1] + w[i + 1]);
    take_step(s, 2, round_constants[i + 2] + w[i + 2]);
    take_step(s, 3, round_constants[i + 3] + w[i + 3]);
    take_step(s, 4, round_constants[i + 4] + w[i + 4]);
    take_step(s, 5, round_constants[i + 5] + w[i + 5]);
    take_step(s, 6, round_constants[i + 6] + w[i + 6]);
    take_step(s, 7, round_constants[i + 7] + w[i + 7]);
  }
  for (int i = 0; i < 8; i++)
    state[i] += s[i];
}

/* So many are worth the processor's own instructions. */
enum { MANY_BYTES = 4096 };

void conic_sha256_begin(conic_sha256 *sum) {
  /* The fractions of the square roots of the first 8 primes. */
  static const uint32_t first[8] = {0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                    0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  memcpy(sum->state, first, sizeof first);
  sum->n_bytes = 0;
}

void conic_sha256_add(conic_sha256 *sum, const void *bytes, size_t n) {
  const unsigned char *from = bytes;
  for (size_t here; n > 0; from += here, n -= here) {
    size_t at = sum->n_bytes % 64;
    here = n < 64 - at ? n : 64 - at;
    if (at == 0 && n >= MANY_BYTES && conic_sha256_has_instructions()) {
      here = n / 64 * 64;
      conic_sha256_mix_blocks(sum->state, round_constants, from, here / 64);
    } else {
      memcpy(sum->block + at, from, here);
      if (at + here == 64)
        mix_block(sum->state, sum->block);
    }
    sum->n_bytes += here;
  }
}

void conic_sha256_end(conic_sha256 *sum, char text[CONIC_SHA256_ROOM]) {
  static const char digits[] = "0123456789abcdef";
  static const unsigned char padding[64] = {0x80};
  const uint64_t n_bits = 8 * sum->n_bytes;
  unsigned char length[8];
  conic_store_big_64(length, n_bits);
  conic_sha256_add(sum, padding, 1 + (119 - sum->n_bytes % 64) % 64);
  conic_sha256_add(sum, length, sizeof length);
  for (int i = 0; i < 64; i++)
    text[i] = digits[sum->state[i / 8] >> (28 - 4 * (i % 8)) & 15];
  text[64] = '\0';
}
