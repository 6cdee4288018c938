/* The files of a hierarchy, joined (tests/support/hierarchy_parts.h). */
/* First, for what it defines. */
#include "tests/fuzz/fuzz.h"

#include "tests/support/hierarchy_parts.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n_bytes) {
  fuzz_input input = fuzz_open(bytes, n_bytes);
  fuzz_close(&input, hierarchy_read_parts(input.context, 0, bytes, n_bytes), 0);
  return 0;
}
