/* COPC. */
/* First, for what it defines. */
#include "tests/fuzz/fuzz.h"

#include "tests/support/hierarchy_parts.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n_bytes) {
  fuzz_input input = fuzz_open(bytes, n_bytes);
  conic_status status = CONIC_OK;
  if (conic_layers_is_hierarchy(input.path)) /* else it is a .lpc, if anything */
    status = hierarchy_read(input.context, input.path);
  fuzz_close(&input, status, 0);
  return 0;
}
