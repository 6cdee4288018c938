/* Sorting by digits, the value of a rank, and the queue of slots: by key, and what is equal in an order of its own. */
#include "core/base/heap.h"
#include "core/base/radix.h"
#include "core/base/rank.h"
#include "tests/support/check.h"
#include "tests/support/random_numbers.h"

/* Of few items and of many, keys of any number of bits: an even or an odd number of digits. */
static void test_radix(conic_context *context, size_t n, int n_bits) {
  uint64_t state = 5;
  conic_radix_item *items = malloc(n * sizeof *items);
  if (!items)
    exit(1);
  for (size_t i = 0; i < n; i++) { /* many keys twice */
    items[i].key = (uint64_t)(random_unit(&state) * 0.5 * (double)n) * UINT64_C(0x9e3779b97f4a7c15) >> (64 - n_bits);
    items[i].value = (uint32_t)i;
    if (n_bits % 2 == 0)
      items[i].key &= ~(UINT64_C(0x7ff) << 11); /* a digit that all share */
  }
  CHECK_OK(conic_radix_sort(context, items, n, n_bits));
  for (size_t i = 1; i < n; i++)
    CHECK(items[i - 1].key < items[i].key || (items[i - 1].key == items[i].key && items[i - 1].value < items[i].value));
  free(items);
}

/* At its rank there are no more smaller values than that, and no more greater ones than are left. */
static void test_rank(size_t n) {
  enum { MOST = 500 };
  uint64_t state = 7;
  float values[MOST];
  for (size_t i = 0; i < n; i++)
    values[i] = (float)(floor(40.0 * random_unit(&state)) - 20.0) * 1.25e-7f;
  for (size_t rank = 0; rank < n; rank++) {
    float value = conic_float_of_rank(values, n, rank);
    size_t n_below = 0, n_above = 0;
    for (size_t i = 0; i < n; i++) {
      n_below += values[i] < value;
      n_above += values[i] > value;
    }
    CHECK(n_below <= rank && n_above < n - rank && n_below + n_above < n);
  }
}

static void test_heap(void) {
  enum { N = 500 };
  uint64_t state = 6;
  uint32_t slots[N];
  double keys[N];
  conic_heap heap = {.slots = slots, .keys = keys};
  for (uint32_t round = 0; round < 3; round++) {
    for (uint32_t i = 0; i < N; i++) {
      keys[(i * 37) % N] = floor(50.0 * random_unit(&state));
      conic_heap_push(&heap, (i * 37) % N);
    }
    uint32_t before = conic_heap_pop(&heap);
    while (heap.n > 0) {
      uint32_t slot = conic_heap_pop(&heap);
      CHECK(keys[before] < keys[slot] || (keys[before] == keys[slot] && before < slot));
      before = slot;
    }
  }
}

int main(void) {
  conic_context *context = check_context(1);
  for (int n_bits = 8; n_bits <= 64; n_bits += 7)
    for (size_t n = 1; n < 10000; n *= 9)
      test_radix(context, n, n_bits);
  for (size_t n = 1; n <= 500; n = 3 * n + 1)
    test_rank(n);
  test_heap();
  conic_context_destroy(context);
  return check_result();
}
