#include "lod/layers/build/layers_parcel.h"

#include <string.h>

#include "core/base/memory.h"
#include "lod/layers/build/layers_waiting.h"

static size_t parcel_facets_bytes(const conic_layers_branch *branch) {
  return (branch->n_drawn * sizeof *branch->facets + 7) / 8 * 8;
}

/* Of a branch in bytes: the struct as it is, with the pointers only saying what there is, then its samples if it has
 * some, its keys and facets, and its children; all of it a multiple of 8. */
static size_t own_bytes(const conic_layers_branch *branch, int has_samples) {
  return sizeof *branch + branch->n_drawn * ((has_samples ? branch->stride : 0) + sizeof *branch->keys) +
         parcel_facets_bytes(branch);
}

static size_t packed_bytes(const conic_layers_branch *branch, int has_samples) {
  size_t n = own_bytes(branch, has_samples);
  for (int i = 0; i < 2; i++)
    n += branch->children[i] ? packed_bytes(branch->children[i], 0) : 0;
  return n;
}

static conic_status pack_parcel(const conic_layers_branch *branch, int has_samples, unsigned char **at) {
  size_t n = branch->n_drawn;
  conic_status status = CONIC_OK;
  memcpy(*at, branch, sizeof *branch);
  *at += sizeof *branch;
  if (has_samples) {
    status = conic_layers_fetch_samples(branch, *at);
    *at += n * branch->stride;
  }
  if (status == CONIC_OK)
    status = conic_layers_fetch_keys(branch, 0, n, (uint64_t *)(void *)*at);
  *at += n * sizeof *branch->keys;
  if (status == CONIC_OK)
    status = conic_layers_fetch_facets(branch, 0, n, (conic_layers_facet *)(void *)*at);
  *at += parcel_facets_bytes(branch);
  for (int i = 0; i < 2 && status == CONIC_OK; i++)
    if (branch->children[i])
      status = pack_parcel(branch->children[i], 0, at);
  return status;
}

conic_status conic_layers_parcel_pack(const conic_layers_branch *branch, unsigned char **bytes, size_t *n_bytes) {
  *n_bytes = packed_bytes(branch, 1);
  *bytes = conic_memory_allocate(branch->waiting->context, *n_bytes, 1);
  unsigned char *at = *bytes;
  return at ? pack_parcel(branch, 1, &at) : CONIC_ERROR_MEMORY;
}

static conic_status unpack(conic_layers_waiting *waiting, int has_samples, const unsigned char **at,
                           conic_layers_branch **branch) {
  conic_layers_branch *made = conic_memory_allocate(waiting->context, 1, sizeof *made);
  if (!made)
    return CONIC_ERROR_MEMORY;
  memcpy(made, *at, sizeof *made);
  const int has_child[2] = {made->children[0] != NULL, made->children[1] != NULL};
  made->children[0] = made->children[1] = NULL;
  *at += sizeof *made;
  conic_status status = conic_layers_hold(waiting, made);
  if (status == CONIC_OK && has_samples) {
    memcpy(made->samples, *at, made->n_drawn * made->stride);
    *at += made->n_drawn * made->stride;
  }
  if (status == CONIC_OK) {
    memcpy(made->keys, *at, made->n_drawn * sizeof *made->keys);
    *at += made->n_drawn * sizeof *made->keys;
    memcpy(made->facets, *at, made->n_drawn * sizeof *made->facets);
    *at += parcel_facets_bytes(made);
  }
  if (!has_samples)
    conic_layers_drop_samples(made);
  for (int i = 0; i < 2 && status == CONIC_OK; i++)
    if (has_child[i])
      status = unpack(waiting, 0, at, &made->children[i]);
  *branch = made;
  return status;
}

conic_status conic_layers_parcel_unpack(conic_layers_waiting *waiting, const unsigned char *bytes, size_t n_bytes,
                                        conic_layers_branch **branch) {
  const unsigned char *at = bytes;
  (void)n_bytes;
  conic_status status = unpack(waiting, 1, &at, branch);
  if (status == CONIC_OK)
    return status;
  conic_layers_branch_destroy(*branch);
  *branch = NULL;
  return status;
}
