/* A branch of a layered cloud, as it is kept while that is built: first its place, 24 bytes, then the record. */
#include "tests/fuzz/fuzz.h"

#include "core/base/memory.h"
#include "lod/layers/build/layers_payload.h"
#include "lod/layers/build/layers_record.h"
#include "lod/layers/build/layers_waiting.h"

/* What all runs share. */
typedef struct fuzz_tree {
  conic_layers_payload payload;
  conic_layers_plan plan;
  struct conic_layers_waiting waiting;
  conic_layers_worker *worker;
  conic_pile clouds;
} fuzz_tree;

static void begin_tree(conic_context *context, fuzz_tree *tree) {
  float none = 0.0f;
  const conic_splats like = {.color = {&none, &none, &none}};
  FUZZ_CHECK(conic_layers_payload_begin(context, &like, 0, 1.5f, &tree->payload) == CONIC_OK);
  conic_layers_payload_settle(&tree->payload, 1.0);
  tree->plan = (conic_layers_plan){.context = context,
                                   .bits = CONIC_LAYERS_MOST_BITS,
                                   .cloud_size = 64,
                                   .n_samples = 1000,
                                   .sample_bytes = tree->payload.schema.sample_bytes,
                                   .quantum = 1.0,
                                   .spacing = 1.0,
                                   .schema = &tree->payload.schema,
                                   .cutoff = 1.5f};
  FUZZ_CHECK(conic_layers_waiting_begin(&tree->plan, "fuzz.lpc", 1 << 20, &tree->waiting) == CONIC_OK);
  FUZZ_CHECK(conic_layers_worker_create(&tree->plan, &tree->waiting, &tree->worker) == CONIC_OK);
  FUZZ_CHECK(conic_pile_begin(context, "fuzz.lpc", &tree->clouds) == CONIC_OK);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n_bytes) {
  static fuzz_tree tree;
  fuzz_input input = fuzz_open(bytes, n_bytes);
  uint64_t place[3] = {0};
  conic_layers_branch *branch = NULL;
  if (!tree.worker)
    begin_tree(input.context, &tree);
  if (n_bytes >= sizeof place) {
    memcpy(place, bytes, sizeof place);
    atomic_store(&tree.clouds.n_bytes, 0);
    conic_layers_shelf shelf = {.context = input.context, .clouds = &tree.clouds};
    const conic_layers_kept_branch kept = {.key = place[0], .n_bits = (unsigned)(place[1] & 63), .n_samples = place[2]};
    conic_status status =
        conic_layers_record_unpack(tree.worker, bytes + sizeof place, n_bytes - sizeof place, &kept, &shelf, &branch);
    FUZZ_CHECK((status == CONIC_OK) == (branch != NULL) && (branch || status == CONIC_ERROR_INPUT));
    if (branch) { /* as its parent does */
      const conic_layers_grown grown = {.branch = branch,
                                        .nodes = shelf.nodes,
                                        .n_nodes = shelf.n_nodes,
                                        .outlines = conic_layers_worker_outlines(tree.worker)};
      unsigned char *again;
      size_t n_again;
      FUZZ_CHECK(conic_layers_record_pack(&tree.plan, &grown, &tree.clouds, &again, &n_again) == CONIC_OK);
      conic_memory_release(input.context, again);
      FUZZ_CHECK(conic_layers_finish_root(tree.worker, branch, &shelf) == CONIC_OK);
    }
    conic_layers_branch_destroy(branch);
    conic_layers_shelf_release(&shelf);
  }
  fuzz_close(&input, CONIC_OK, 0);
  return 0;
}
