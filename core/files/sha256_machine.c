/* By the instructions that processors have for it: x86's SHA extensions, and those of ARM's crypto extension. */
#include <stdatomic.h>

#include "core/files/sha256.h"

#if defined(__x86_64__) && defined(__GNUC__)

#include <cpuid.h>
#include <immintrin.h>

static int has_instructions(void) {
  unsigned a, b, c, d;
  const unsigned ssse3 = 1u << 9, sse41 = 1u << 19, sha = 1u << 29;
  if (!__get_cpuid(1, &a, &b, &c, &d) || (c & (ssse3 | sse41)) != (ssse3 | sse41))
    return 0;
  return __get_cpuid_count(7, 0, &a, &b, &c, &d) && b & sha;
}

/* The instructions have the state as (a, b, e, f) and (c, d, g, h), from the top. Two of them make four steps; what
 * comes of a block's words are the words 16 steps later. */
__attribute__((target("sha,sse4.1,ssse3"))) void
conic_sha256_mix_blocks(uint32_t state[8], const uint32_t constants[64], const unsigned char *blocks, size_t n) {
  const __m128i big_endian = _mm_set_epi64x(0x0c0d0e0f08090a0b, 0x0405060700010203);
  __m128i low = _mm_shuffle_epi32(_mm_loadu_si128((const __m128i *)state), 0xB1);
  __m128i high = _mm_shuffle_epi32(_mm_loadu_si128((const __m128i *)(state + 4)), 0x1B);
  __m128i abef = _mm_alignr_epi8(low, high, 8), cdgh = _mm_blend_epi16(high, low, 0xF0);
  for (; n > 0; n--, blocks += 64) {
    const __m128i abef_before = abef, cdgh_before = cdgh;
    __m128i w[4];
    for (int i = 0; i < 4; i++)
      w[i] = _mm_shuffle_epi8(_mm_loadu_si128((const __m128i *)(blocks + (size_t)i * 16)), big_endian);
    for (int i = 0; i < 16; i++) {
      __m128i added = _mm_add_epi32(w[i & 3], _mm_loadu_si128((const __m128i *)(constants + (size_t)i * 4)));
      cdgh = _mm_sha256rnds2_epu32(cdgh, abef, added);
      abef = _mm_sha256rnds2_epu32(abef, cdgh, _mm_shuffle_epi32(added, 0x0E));
      __m128i next = _mm_add_epi32(_mm_sha256msg1_epu32(w[i & 3], w[(i + 1) & 3]),
                                   _mm_alignr_epi8(w[(i + 3) & 3], w[(i + 2) & 3], 4));
      w[i & 3] = _mm_sha256msg2_epu32(next, w[(i + 3) & 3]);
    }
    abef = _mm_add_epi32(abef, abef_before);
    cdgh = _mm_add_epi32(cdgh, cdgh_before);
  }
  low = _mm_shuffle_epi32(abef, 0x1B);
  high = _mm_shuffle_epi32(cdgh, 0xB1);
  _mm_storeu_si128((__m128i *)state, _mm_blend_epi16(low, high, 0xF0));
  _mm_storeu_si128((__m128i *)(state + 4), _mm_alignr_epi8(high, low, 8));
}

/* Before version 16 clang has them only where all of the program may use them. */
#elif defined(__aarch64__) && defined(__GNUC__) &&                                                                     \
    (!defined(__clang__) || __clang_major__ >= 16 || defined(__ARM_FEATURE_SHA2))

#include <arm_neon.h>
#ifdef __linux__
#include <sys/auxv.h>
#endif

static int has_instructions(void) {
#if defined(__ARM_FEATURE_SHA2) || defined(__ARM_FEATURE_CRYPTO)
  return 1;
#elif defined(__linux__)
  const unsigned long sha2 = 1ul << 6;
  return (getauxval(AT_HWCAP) & sha2) != 0;
#else
  return 0;
#endif
}

/* One makes four steps of half of the state; what comes of a block's words are the words 16 steps later. */
__attribute__((target("+crypto"))) void conic_sha256_mix_blocks(uint32_t state[8], const uint32_t constants[64],
                                                                const unsigned char *blocks, size_t n) {
  uint32x4_t abcd = vld1q_u32(state), efgh = vld1q_u32(state + 4);
  for (; n > 0; n--, blocks += 64) {
    const uint32x4_t abcd_before = abcd, efgh_before = efgh;
    uint32x4_t w[4];
    for (int i = 0; i < 4; i++)
      w[i] = vreinterpretq_u32_u8(vrev32q_u8(vld1q_u8(blocks + (size_t)i * 16)));
    for (int i = 0; i < 16; i++) {
      const uint32x4_t added = vaddq_u32(w[i & 3], vld1q_u32(constants + (size_t)i * 4)), abcd_now = abcd;
      abcd = vsha256hq_u32(abcd, efgh, added);
      efgh = vsha256h2q_u32(efgh, abcd_now, added);
      w[i & 3] = vsha256su1q_u32(vsha256su0q_u32(w[i & 3], w[(i + 1) & 3]), w[(i + 2) & 3], w[(i + 3) & 3]);
    }
    abcd = vaddq_u32(abcd, abcd_before);
    efgh = vaddq_u32(efgh, efgh_before);
  }
  vst1q_u32(state, abcd);
  vst1q_u32(state + 4, efgh);
}

#else

static int has_instructions(void) {
  return 0;
}

void conic_sha256_mix_blocks(uint32_t state[8], const uint32_t constants[64], const unsigned char *blocks, size_t n) {
  (void)state, (void)constants, (void)blocks, (void)n;
}

#endif

/* Asked once: in a virtual machine the question takes as long as some kilobytes. */
int conic_sha256_has_instructions(void) {
  static atomic_int known; /* 0: not yet; else 1 more than the answer */
  int answer = atomic_load_explicit(&known, memory_order_relaxed);
  if (answer == 0) {
    answer = 1 + (has_instructions() != 0);
    atomic_store_explicit(&known, answer, memory_order_relaxed);
  }
  return answer - 1;
}
