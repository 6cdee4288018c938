/* Files of cameras in every format that is told by its content. What is read can be looked through, and found by its
 * name. */
#include "core/image/view_arguments.h"
#include "tests/fuzz/fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n_bytes) {
  conic_cameras cameras;
  conic_cameras_options options;
  fuzz_input input = fuzz_open(bytes, n_bytes);
  conic_cameras_options_init(&options);
  options.width = n_bytes % 2 ? 100 : 0;
  options.height = n_bytes % 2 ? 7 : 0;
  conic_status status = conic_cameras_read(input.context, input.path, &options, &cameras);
  int n_messages = fuzz_n_messages;
  size_t i_camera;
  char wrong[CONIC_CAMERA_FAULT_ROOM];
  FUZZ_CHECK((status == CONIC_OK) == (cameras.count > 0));
  for (size_t i = 0; i < cameras.count; i++)
    FUZZ_CHECK(!conic_camera_is_wrong(&cameras.cameras[i], wrong));
  if (cameras.count)
    conic_cameras_find(input.context, &cameras, cameras.names[cameras.count - 1], &i_camera);
  fuzz_n_messages = n_messages;
  conic_cameras_release(input.context, &cameras);
  conic_cameras_is_file(input.context, input.path);
  fuzz_close(&input, status, 1);
  return 0;
}
