#include "tests/fuzz/fuzz_image.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n_bytes) {
  return fuzz_image(bytes, n_bytes, "\x89PNG", 4);
}
