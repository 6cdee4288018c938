/* Octrees. Their sums would stop nearly every input at the door, so each also comes in with its sums made right. */
/* First, for what it defines. */
#include "tests/fuzz/fuzz.h"

#include "lod/octree/octree_nodes.h"

enum { HEADER_BYTES = 256 };

/* What is read can be used, whatever it says of itself. */
static void use(fuzz_input *input, conic_octree *octree) {
  conic_octree_info info;
  conic_octree_defects found;
  conic_selection selection;
  conic_selection_options options;
  conic_render_options render;
  conic_camera camera;
  conic_framing framing;
  memset(&selection, 0, sizeof selection);
  FUZZ_CHECK(conic_octree_describe(octree, &info) == CONIC_OK);
  FUZZ_CHECK(conic_octree_check(octree, &found) == CONIC_OK);
  conic_framing_init(&framing);
  conic_render_options_init(&render);
  conic_selection_options_init(&options);
  render.kernel.cutoff = info.cutoff;
  render.near_z = 0.1;
  const double low[3] = {-1, -1, -1}, high[3] = {1, 1, 1};
  FUZZ_CHECK(conic_camera_frame(input->context, &framing, low, high, &camera) == CONIC_OK);
  FUZZ_CHECK(conic_octree_select(octree, &camera, &render, &options, &selection) == CONIC_OK);
  FUZZ_CHECK(selection.splats.count <= info.n_leaves);
  options.budget = 10;
  FUZZ_CHECK(conic_octree_select(octree, &camera, &render, &options, &selection) == CONIC_OK);
  conic_selection_release(input->context, &selection);
}

static void read_and_use(const uint8_t *bytes, size_t n_bytes) {
  conic_octree *octree;
  fuzz_input input = fuzz_open(bytes, n_bytes);
  conic_status status = conic_octree_read(input.context, input.path, &octree);
  if (status == CONIC_OK)
    use(&input, octree);
  conic_octree_destroy(octree);
  fuzz_close(&input, status, 0);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n_bytes) {
  read_and_use(bytes, n_bytes);
  if (n_bytes < HEADER_BYTES)
    return 0;
  uint8_t *mended = malloc(n_bytes);
  FUZZ_CHECK(mended);
  memcpy(mended, bytes, n_bytes);
  conic_octree_mend(mended, n_bytes);
  read_and_use(mended, n_bytes);
  free(mended);
  return 0;
}
