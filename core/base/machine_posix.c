#include <limits.h>
#include <sys/mman.h>
#include <unistd.h>

#include "core/base/base.h"
#include "core/base/machine.h"

int conic_machine_threads(void) {
  long n = sysconf(_SC_NPROCESSORS_ONLN);
  return n < 1 ? 1 : n > INT_MAX ? INT_MAX : (int)n;
}

uint64_t conic_machine_memory(void) {
#if defined(_SC_PHYS_PAGES)
  long pages = sysconf(_SC_PHYS_PAGES), page_bytes = sysconf(_SC_PAGESIZE);
  return pages > 0 && page_bytes > 0 ? (uint64_t)pages * (uint64_t)page_bytes : 0;
#else
  return 0;
#endif
}

void conic_memory_advise_large_pages(void *pointer, size_t bytes) {
#if defined(MADV_HUGEPAGE)
  const uintptr_t page = (uintptr_t)2 << 20, begin = (uintptr_t)pointer;
  uintptr_t first = (begin + (page - 1)) / page * page, last = (begin + bytes) / page * page;
  if (pointer && first < last)
    (void)madvise((char *)pointer + (first - begin), last - first, MADV_HUGEPAGE);
#else
  (void)pointer, (void)bytes;
#endif
}
