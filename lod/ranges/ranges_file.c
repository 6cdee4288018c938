/* Ranges of a file in this machine: a memory map, whose pages are given back as they were read. */

#include "core/files/disk.h"
#include "core/files/mapping.h"
#include "lod/ranges/ranges_backend.h"

/* Pages that were read count as this process's memory until they are given back; the system keeps them all the same,
 * while it has room. */
enum { RETURN_BYTES = 1 << 20 };

typedef struct file_ranges {
  conic_ranges base;
  char *path;
  conic_mapping mapping;
  size_t n_read; /* since pages were given back */
} file_ranges;

/* Maps a file beside the one that was opened; an answer holds it. Says what is wrong, or null. */
static const char *map_beside(file_ranges *file, const conic_range *range, conic_range_answer *answer) {
  conic_context *context = file->base.context;
  const char *wrong = NULL;
  conic_disk_entry found;
  char *path;
  if (conic_ranges_name_beside(context, file->path, range->file, &path) != CONIC_OK)
    return "out of memory";
  conic_mapping *held = conic_memory_allocate_zeroed(context, 1, sizeof *held);
  if (!held)
    wrong = "out of memory";
  else if (!conic_disk_look(path, &found))
    wrong = "it is not there";
  else if (!found.is_file)
    wrong = "it is no file";
  else if (found.n_bytes > range->n_bytes)
    wrong = "it is larger than what it is to hold can be";
  else if (conic_mapping_open(context, path, held) != CONIC_OK)
    wrong = "it cannot be read";
  conic_memory_release(context, path);
  if (wrong) {
    conic_memory_release(context, held);
    return wrong;
  }
  answer->held = held;
  answer->bytes = held->bytes;
  answer->n_bytes = held->n_bytes;
  return NULL;
}

static int next(conic_ranges *ranges, double wait_seconds, conic_range_answer *answer) {
  file_ranges *file = (file_ranges *)ranges;
  conic_queued_range item;
  (void)wait_seconds;
  if (!conic_range_queue_pop(&ranges->queue, 0.0, &item))
    return 0;
  answer->id = item.range.id;
  if (item.range.file[0]) {
    answer->reason = map_beside(file, &item.range, answer);
    answer->status = answer->reason ? CONIC_ERROR_INPUT : CONIC_OK;
    return 1;
  }
  answer->bytes = file->mapping.bytes + item.range.offset;
  answer->n_bytes = item.range.n_bytes;
  return 1;
}

static void release_file(conic_ranges *ranges, conic_range_answer *answer) {
  file_ranges *file = (file_ranges *)ranges;
  if (answer->held) {
    conic_mapping_close(ranges->context, answer->held);
    conic_memory_release(ranges->context, answer->held);
    return;
  }
  file->n_read += answer->n_bytes;
  if (!file->mapping.is_mapped || file->n_read < RETURN_BYTES)
    return;
  conic_disk_give_back(file->mapping.bytes, file->mapping.n_bytes);
  file->n_read = 0;
}

static void close_file(conic_ranges *ranges) {
  file_ranges *file = (file_ranges *)ranges;
  conic_mapping_close(ranges->context, &file->mapping);
  conic_memory_release_these(ranges->context, file->path, file);
}

static const conic_ranges_backend backend = {next, release_file, NULL, NULL, NULL, close_file};

conic_status conic_ranges_open_file(conic_context *context, const char *path, conic_ranges **ranges) {
  file_ranges *file = conic_memory_allocate_zeroed(context, 1, sizeof *file);
  if (!file)
    return CONIC_ERROR_MEMORY;
  file->base.context = context;
  file->base.backend = &backend;
  file->path = conic_memory_copy_text(context, path);
  conic_status status = file->path ? conic_mapping_open(context, path, &file->mapping) : CONIC_ERROR_MEMORY;
  if (status != CONIC_OK) {
    close_file(&file->base);
    return status;
  }
  file->base.size = file->mapping.n_bytes;
  *ranges = &file->base;
  return CONIC_OK;
}
