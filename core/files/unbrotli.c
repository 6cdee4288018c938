#include "core/files/unbrotli.h"

#ifdef CONIC_HAVE_BROTLI

#include <brotli/decode.h>

#include "core/base/memory.h"

static void *allocate_brotli(void *context, size_t n_bytes) {
  return conic_memory_allocate(context, n_bytes, 1);
}

static void release_brotli(void *context, void *block) {
  conic_memory_release(context, block);
}

int conic_unbrotli_is_there(void) {
  return 1;
}

int conic_unbrotli(conic_context *context, const unsigned char *from, size_t n_from, unsigned char *to,
                   size_t n_bytes) {
  BrotliDecoderState *state = BrotliDecoderCreateInstance(allocate_brotli, release_brotli, context);
  if (!state)
    return 0;
  size_t n_left = n_bytes;
  int is_good =
      BrotliDecoderDecompressStream(state, &n_from, &from, &n_left, &to, NULL) == BROTLI_DECODER_RESULT_SUCCESS;
  BrotliDecoderDestroyInstance(state);
  return is_good && n_left == 0 && n_from == 0;
}

#else

int conic_unbrotli_is_there(void) {
  return 0;
}

int conic_unbrotli(conic_context *context, const unsigned char *from, size_t n_from, unsigned char *to,
                   size_t n_bytes) {
  (void)context, (void)from, (void)n_from, (void)to, (void)n_bytes;
  return 0;
}

#endif
