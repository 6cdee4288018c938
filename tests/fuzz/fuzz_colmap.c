/* Both files of a model of COLMAP, one behind the other. */
#include "core/image/view_arguments.h"
#include "tests/fuzz/fuzz.h"
#include "tests/support/camera_files.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n_bytes) {
  conic_cameras cameras;
  char wrong[CONIC_CAMERA_FAULT_ROOM];
  fuzz_input input = fuzz_open(bytes, n_bytes);
  conic_status status = camera_read_joined(input.context, "colmap", bytes, n_bytes, &cameras);
  FUZZ_CHECK((status == CONIC_OK) == (cameras.count > 0));
  for (size_t i = 0; i < cameras.count; i++)
    FUZZ_CHECK(!conic_camera_is_wrong(&cameras.cameras[i], wrong));
  conic_cameras_release(input.context, &cameras);
  fuzz_close(&input, status, 0);
  return 0;
}
