#include "tests/fuzz/fuzz_image.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n_bytes) {
  return fuzz_image(bytes, n_bytes, n_bytes > 1 && bytes[0] == 'P' ? "PK\3\4" : "\x93NUM", 4);
}
