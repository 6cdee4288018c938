/* A branch of a layered cloud, as it is kept while that is built: first its place, 24 bytes, then its bytes. */
#include "tests/fuzz/fuzz.h"

#include "core/base/memory.h"
#include "lod/layers/build/layers_raws.h"

/* What all runs share. */
typedef struct fuzz_tree {
  conic_layers_payload payload;
  conic_layers_plan plan;
  conic_layers_pool pool;
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
  FUZZ_CHECK(conic_layers_pool_begin(&tree->plan, "fuzz.lpc", 1 << 20, &tree->pool) == CONIC_OK);
  FUZZ_CHECK(conic_layers_worker_create(&tree->plan, &tree->pool, &tree->worker) == CONIC_OK);
  FUZZ_CHECK(conic_pile_begin(context, "fuzz.lpc", &tree->clouds) == CONIC_OK);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n_bytes) {
  static fuzz_tree tree;
  fuzz_input input = fuzz_open(bytes, n_bytes);
  uint64_t place[3] = {0};
  conic_layers_node *node = NULL;
  if (!tree.worker)
    begin_tree(input.context, &tree);
  if (n_bytes >= sizeof place) {
    memcpy(place, bytes, sizeof place);
    atomic_store(&tree.clouds.n_bytes, 0);
    conic_layers_packed packed = {.context = input.context, .clouds = &tree.clouds};
    const conic_layers_kept_branch kept = {.key = place[0], .n_bits = (unsigned)(place[1] & 63), .n_samples = place[2]};
    conic_status status =
        conic_layers_branch_unpack(tree.worker, bytes + sizeof place, n_bytes - sizeof place, &kept, &packed, &node);
    FUZZ_CHECK((status == CONIC_OK) == (node != NULL) && (node || status == CONIC_ERROR_INPUT));
    if (node) { /* as its parent does */
      const conic_layers_grown grown = {
          .node = node, .entries = packed.entries, .n_entries = packed.n_entries, .outlines = tree.worker->outlines};
      unsigned char *again;
      size_t n_again;
      FUZZ_CHECK(conic_layers_branch_pack(&tree.plan, &grown, &tree.clouds, &again, &n_again) == CONIC_OK);
      conic_memory_release(input.context, again);
      FUZZ_CHECK(conic_layers_finish_root(tree.worker, node, &packed) == CONIC_OK);
    }
    conic_layers_node_destroy(node);
    conic_layers_packed_release(&packed);
  }
  fuzz_close(&input, CONIC_OK, 0);
  return 0;
}
