#include "tests/fuzz/fuzz.h"

/* The sums of samples, as --resumable keeps them. */
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n_bytes) {
  fuzz_input input = fuzz_open(bytes, n_bytes);
  conic_accumulation *sums;
  conic_accumulation_facts facts;
  conic_status status = conic_accumulation_read(input.context, input.path, &sums);
  FUZZ_CHECK((status == CONIC_OK) == (sums != NULL));
  if (sums) {
    conic_accumulation_inspect(sums, &facts);
    FUZZ_CHECK(facts.end_sample >= facts.first_sample && conic_accumulation_noise(sums) >= -1.0);
  }
  conic_accumulation_destroy(sums);
  fuzz_close(&input, status, 0);
  return 0;
}
