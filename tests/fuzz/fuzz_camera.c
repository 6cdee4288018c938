#include "tests/fuzz/fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n_bytes) {
  conic_camera camera;
  fuzz_input input = fuzz_open(bytes, n_bytes);
  conic_status status = conic_camera_read(input.context, input.path, &camera);
  if (status == CONIC_OK)
    FUZZ_CHECK(camera.width >= 1 && camera.height >= 1 && camera.fx > 0.0 && camera.fx < 1e12);
  fuzz_close(&input, status, 0);
  return 0;
}
