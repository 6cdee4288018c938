/* Memory that is kept from use to use and only ever grows. */
#pragma once

#include "core/base/memory.h"

typedef struct conic_kept_memory {
  void *pointer;
  size_t bytes;
} conic_kept_memory;

/* Room for count × size bytes; null where there is no memory. If it grows, its contents are lost. The caller releases
 * the pointer in the end. */
static inline void *conic_keep_room(conic_context *context, conic_kept_memory *memory, size_t count, size_t size) {
  if (memory->pointer && count <= memory->bytes / size)
    return memory->pointer;
  conic_memory_release(context, memory->pointer);
  memory->pointer = conic_memory_allocate(context, count, size);
  memory->bytes = memory->pointer ? count * size : 0;
  return memory->pointer;
}
