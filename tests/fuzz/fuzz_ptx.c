#include "tests/fuzz/fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n_bytes) {
  return fuzz_model(bytes, n_bytes, CONIC_MODEL_PTX);
}
