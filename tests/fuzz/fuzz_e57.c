/* The sums of pages would stop nearly every input at the door, so each also comes in with its sums made right. */
#include "tests/fuzz/fuzz.h"

#include "core/scans/e57_file.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n_bytes) {
  uint8_t *mended = malloc(n_bytes + 1);
  FUZZ_CHECK(mended);
  fuzz_model(bytes, n_bytes, CONIC_MODEL_E57);
  memcpy(mended, bytes, n_bytes);
  conic_e57_mend(mended, n_bytes);
  fuzz_model(mended, n_bytes, CONIC_MODEL_E57);
  free(mended);
  return 0;
}
