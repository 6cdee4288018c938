#include "lod/radix.h"

#include <string.h>

#include "core/memory.h"

enum { DIGIT_BITS = 11, N_DIGITS = 1 << DIGIT_BITS };

static void sort_by_digit(const conic_radix_item *from, conic_radix_item *to, size_t n, int shift) {
  size_t starts[N_DIGITS + 1] = {0};
  for (size_t i = 0; i < n; i++)
    starts[(from[i].key >> shift & (N_DIGITS - 1)) + 1]++;
  for (int digit = 0; digit < N_DIGITS; digit++)
    starts[digit + 1] += starts[digit];
  for (size_t i = 0; i < n; i++)
    to[starts[from[i].key >> shift & (N_DIGITS - 1)]++] = from[i];
}

conic_status conic_radix_sort(conic_context *context, conic_radix_item *items, size_t n, int n_bits) {
  conic_radix_item *from = items, *to = conic_memory_allocate(context, n, sizeof *to), *scratch = to;
  if (!to)
    return CONIC_ERROR_MEMORY;
  for (int shift = 0; shift < n_bits; shift += DIGIT_BITS) {
    sort_by_digit(from, to, n, shift);
    conic_radix_item *sorted = to;
    to = from;
    from = sorted;
  }
  if (from != items)
    memcpy(items, from, n * sizeof *items);
  conic_memory_release(context, scratch);
  return CONIC_OK;
}
