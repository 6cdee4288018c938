/* Gaussians along Morton's curve. */

#include "core/base/radix.h"
#include "gaussians/scene/gaussian_set.h"

enum { AXIS_BITS = 16 };

/* Places that are not finite come last. */
static uint64_t find_key(const conic_gaussians *gaussians, size_t i, const double low[3], const double per_cell[3]) {
  uint64_t key = 0;
  for (int axis = 0; axis < 3; axis++) {
    double cell = (conic_gaussians_mean(gaussians, axis, i) - low[axis]) * per_cell[axis];
    if (!(cell >= 0.0 && cell < 65536.0))
      return ((uint64_t)1 << 3 * AXIS_BITS) - 1;
    key |= conic_spread_bits((uint64_t)cell) << axis;
  }
  return key;
}

enum { BLOCK = 4096 };

/* One array on its way into another order. */
typedef struct gatherer {
  const uint32_t *order;
  const char *from;
  char *to;
  size_t n, bytes; /* of an element */
} gatherer;

static void gather_block(void *data, size_t i_block) {
  const gatherer *self = data;
  size_t end = (i_block + 1) * BLOCK < self->n ? (i_block + 1) * BLOCK : self->n;
  if (self->bytes == sizeof(float))
    for (size_t i = i_block * BLOCK; i < end; i++)
      ((float *)self->to)[i] = ((const float *)self->from)[self->order[i]];
  else
    for (size_t i = i_block * BLOCK; i < end; i++)
      memcpy(self->to + i * self->bytes, self->from + self->order[i] * self->bytes, self->bytes);
}

/* Replaces an array, whose pointer is at `array`, by one in that order. Errors: MEMORY. */
static conic_status reorder(conic_context *context, void *array, size_t bytes, const uint32_t *order, size_t n) {
  gatherer self = {order, NULL, conic_memory_allocate(context, n, bytes), n, bytes};
  if (!self.to)
    return CONIC_ERROR_MEMORY;
  memcpy(&self.from, array, sizeof self.from);
  conic_parallel_for(context, (n + BLOCK - 1) / BLOCK, gather_block, &self);
  conic_memory_release(context, (void *)self.from);
  memcpy(array, &self.to, sizeof self.to);
  return CONIC_OK;
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
  uint32_t *order = conic_memory_allocate(context, n, sizeof *order);
  conic_status status = order ? find_order(context, gaussians, order) : CONIC_ERROR_MEMORY;
  int n_columns = conic_gaussians_list_columns(gaussians, columns);
  for (int i = 0; status == CONIC_OK && i < n_columns; i++)
    status = reorder(context, columns[i], sizeof(float), order, n);
  if (status == CONIC_OK && gaussians->sh)
    status = reorder(context, &gaussians->sh, n_harmonics * sizeof(float), order, n);
  else if (status == CONIC_OK)
    status = reorder(context, &gaussians->sh_half, n_harmonics * sizeof(uint16_t), order, n);
  conic_memory_release(context, order);
  return status;
}
