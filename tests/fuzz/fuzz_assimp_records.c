#include "tests/fuzz/fuzz.h"

#include "core/assimp/assimp_read.h"

/* What the process that reads a file writes, were it to write anything. */
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n_bytes) {
  conic_model model;
  conic_triangles triangles;
  conic_read_options options;
  fuzz_input input = fuzz_open(bytes, n_bytes);
  conic_input named = {.context = input.context, .name = input.path};
  conic_assimp_process process = {.context = input.context, .name = input.path, .descriptor = input.descriptor};
  conic_read_options_init(&options);
  options.keeps_faces = 1;
  FUZZ_CHECK(lseek(input.descriptor, 0, SEEK_SET) == 0);
  conic_status status = conic_assimp_read_records(&named, &process, &options, &model);
  for (size_t i = 0; i < model.n_triangles; i++)
    for (int corner = 0; corner < 3; corner++)
      FUZZ_CHECK(model.triangles[i][corner] < model.points.count);
  if (status == CONIC_OK && model.n_triangles > 0) {
    FUZZ_CHECK(conic_triangles_take(input.context, &model, &triangles) == CONIC_OK);
    FUZZ_CHECK(conic_triangles_check(input.context, &triangles, "fuzz") == CONIC_OK);
    conic_triangles_release(input.context, &triangles);
  }
  conic_model_release(input.context, &model);
  int is_memory = status == CONIC_ERROR_MEMORY; /* numbers that nobody checks before they are asked for */
  fuzz_close(&input, is_memory ? CONIC_ERROR_INPUT : status, 0);
  return 0;
}
