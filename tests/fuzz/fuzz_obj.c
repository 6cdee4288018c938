#include "tests/fuzz/fuzz.h"

/* As a model, and as triangles: what can be read as the one with faces can be read as the other, unless a material file
 * that it names is spoiled. */
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n_bytes) {
  fuzz_input input = fuzz_open(bytes, n_bytes);
  conic_triangles triangles;
  conic_status status = conic_triangles_read(input.context, input.path, &triangles);
  FUZZ_CHECK(conic_triangles_check(input.context, &triangles, "fuzz") == CONIC_OK);
  conic_triangles_release(input.context, &triangles);
  fuzz_close(&input, status, 1);
  return fuzz_model(bytes, n_bytes, CONIC_MODEL_OBJ);
}
