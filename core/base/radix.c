#include "core/base/radix.h"

#include "core/base/base.h"

/* For few items, going through all possible digits would take longer than going through the items. */
enum { DIGIT_BITS = 11, DIGIT_BITS_OF_FEW = 8, FEW = 2048 };

/* Returns 0, and moves nothing, where all have the same digit. */
static int sort_by_digit(const conic_radix_item *from, conic_radix_item *to, size_t n, int shift, int n_bits) {
  size_t starts[(1 << DIGIT_BITS) + 1], n_digits = (size_t)1 << n_bits;
  memset(starts, 0, (n_digits + 1) * sizeof *starts);
  for (size_t i = 0; i < n; i++)
    starts[(from[i].key >> shift & (n_digits - 1)) + 1]++;
  if (n > 0 && starts[(from[0].key >> shift & (n_digits - 1)) + 1] == n)
    return 0;
  for (size_t digit = 0; digit < n_digits; digit++)
    starts[digit + 1] += starts[digit];
  for (size_t i = 0; i < n; i++)
    to[starts[from[i].key >> shift & (n_digits - 1)]++] = from[i];
  return 1;
}

const conic_radix_item *conic_radix_sort_in(conic_radix_item *items, conic_radix_item *room, size_t n, int n_bits) {
  conic_radix_item *from = items, *to = room;
  int digit_bits = n < FEW ? DIGIT_BITS_OF_FEW : DIGIT_BITS;
  for (int shift = 0; shift < n_bits; shift += digit_bits)
    if (sort_by_digit(from, to, n, shift, digit_bits)) {
      conic_radix_item *sorted = to;
      to = from;
      from = sorted;
    }
  return from;
}

conic_status conic_radix_sort(conic_context *context, conic_radix_item *items, size_t n, int n_bits) {
  conic_radix_item *room = conic_memory_allocate(context, n, sizeof *room);
  if (!room)
    return CONIC_ERROR_MEMORY;
  const conic_radix_item *sorted = conic_radix_sort_in(items, room, n, n_bits);
  if (sorted != items)
    memcpy(items, sorted, n * sizeof *items);
  conic_memory_release(context, room);
  return CONIC_OK;
}
