/* Intermediate results of another program, as .npz, held against five Gaussians. What is told lies within its array. */
#include "tests/fuzz/fuzz.h"

#include "tests/fuzz/intermediates_example.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n_bytes) {
  static conic_gaussians scene;
  static conic_gaussian_options options;
  conic_intermediates_verdict verdict;
  if (n_bytes < 4 || memcmp(bytes, "PK\3\4", 4) != 0)
    return -1;
  fuzz_input input = fuzz_open(bytes, n_bytes);
  if (!scene.count)
    scene = intermediates_example(input.context, &options);
  conic_status status = conic_gaussian_intermediates_judge(input.context, &scene, &intermediates_camera, &options, NULL,
                                                           input.path, &verdict);
  FUZZ_CHECK(verdict.n_arrays <= CONIC_MAX_JUDGED_ARRAYS && (verdict.n_arrays == 0 || status == CONIC_OK));
  for (int i = 0; i < verdict.n_arrays; i++)
    FUZZ_CHECK(verdict.arrays[i].name && verdict.arrays[i].column >= 0 &&
               (verdict.arrays[i].gaussian < scene.count || verdict.arrays[i].gaussian == CONIC_NO_ID));
  fuzz_close(&input, status, 1);
  return 0;
}
