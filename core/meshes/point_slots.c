#include "core/meshes/point_slots.h"

/* The bits of a number, with -0 as 0. */
static uint32_t bits_of(float value) {
  uint32_t bits;
  memcpy(&bits, &value, sizeof bits);
  return value == 0.0f ? 0 : bits;
}

static uint32_t color_bits(const conic_splats *points, int channel, size_t i) {
  return bits_of(points->color[channel] ? points->color[channel][i] : 1.0f);
}

static uint32_t alpha_bits(const conic_splats *points, size_t i) {
  return bits_of(points->opacity ? points->opacity[i] : 1.0f);
}

static size_t hash_point(const conic_splats *points, size_t i) {
  uint64_t hash = alpha_bits(points, i);
  for (int axis = 0; axis < 3; axis++) {
    hash = (hash ^ bits_of(points->position[axis][i])) * UINT64_C(0x9E3779B97F4A7C15);
    hash = (hash ^ hash >> 29 ^ color_bits(points, axis, i)) * UINT64_C(0xBF58476D1CE4E5B9);
  }
  return (size_t)(hash ^ hash >> 32);
}

static int is_same_point(const conic_splats *points, size_t i, size_t j) {
  for (int axis = 0; axis < 3; axis++)
    if (bits_of(points->position[axis][i]) != bits_of(points->position[axis][j]) ||
        color_bits(points, axis, i) != color_bits(points, axis, j))
      return 0;
  return alpha_bits(points, i) == alpha_bits(points, j);
}

/* The slot of the point like this one, or the free one for it. */
static uint32_t *find_slot(const conic_splats *points, const conic_point_slots *slots, size_t i) {
  size_t slot = hash_point(points, i) & (slots->n - 1);
  while (slots->slots[slot] && !is_same_point(points, slots->slots[slot] - 1, i))
    slot = (slot + 1) & (slots->n - 1);
  return &slots->slots[slot];
}

conic_status conic_point_slots_reserve(conic_builder *builder, conic_point_slots *slots, size_t count) {
  const conic_point_slots old = *slots;
  size_t n = 1024; /* at half load */
  while (n < 2 * count)
    n *= 2;
  if (n <= old.n)
    return CONIC_OK;
  uint32_t *made = conic_memory_allocate_zeroed(builder->context, n, sizeof *made);
  if (!made)
    return CONIC_ERROR_MEMORY;
  *slots = (conic_point_slots){made, n};
  for (size_t i = 0; i < old.n; i++)
    if (old.slots[i])
      *find_slot(&builder->model->points, slots, old.slots[i] - 1) = old.slots[i];
  conic_memory_release(builder->context, old.slots);
  return CONIC_OK;
}

uint32_t conic_point_slots_join(conic_builder *builder, conic_point_slots *slots) {
  conic_splats *points = &builder->model->points;
  uint32_t *slot = find_slot(points, slots, points->count);
  if (!*slot)
    *slot = (uint32_t)++points->count;
  return *slot - 1;
}
