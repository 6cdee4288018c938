/* Gaussians in levels, as they are and with their sums made right. */
/* First, for what it defines. */
#include "tests/fuzz/fuzz.h"

#include "lod/blends/levels_read.h"
#include "tests/support/mend.h"

/* Checks every cloud, then takes all, and what a picture shows. */
static void open_and_use(const uint8_t *bytes, size_t n_bytes) {
  fuzz_input input = fuzz_open(bytes, n_bytes);
  conic_levels_scene scene = {.camera = {.width = 64,
                                         .height = 64,
                                         .fx = 64.0,
                                         .fy = 64.0,
                                         .cx = 32.0,
                                         .cy = 32.0,
                                         .cam_from_world = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 9}}}};
  uint64_t found[2];
  conic_status status = conic_levels_open(input.context, input.path, NULL, &scene.levels);
  if (status == CONIC_OK) {
    FUZZ_CHECK(conic_levels_check(scene.levels, &found[0], &found[1]) == CONIC_OK);
    for (int i = 0; i < 3; i++) {
      const conic_levels_wish wish = {
          .part = i == 0 ? CONIC_LEVELS_ALL : CONIC_LEVELS_CUT, .error = i == 1 ? 0.5 : 0.0, .budget = i == 2 ? 40 : 0};
      memset(&scene.set, 0, sizeof scene.set);
      const conic_status chosen = conic_levels_choose(&scene, 1, &wish);
      FUZZ_CHECK(chosen == CONIC_OK || chosen == CONIC_ERROR_INPUT || chosen == CONIC_ERROR_MEMORY);
      conic_gaussians_release(input.context, &scene.set);
    }
  }
  conic_levels_close(scene.levels);
  FUZZ_CHECK(status == CONIC_OK || status == CONIC_ERROR_INPUT || status == CONIC_ERROR_UNSUPPORTED);
  close(input.descriptor);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n_bytes) {
  open_and_use(bytes, n_bytes);
  uint8_t *mended = malloc(n_bytes + 1);
  FUZZ_CHECK(mended);
  memcpy(mended, bytes, n_bytes);
  mend_levels(mended, n_bytes);
  open_and_use(mended, n_bytes);
  free(mended);
  return 0;
}
