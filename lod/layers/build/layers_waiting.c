#include "lod/layers/build/layers_waiting.h"

#include <string.h>

#include "core/base/memory.h"

conic_status conic_layers_waiting_begin(const conic_layers_plan *plan, const char *path, size_t memory_bytes,
                                        conic_layers_waiting *waiting) {
  waiting->context = plan->context;
  waiting->sample_bytes = plan->sample_bytes;
  waiting->most_drawn = conic_layers_most_in_leaf(plan);
  waiting->key_bits = 3 * plan->bits;
  atomic_init(&waiting->n_held, 0);
  waiting->most_held = memory_bytes;
  return conic_pile_begin(plan->context, path, &waiting->pile);
}

void conic_layers_waiting_end(conic_layers_waiting *waiting) {
  conic_pile_end(&waiting->pile);
}

static size_t samples_bytes(const conic_layers_branch *branch) {
  return branch->n_drawn * branch->stride;
}

static size_t keys_bytes(const conic_layers_branch *branch) {
  return branch->n_drawn * sizeof *branch->keys;
}

static size_t facets_bytes(const conic_layers_branch *branch) {
  return branch->n_drawn * sizeof *branch->facets;
}

conic_status conic_layers_hold(conic_layers_waiting *waiting, conic_layers_branch *branch) {
  branch->waiting = waiting;
  branch->samples = conic_memory_allocate(waiting->context, branch->n_drawn, branch->stride);
  branch->keys = conic_memory_allocate(waiting->context, branch->n_drawn, sizeof *branch->keys);
  branch->facets = conic_memory_allocate(waiting->context, branch->n_drawn, sizeof *branch->facets);
  atomic_fetch_add(&waiting->n_held, samples_bytes(branch) + keys_bytes(branch) + facets_bytes(branch));
  return branch->samples && branch->keys && branch->facets ? CONIC_OK : CONIC_ERROR_MEMORY;
}

void conic_layers_drop_samples(conic_layers_branch *branch) {
  if (!branch->samples)
    return;
  conic_memory_release(branch->waiting->context, branch->samples);
  branch->samples = NULL;
  atomic_fetch_sub(&branch->waiting->n_held, samples_bytes(branch));
}

void conic_layers_drop_keys(conic_layers_branch *branch) {
  if (branch->keys)
    atomic_fetch_sub(&branch->waiting->n_held, keys_bytes(branch) + facets_bytes(branch));
  conic_memory_release(branch->waiting->context, branch->keys);
  conic_memory_release(branch->waiting->context, branch->facets);
  branch->keys = NULL;
  branch->facets = NULL;
}

static int holds_too_much(conic_layers_waiting *waiting) {
  return atomic_load(&waiting->n_held) > waiting->most_held;
}

static conic_status put_one_away(conic_layers_branch *branch) {
  conic_status status = CONIC_OK;
  if (branch->samples)
    status = conic_pile_append(&branch->waiting->pile, branch->samples, samples_bytes(branch), &branch->samples_at);
  if (status == CONIC_OK && branch->keys)
    status = conic_pile_append(&branch->waiting->pile, branch->keys, keys_bytes(branch), &branch->keys_at);
  if (status == CONIC_OK && branch->keys)
    status = conic_pile_append(&branch->waiting->pile, branch->facets, facets_bytes(branch), &branch->facets_at);
  if (status != CONIC_OK)
    return status;
  conic_layers_drop_samples(branch);
  conic_layers_drop_keys(branch);
  return CONIC_OK;
}

conic_status conic_layers_put_away(conic_layers_branch *const *branches, size_t n) {
  conic_status status = CONIC_OK;
  for (size_t i = 0; i < n && status == CONIC_OK && branches[i] && holds_too_much(branches[i]->waiting); i++) {
    status = put_one_away(branches[i]);
    if (status == CONIC_OK)
      status = conic_layers_put_away(branches[i]->children, 2);
  }
  return status;
}

conic_status conic_layers_fetch_samples(const conic_layers_branch *branch, unsigned char *samples) {
  if (!branch->samples)
    return conic_pile_read(&branch->waiting->pile, branch->samples_at, samples, samples_bytes(branch));
  memcpy(samples, branch->samples, samples_bytes(branch));
  return CONIC_OK;
}

conic_status conic_layers_fetch_keys(const conic_layers_branch *branch, size_t first, size_t n, uint64_t *keys) {
  if (!branch->keys)
    return conic_pile_read(&branch->waiting->pile, branch->keys_at + first * sizeof *keys, keys, n * sizeof *keys);
  memcpy(keys, branch->keys + first, n * sizeof *keys);
  return CONIC_OK;
}

conic_status conic_layers_fetch_facets(const conic_layers_branch *branch, size_t first, size_t n,
                                       conic_layers_facet *facets) {
  if (!branch->facets)
    return conic_pile_read(&branch->waiting->pile, branch->facets_at + first * sizeof *facets, facets,
                           n * sizeof *facets);
  memcpy(facets, branch->facets + first, n * sizeof *facets);
  return CONIC_OK;
}
