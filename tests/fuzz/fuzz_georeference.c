/* What records of a LAS say of the world, and well-known text. What is taken has the keys that it says. */
#include "tests/fuzz/fuzz.h"

#include "core/pictures/georeference.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n_bytes) {
  fuzz_input input = fuzz_open(bytes, n_bytes);
  conic_georeference reference, file;
  FUZZ_CHECK(conic_georeference_find_epsg((const char *)bytes, n_bytes) < 65536);
  FUZZ_CHECK(conic_georeference_of_las(input.context, bytes, n_bytes, &reference) == CONIC_OK);
  FUZZ_CHECK(conic_georeference_read(input.context, input.path, &file) == CONIC_OK);
  if (reference.keys)
    FUZZ_CHECK(reference.n_keys == 4 * ((size_t)reference.keys[3] + 1));
  conic_georeference_release(input.context, &reference);
  conic_georeference_release(input.context, &file);
  fuzz_close(&input, CONIC_OK, 0);
  return 0;
}
