/* Layered point clouds. Their sums would stop nearly every input at the door, so each also comes in with its sums made
 * right. */
/* First, for what it defines. */
#include "tests/fuzz/fuzz.h"

#include "lod/layers/format/layers_format.h"
#include "tests/support/mend.h"

/* What is read can be looked at, whatever it says of itself. */
static void read_and_use(const uint8_t *bytes, size_t n_bytes) {
  conic_layers_info info;
  conic_layers_defects found;
  fuzz_input input = fuzz_open(bytes, n_bytes);
  conic_status status = conic_layers_describe(input.context, input.path, &info);
  if (status == CONIC_OK)
    FUZZ_CHECK(conic_layers_check(input.context, input.path, &found) == CONIC_OK);
  fuzz_close(&input, status, 0);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n_bytes) {
  read_and_use(bytes, n_bytes);
  if (n_bytes < CONIC_LAYERS_HEADER_BYTES)
    return 0;
  uint8_t *mended = malloc(n_bytes);
  FUZZ_CHECK(mended);
  memcpy(mended, bytes, n_bytes);
  mend_layers(mended, n_bytes);
  read_and_use(mended, n_bytes);
  free(mended);
  return 0;
}
