/* Copies past the caches, for data that are written once and not read soon: an image's rows. */
#pragma once

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

static inline void conic_stream_copy(void *to, const void *from, size_t bytes) {
  size_t done = 0;
#if defined(__SSE2__)
  for (; (uintptr_t)to % 16 == 0 && done + 16 <= bytes; done += 16)
    _mm_stream_si128((__m128i *)(void *)((char *)to + done),
                     _mm_loadu_si128((const __m128i *)(const void *)((const char *)from + done)));
#endif
  memcpy((char *)to + done, (const char *)from + done, bytes - done);
}

/* Must be called before other threads read streamed data. */
static inline void conic_stream_fence(void) {
#if defined(__SSE2__)
  _mm_sfence();
#endif
}
