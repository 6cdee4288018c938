/* Hybrid models. Their sums would stop nearly every input at the door, so each also comes in with its sums made right.
 */
/* First, for what it defines. */
#include "tests/fuzz/fuzz.h"

#include "lod/hybrid/model/hybrid_layout.h"
#include "tests/support/mend.h"

/* What is read can be used, whatever it says of itself; of what is opened, chunks may be damaged. */
static void use(fuzz_input *input, conic_hybrid *hybrid, int is_whole) {
  conic_hybrid_info info;
  conic_hybrid_defects found;
  conic_hybrid_selection selection;
  conic_hybrid_view view;
  conic_render_options render;
  conic_camera camera;
  conic_framing framing;
  memset(&selection, 0, sizeof selection);
  FUZZ_CHECK(conic_hybrid_describe(hybrid, &info) == CONIC_OK);
  FUZZ_CHECK(!is_whole || conic_hybrid_check(hybrid, &found) == CONIC_OK);
  conic_framing_init(&framing);
  conic_render_options_init(&render);
  conic_hybrid_view_init(&view);
  render.near_z = 0.1;
  const double low[3] = {-1, -1, -1}, high[3] = {1, 1, 1};
  FUZZ_CHECK(conic_camera_frame(input->context, &framing, low, high, &camera) == CONIC_OK);
  for (int i = 0; i < 4; i++) {
    view.error_px = i == 1 ? 1.0 : 0.0;
    view.only_kind = i - 2 < 0 ? -1 : i - 2;
    render.cull_back = i & 1;
    conic_status status = conic_hybrid_select(hybrid, &camera, &render, &view, &selection);
    FUZZ_CHECK(status == CONIC_OK || (!is_whole && status == CONIC_ERROR_INPUT));
    if (status != CONIC_OK)
      continue;
    FUZZ_CHECK(conic_triangles_check(input->context, &selection.triangles, "selection") == CONIC_OK);
    FUZZ_CHECK(selection.n_clusters[0] + selection.n_clusters[1] + selection.n_joined + selection.n_culled ==
               info.n_clusters);
  }
  conic_hybrid_selection_release(input->context, &selection);
}

static conic_status read_whole(const uint8_t *bytes, size_t n_bytes) {
  conic_hybrid *hybrid;
  fuzz_input input = fuzz_open(bytes, n_bytes);
  conic_status status = conic_hybrid_read(input.context, input.path, &hybrid);
  if (status == CONIC_OK)
    use(&input, hybrid, 1);
  conic_hybrid_destroy(hybrid);
  fuzz_close(&input, status, 0);
  return status;
}

/* Where a file is sound, it can be opened, too; damaged chunks are told when a picture reads them. */
static void read_by_ranges(const uint8_t *bytes, size_t n_bytes, conic_status whole) {
  conic_hybrid *hybrid;
  conic_layers_access access;
  fuzz_input input = fuzz_open(bytes, n_bytes);
  conic_layers_access_init(&access);
  access.memory_bytes = n_bytes % 2 ? 0 : (uint64_t)1 << 22;
  conic_status status = conic_hybrid_open(input.context, input.path, &access, &hybrid);
  int n_messages = fuzz_n_messages;
  FUZZ_CHECK(status == CONIC_OK || whole != CONIC_OK);
  if (status == CONIC_OK)
    use(&input, hybrid, 0);
  conic_hybrid_destroy(hybrid);
  fuzz_n_messages = n_messages;
  fuzz_close(&input, status, 0);
}

static void read_and_use(const uint8_t *bytes, size_t n_bytes) {
  read_by_ranges(bytes, n_bytes, read_whole(bytes, n_bytes));
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n_bytes) {
  read_and_use(bytes, n_bytes);
  if (n_bytes < CONIC_FILE_HEADER_BYTES)
    return 0;
  uint8_t *mended = malloc(n_bytes);
  FUZZ_CHECK(mended);
  memcpy(mended, bytes, n_bytes);
  mend_hybrid(mended, n_bytes);
  read_and_use(mended, n_bytes);
  free(mended);
  return 0;
}
