#include "lod/layers/build/layers_parcel.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "core/base/memory.h"
#include "lod/layers/build/layers_waiting.h"

static size_t parcel_facets_bytes(const conic_layers_branch *branch) {
  return (branch->n_drawn * sizeof *branch->facets + 7) / 8 * 8;
}

/* Of a branch in bytes: whether it has its two children, the end of the struct as it is, then its samples if it has
 * some, its keys and facets, and its children; all of it a multiple of 8. */
#define KEPT_AT offsetof(conic_layers_branch, first_key)
#define HEAD_BYTES (sizeof(uint64_t) + sizeof(conic_layers_branch) - KEPT_AT)

/* Branches hang on each other no deeper than keys have bits, and counts of samples that coincide. */
enum { MOST_DEPTH = 128 };

static size_t own_bytes(const conic_layers_branch *branch, int has_samples) {
  return HEAD_BYTES + branch->n_drawn * ((has_samples ? branch->stride : 0) + sizeof *branch->keys) +
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
  uint64_t has_children = branch->children[0] != NULL;
  memcpy(*at, &has_children, sizeof has_children);
  memcpy(*at + sizeof has_children, (const char *)branch + KEPT_AT, HEAD_BYTES - sizeof has_children);
  *at += HEAD_BYTES;
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

/* --- the other way --- */

typedef struct unpacking {
  conic_layers_waiting *waiting;
  const unsigned char *at, *end;
} unpacking;

static int are_numbers_sound(const conic_layers_branch *b) {
  const double *numbers[] = {&b->area,    &b->distance, &b->covering, &b->radius,    &b->past,
                             &b->part,    b->low,       b->low + 1,   b->low + 2,    b->high,
                             b->high + 1, b->high + 2,  b->center,    b->center + 1, b->center + 2,
                             &b->sphere,  b->axis,      b->axis + 1,  b->axis + 2,   &b->cone};
  for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
    if (!(fabs(*numbers[i]) < 1e15))
      return 0;
  return 1;
}

static int is_branch_sound(const conic_layers_waiting *waiting, const conic_layers_branch *branch) {
  return branch->n_drawn > 0 && branch->n_drawn <= waiting->most_drawn && branch->n_place >= branch->n_drawn &&
         branch->first_key <= branch->last_key && branch->last_key >> waiting->key_bits == 0 &&
         (branch->is_leaf == 0 || branch->is_leaf == 1) && are_numbers_sound(branch);
}

static int are_keys_sound(const conic_layers_branch *branch, int has_samples) {
  uint64_t before = branch->first_key;
  for (size_t i = 0; i < branch->n_drawn; i++) {
    uint64_t key = branch->keys[i];
    if (key < before || key > branch->last_key || (has_samples && conic_layers_drawn_at(branch, i)->key != key))
      return 0;
    before = key;
  }
  return 1;
}

/* The head, past which it moves. */
static conic_status unpack_head(unpacking *u, int has_samples, uint64_t *has_children, conic_layers_branch *made) {
  if ((size_t)(u->end - u->at) < HEAD_BYTES)
    return CONIC_ERROR_INPUT;
  memcpy(has_children, u->at, sizeof *has_children);
  memcpy((char *)made + KEPT_AT, u->at + sizeof *has_children, HEAD_BYTES - sizeof *has_children);
  made->stride = u->waiting->sample_bytes;
  made->waiting = u->waiting;
  if (!is_branch_sound(u->waiting, made) || (size_t)(u->end - u->at) < own_bytes(made, has_samples)) {
    made->n_drawn = 0;
    return CONIC_ERROR_INPUT;
  }
  u->at += HEAD_BYTES;
  return CONIC_OK;
}

static conic_status unpack_arrays(unpacking *u, int has_samples, conic_layers_branch *made) {
  size_t n = made->n_drawn;
  conic_status status = conic_layers_hold(u->waiting, made);
  if (status != CONIC_OK)
    return status;
  if (has_samples)
    memcpy(made->samples, u->at, n * made->stride);
  u->at += has_samples ? n * made->stride : 0;
  memcpy(made->keys, u->at, n * sizeof *made->keys);
  u->at += n * sizeof *made->keys;
  memcpy(made->facets, u->at, n * sizeof *made->facets);
  u->at += parcel_facets_bytes(made);
  if (!are_keys_sound(made, has_samples))
    return CONIC_ERROR_INPUT;
  if (!has_samples)
    conic_layers_drop_samples(made);
  return CONIC_OK;
}

static conic_status unpack(unpacking *u, int depth, conic_layers_branch **branch) {
  uint64_t has_children;
  conic_layers_branch *made = conic_memory_allocate_zeroed(u->waiting->context, 1, sizeof *made);
  if (!made)
    return CONIC_ERROR_MEMORY;
  made->waiting = u->waiting;
  *branch = made;
  conic_status status = unpack_head(u, depth == 0, &has_children, made);
  if (status == CONIC_OK)
    status = unpack_arrays(u, depth == 0, made);
  if (status == CONIC_OK && (depth == MOST_DEPTH || has_children > 1))
    status = CONIC_ERROR_INPUT;
  for (int i = 0; i < 2 && has_children && status == CONIC_OK; i++)
    status = unpack(u, depth + 1, &made->children[i]);
  return status;
}

conic_status conic_layers_parcel_unpack(conic_layers_waiting *waiting, const unsigned char *bytes, size_t n_bytes,
                                        conic_layers_branch **branch) {
  unpacking u = {waiting, bytes, bytes + n_bytes};
  *branch = NULL;
  conic_status status = unpack(&u, 0, branch);
  if (status == CONIC_OK && u.at == u.end)
    return CONIC_OK;
  conic_layers_branch_destroy(*branch);
  *branch = NULL;
  return status == CONIC_OK ? CONIC_ERROR_INPUT : status;
}
