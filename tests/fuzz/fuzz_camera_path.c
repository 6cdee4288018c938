/* Keys of a camera's way: whatever they are, the cameras between them can be looked through. */
#include "tests/fuzz/fuzz.h"

#include "core/cameras/camera_path.h"
#include "core/image/view_arguments.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n_bytes) {
  fuzz_input input = fuzz_open(bytes, n_bytes);
  conic_camera_path path;
  conic_cameras cameras = {.count = 0};
  char wrong[CONIC_CAMERA_FAULT_ROOM];
  const int size[2] = {n_bytes % 2 ? 100 : 0, n_bytes % 2 ? 7 : 0};
  const double up[3] = {0.0, 0.0, 1.0};
  conic_status status = conic_camera_path_read(input.context, input.path, size, &path);
  FUZZ_CHECK((status == CONIC_OK) == (path.n > 1));
  int n_messages = fuzz_n_messages;
  if (status == CONIC_OK && !path.has_up)
    conic_camera_path_stand(&path, up);
  if (status == CONIC_OK && path.keys[path.n - 1].time - path.keys[0].time < 100.0) {
    FUZZ_CHECK(conic_camera_path_list(input.context, &path, 7.0, &cameras) == CONIC_OK);
    for (size_t i = 0; i < cameras.count; i++)
      FUZZ_CHECK(!conic_camera_is_wrong(&cameras.cameras[i], wrong));
  }
  fuzz_n_messages = n_messages;
  conic_cameras_release(input.context, &cameras);
  conic_camera_path_release(input.context, &path);
  fuzz_close(&input, status, 1);
  return 0;
}
