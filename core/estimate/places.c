#include "core/estimate/places.h"

#include "core/base/random.h"

/* Equal positions have equal hashes: adding zero turns -0 into 0. */
static size_t hash_position(const float *const position[3], size_t i) {
  uint64_t bits[3];
  for (int axis = 0; axis < 3; axis++)
    bits[axis] = conic_bits_of_float(position[axis][i] + 0.0f);
  return (size_t)conic_random_mix(conic_random_mix(bits[0] << 32 | bits[1]) + bits[2]);
}

static int is_same_position(const float *const position[3], size_t a, size_t b) {
  return position[0][a] == position[0][b] && position[1][a] == position[1][b] && position[2][a] == position[2][b];
}

conic_status conic_places_find(conic_context *context, const float *const position[3], size_t n, uint32_t *place) {
  const uint32_t none = UINT32_MAX;
  size_t n_slots = 16;
  while (n_slots < n + n / 2)
    n_slots *= 2;
  uint32_t *slots = conic_memory_allocate(context, n_slots, sizeof *slots);
  if (!slots)
    return CONIC_ERROR_MEMORY;
  memset(slots, 0xff, n_slots * sizeof *slots);
  for (size_t i = 0; i < n; i++) {
    place[i] = (uint32_t)i;
    if (!is_same_position(position, i, i))
      continue;
    size_t slot = hash_position(position, i) & (n_slots - 1);
    while (slots[slot] != none && !is_same_position(position, slots[slot], i))
      slot = (slot + 1) & (n_slots - 1);
    if (slots[slot] == none)
      slots[slot] = (uint32_t)i;
    place[i] = slots[slot];
  }
  conic_memory_release(context, slots);
  return CONIC_OK;
}
