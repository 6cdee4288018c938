/* The pool: every item once, no thread twice at a time, all done at the end; and who watches a plan for more threads.
 */
#include <stdatomic.h>
#include <stdint.h>
#include <time.h>

#include "core/base/threads.h"
#include "tests/support/check.h"

enum { MOST_ITEMS = 1000, MOST_THREADS = 33 };

typedef struct pool_ledger {
  unsigned char n_done[MOST_ITEMS]; /* by whoever has the item: not atomic */
  atomic_int is_working[MOST_THREADS], n_wrong;
  int n_threads;
  long rest_ns; /* of every seventh item */
} pool_ledger;

static void keep_ledger(void *data, size_t i_item, int i_thread) {
  pool_ledger *ledger = data;
  if (i_thread < 0 || i_thread >= ledger->n_threads || atomic_exchange(&ledger->is_working[i_thread], 1))
    atomic_fetch_add(&ledger->n_wrong, 1);
  ledger->n_done[i_item]++;
  if (ledger->rest_ns && i_item % 7 == 0)
    nanosleep(&(struct timespec){.tv_nsec = ledger->rest_ns}, NULL);
  atomic_store(&ledger->is_working[i_thread], 0);
}

static conic_context *context_of(int threads) {
  conic_context_options options;
  conic_context *context;
  conic_context_options_init(&options);
  options.threads = threads;
  CHECK_OK(conic_context_create(&options, &context));
  return context;
}

/* Regions one after the other without a pause, so that late workers of one meet the next. */
static void test_regions(int threads, long rest_ns, int n_rounds) {
  static pool_ledger ledger;
  const size_t sizes[] = {0, 1, 2, 3, 32, 33, 34, MOST_ITEMS};
  conic_context *context = context_of(threads);
  int n_missed = 0;
  for (int round = 0; round < n_rounds; round++)
    for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++) {
      memset(&ledger, 0, sizeof ledger);
      ledger.n_threads = threads;
      ledger.rest_ns = rest_ns;
      conic_parallel_for(context, sizes[s], keep_ledger, &ledger);
      for (size_t i = 0; i < MOST_ITEMS; i++)
        n_missed += ledger.n_done[i] != (i < sizes[s]);
      n_missed += atomic_load(&ledger.n_wrong);
    }
  CHECK(n_missed == 0);
  conic_context_destroy(context);
}

typedef struct meeting {
  atomic_int n_here, n_alone; /* who waited for ten seconds in vain */
  int n_threads;
} meeting;

static void await_all(void *data, size_t i_item) {
  (void)i_item;
  meeting *all = data;
  atomic_fetch_add(&all->n_here, 1);
  for (int i = 0; atomic_load(&all->n_here) < all->n_threads && i < 10000; i++)
    nanosleep(&(struct timespec){.tv_nsec = 1000000}, NULL);
  if (atomic_load(&all->n_here) < all->n_threads)
    atomic_fetch_add(&all->n_alone, 1);
}

/* Every thread is woken: none of the items is done before all have begun. */
static void test_all_come(int threads) {
  conic_context *context = context_of(threads);
  for (int round = 0; round < 20; round++) {
    meeting all = {.n_threads = threads};
    conic_parallel_for(context, (size_t)threads, await_all, &all);
    CHECK(atomic_load(&all.n_here) == threads && atomic_load(&all.n_alone) == 0);
  }
  conic_context_destroy(context);
}

typedef struct watched {
  size_t n_calls;
  int is_wrong;
} watched;

static void watch_region(void *cookie, const char *name, size_t n_items, size_t n_done) {
  watched *seen = cookie;
  seen->is_wrong |= strcmp(name, "keep_ledger") != 0 || n_items != 5 || n_done != seen->n_calls;
  seen->n_calls++;
}

static void test_plan(void) {
  static pool_ledger ledger = {.n_threads = 1};
  conic_context *context = context_of(1);
  watched seen = {0, 0};
  conic_parallel_plan(context, 20, watch_region, &seen);
  CHECK(conic_context_threads(context) == 20);
  conic_parallel_for(context, 0, keep_ledger, &ledger);
  CHECK(seen.n_calls == 0);
  conic_parallel_for(context, 5, keep_ledger, &ledger);
  CHECK(seen.n_calls == 6 && !seen.is_wrong && atomic_load(&ledger.n_wrong) == 0);
  conic_parallel_plan(context, 1, NULL, NULL);
  conic_parallel_for(context, 5, keep_ledger, &ledger);
  CHECK(seen.n_calls == 6 && conic_context_threads(context) == 1);
  conic_context_destroy(context);
}

int main(void) {
  test_regions(1, 0, 20);
  test_regions(2, 0, 500);
  test_regions(5, 0, 200);
  test_regions(MOST_THREADS, 0, 100);
  test_regions(3, 20000, 5);
  test_all_come(2);
  test_all_come(MOST_THREADS);
  test_plan();
  return check_result();
}
