/* Gaussians along Morton's curve, in place. */
#include <string.h>

#include "core/base/memory.h"
#include "core/base/radix.h"
#include "core/base/real.h"
#include "gaussians/scene/gaussian_set.h"

enum { AXIS_BITS = 16 };

/* Two zeros between any two bits. */
static uint64_t spread(uint64_t bits) {
  bits = (bits | bits << 32) & UINT64_C(0x1f00000000ffff);
  bits = (bits | bits << 16) & UINT64_C(0x1f0000ff0000ff);
  bits = (bits | bits << 8) & UINT64_C(0x100f00f00f00f00f);
  bits = (bits | bits << 4) & UINT64_C(0x10c30c30c30c30c3);
  return (bits | bits << 2) & UINT64_C(0x1249249249249249);
}

/* Places that are not finite come last. */
static uint64_t find_key(const conic_gaussians *gaussians, size_t i, const double low[3], const double per_cell[3]) {
  uint64_t key = 0;
  for (int axis = 0; axis < 3; axis++) {
    double cell = (conic_gaussians_mean(gaussians, axis, i) - low[axis]) * per_cell[axis];
    if (!(cell >= 0.0 && cell < 65536.0))
      return ((uint64_t)1 << 3 * AXIS_BITS) - 1;
    key |= spread((uint64_t)cell) << axis;
  }
  return key;
}

/* Moves elements of `bytes` to where order[i] says that element i comes from, along the cycles of the order, whose
 * places it marks by their own numbers. */
static void permute(char *elements, size_t bytes, const uint32_t *order, size_t n, unsigned char *is_done) {
  char room[CONIC_MOST_HARMONICS * sizeof(float)];
  memset(is_done, 0, n);
  for (size_t first = 0; first < n; first++) {
    if (is_done[first] || order[first] == first)
      continue;
    memcpy(room, elements + first * bytes, bytes);
    size_t to = first;
    for (size_t from = order[to]; from != first; to = from, from = order[to]) {
      memcpy(elements + to * bytes, elements + from * bytes, bytes);
      is_done[to] = 1;
    }
    memcpy(elements + to * bytes, room, bytes);
    is_done[to] = 1;
  }
}

static conic_status find_order(conic_context *context, const conic_gaussians *gaussians, uint32_t *order) {
  conic_radix_item *items = conic_memory_allocate(context, gaussians->count, sizeof *items);
  double low[3], high[3], per_cell[3];
  if (!items)
    return CONIC_ERROR_MEMORY;
  conic_gaussians_bounds(gaussians, low, high);
  for (int axis = 0; axis < 3; axis++)
    per_cell[axis] = high[axis] > low[axis] ? 65535.0 / (high[axis] - low[axis]) : 0.0;
  for (size_t i = 0; i < gaussians->count; i++)
    items[i] = (conic_radix_item){find_key(gaussians, i, low, per_cell), (uint32_t)i};
  conic_status status = conic_radix_sort(context, items, gaussians->count, 3 * AXIS_BITS);
  for (size_t i = 0; status == CONIC_OK && i < gaussians->count; i++)
    order[i] = items[i].value;
  conic_memory_release(context, items);
  return status;
}

conic_status conic_gaussians_sort(conic_context *context, conic_gaussians *gaussians) {
  size_t n = gaussians->count, n_harmonics = conic_harmonics_of_degree(gaussians->sh_degree);
  float **columns[CONIC_MOST_GAUSSIAN_COLUMNS];
  uint32_t *order = conic_memory_allocate(context, n, sizeof *order + 1);
  unsigned char *is_done = order ? (unsigned char *)(order + n) : NULL;
  conic_status status = order ? find_order(context, gaussians, order) : CONIC_ERROR_MEMORY;
  int n_columns = conic_gaussians_list_columns(gaussians, columns);
  for (int i = 0; status == CONIC_OK && i < n_columns; i++)
    permute((char *)*columns[i], sizeof(float), order, n, is_done);
  if (status == CONIC_OK && gaussians->sh)
    permute((char *)gaussians->sh, n_harmonics * sizeof(float), order, n, is_done);
  else if (status == CONIC_OK)
    permute((char *)gaussians->sh_half, n_harmonics * sizeof(uint16_t), order, n, is_done);
  conic_memory_release(context, order);
  return status;
}
