/* Points of every format, a batch at a time: as many as at once, and nothing where that is refused. */
#include "tests/fuzz/fuzz.h"

static conic_status count_points(void *cookie, const conic_splats *batch) {
  *(size_t *)cookie += batch->count;
  return CONIC_OK;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n_bytes) {
  conic_model model;
  conic_model_kind kind;
  size_t n_points = 0;
  if (conic_assimp_find_content("", (const char *)bytes, n_bytes, n_bytes, &kind))
    return -1; /* which would start a process */
  fuzz_input input = fuzz_open(bytes, n_bytes);
  conic_status status = conic_model_stream(input.context, input.path, NULL, count_points, &n_points);
  int n_messages = fuzz_n_messages;
  conic_status at_once = conic_model_read(input.context, input.path, NULL, &model);
  if (at_once == CONIC_OK)
    FUZZ_CHECK(status == CONIC_OK && n_points == model.points.count);
  conic_model_release(input.context, &model);
  fuzz_n_messages = n_messages;
  fuzz_close(&input, status, 1);
  return 0;
}
