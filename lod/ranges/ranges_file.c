/* Ranges of a file in this machine: a memory map, whose pages are given back as they were read. */
#include <string.h>
#include <sys/mman.h>

#include "core/base/memory.h"
#include "core/files/mapping.h"
#include "lod/ranges/ranges_backend.h"

/* Pages that were read count as this process's memory until they are given back; the system keeps them all the same,
 * while it has room. */
enum { RETURN_BYTES = 16 << 20 };

typedef struct file_ranges {
  conic_ranges base;
  conic_mapping mapping;
  size_t n_read; /* since pages were given back */
} file_ranges;

static int next(conic_ranges *ranges, double wait_seconds, conic_range_answer *answer) {
  file_ranges *file = (file_ranges *)ranges;
  conic_queued_range item;
  double wait_s;
  (void)wait_seconds;
  if (!conic_range_queue_pop(&ranges->queue, 0.0, &item, &wait_s))
    return 0;
  answer->id = item.range.id;
  answer->bytes = file->mapping.bytes + item.range.offset;
  answer->n_bytes = item.range.n_bytes;
  return 1;
}

static void release_file(conic_ranges *ranges, conic_range_answer *answer) {
  file_ranges *file = (file_ranges *)ranges;
  file->n_read += answer->n_bytes;
  if (!file->mapping.is_mapped || file->n_read < RETURN_BYTES)
    return;
  madvise(file->mapping.bytes, file->mapping.n_bytes, MADV_DONTNEED); /* read-only: they come back from the file */
  file->n_read = 0;
}

static void cancel(conic_ranges *ranges) {
  (void)ranges; /* nothing is ever under way */
}

static void close_file(conic_ranges *ranges) {
  file_ranges *file = (file_ranges *)ranges;
  conic_mapping_close(ranges->context, &file->mapping);
  conic_memory_release(ranges->context, file);
}

static const conic_ranges_backend backend = {next, release_file, cancel, close_file};

conic_status conic_ranges_open_file(conic_context *context, const char *path, conic_ranges **ranges) {
  file_ranges *file = conic_memory_allocate_zeroed(context, 1, sizeof *file);
  if (!file)
    return CONIC_ERROR_MEMORY;
  conic_status status = conic_mapping_open(context, path, &file->mapping);
  if (status != CONIC_OK) {
    conic_memory_release(context, file);
    return status;
  }
  file->base.context = context;
  file->base.backend = &backend;
  file->base.size = file->mapping.n_bytes;
  *ranges = &file->base;
  return CONIC_OK;
}
