#include <stdint.h>
#include <sys/mman.h>

#include "core/base/context_struct.h"
#include "core/base/memory.h"

void conic_memory_advise_large_pages(void *pointer, size_t bytes) {
#if defined(MADV_HUGEPAGE)
  const uintptr_t page = (uintptr_t)2 << 20, begin = (uintptr_t)pointer;
  uintptr_t first = (begin + (page - 1)) / page * page, last = (begin + bytes) / page * page;
  if (pointer && first < last)
    (void)madvise((char *)pointer + (first - begin), last - first, MADV_HUGEPAGE);
#else
  (void)pointer;
  (void)bytes;
#endif
}

void conic_memory_prefer_large_pages(const conic_context *context, void *pointer, size_t bytes) {
  if (context->options.large_pages)
    conic_memory_advise_large_pages(pointer, bytes);
}
