/* Keys of a motion; the files that they name are left alone. */
#include "tests/fuzz/fuzz.h"

#include "accumulation/motion_file.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n_bytes) {
  fuzz_input input = fuzz_open(bytes, n_bytes);
  conic_motion_keys keys;
  conic_status status = conic_motion_keys_read(input.context, input.path, &keys);
  FUZZ_CHECK((status == CONIC_OK) == (keys.count > 0));
  for (size_t i = 0; i < keys.count; i++) {
    FUZZ_CHECK(keys.keys[i].has_matrix != (keys.keys[i].file != NULL));
    FUZZ_CHECK(keys.keys[i].input >= CONIC_MOTION_ALL && (i == 0 || keys.keys[i].frame >= keys.keys[i - 1].frame));
  }
  conic_motion_keys_release(input.context, &keys);
  fuzz_close(&input, status, 0);
  return 0;
}
