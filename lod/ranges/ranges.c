#include "lod/ranges/ranges.h"

#include "core/files/guard.h"
#include "lod/ranges/ranges_backend.h"

void conic_ranges_options_init(conic_ranges_options *options) {
  memset(options, 0, sizeof *options);
  options->connect_seconds = 10.0;
  options->stall_seconds = 15.0;
  options->n_retries = 4;
  options->pause_seconds = 0.2;
  options->n_connections = 4;
  options->most_whole_bytes = (uint64_t)512 << 20;
  options->until_s = HUGE_VAL;
}

int conic_ranges_is_url(const char *name) {
  return strncmp(name, "http://", 7) == 0 || strncmp(name, "https://", 8) == 0;
}

conic_status conic_ranges_open(conic_context *context, const char *name, const conic_ranges_options *options,
                               conic_ranges **ranges) {
  *ranges = NULL;
  if (conic_ranges_is_url(name)) {
    conic_status status = conic_ranges_open_url(context, name, options, ranges);
    if (status == CONIC_OK && (status = conic_guard_note_url(context, name, (*ranges)->size)) != CONIC_OK)
      conic_ranges_close(*ranges);
    return status;
  }
  return conic_ranges_open_file(context, name, ranges);
}

static void halt_ranges(conic_ranges *ranges) {
  if (ranges->is_going_on)
    ranges->backend->halt(ranges);
  ranges->is_going_on = 0;
}

void conic_ranges_go_on(conic_ranges *ranges) {
  halt_ranges(ranges);
  if (ranges->n_pending > 0 && ranges->backend->go_on)
    ranges->is_going_on = ranges->backend->go_on(ranges);
}

void conic_ranges_close(conic_ranges *ranges) {
  if (!ranges)
    return;
  halt_ranges(ranges);
  conic_range_queue_release(ranges->context, &ranges->queue);
  ranges->backend->close(ranges);
}

uint64_t conic_ranges_size(const conic_ranges *ranges) {
  return ranges->size;
}

uint64_t conic_ranges_received(const conic_ranges *ranges) {
  return ranges->n_received;
}

int conic_ranges_holds(const conic_ranges *ranges, const conic_range *range) {
  return range->n_bytes > 0 &&
         (range->file[0] || (range->offset <= ranges->size && range->n_bytes <= ranges->size - range->offset));
}

conic_status conic_ranges_request(conic_ranges *ranges, const conic_range *range) {
  halt_ranges(ranges);
  if (!conic_ranges_holds(ranges, range))
    return conic_fail(ranges->context, CONIC_ERROR_ARGUMENT, "a range of %zu bytes at byte %llu is not in the file",
                      range->n_bytes, (unsigned long long)range->offset);
  conic_queued_range item = {.range = *range};
  conic_status status = conic_range_queue_push(ranges->context, &ranges->queue, &item);
  ranges->n_pending += status == CONIC_OK;
  return status;
}

int conic_ranges_next(conic_ranges *ranges, double wait_seconds, conic_range_answer *answer) {
  halt_ranges(ranges);
  memset(answer, 0, sizeof *answer);
  if (ranges->n_pending == 0 || !ranges->backend->next(ranges, wait_seconds, answer))
    return 0;
  ranges->n_pending--;
  return 1;
}

void conic_ranges_release(conic_ranges *ranges, conic_range_answer *answer) {
  halt_ranges(ranges);
  ranges->backend->release(ranges, answer);
  memset(answer, 0, sizeof *answer);
}

void conic_ranges_cancel(conic_ranges *ranges) {
  halt_ranges(ranges);
  ranges->queue.n = 0;
  ranges->n_pending = 0;
  if (ranges->backend->cancel)
    ranges->backend->cancel(ranges);
}

size_t conic_ranges_pending(const conic_ranges *ranges) {
  return ranges->n_pending;
}

static conic_status wait_for_answer(conic_ranges *ranges, const char *name, double until_s,
                                    conic_range_answer *answer) {
  while (!conic_ranges_next(ranges, 0.1, answer)) {
    if (ranges->n_pending == 0)
      return CONIC_ERROR_MEMORY;
    conic_status status = conic_progress(ranges->context, "fetch", 0.0);
    if (status == CONIC_OK && conic_seconds_now() > until_s)
      status = conic_fail(ranges->context, CONIC_ERROR_IO, "%s: not even the index came in time", name);
    if (status != CONIC_OK)
      return status;
  }
  return CONIC_OK;
}

conic_status conic_ranges_read(conic_ranges *ranges, const char *name, const conic_range *range, double until_s,
                               unsigned char **bytes, size_t *n_bytes) {
  conic_range_answer answer;
  *bytes = NULL;
  *n_bytes = 0;
  conic_status status = conic_ranges_request(ranges, range);
  if (status == CONIC_OK)
    status = wait_for_answer(ranges, name, until_s, &answer);
  if (status != CONIC_OK) {
    conic_ranges_cancel(ranges);
    return status;
  }
  if (answer.status != CONIC_OK)
    return conic_fail(ranges->context, answer.status, "%s: cannot read%s%s: %s (at byte %llu)", name,
                      range->file[0] ? " " : "", range->file, answer.reason, (unsigned long long)range->offset);
  *bytes = conic_memory_copy(ranges->context, answer.bytes, answer.n_bytes);
  *n_bytes = answer.n_bytes;
  conic_ranges_release(ranges, &answer);
  return *bytes ? CONIC_OK : CONIC_ERROR_MEMORY;
}

conic_status conic_ranges_name_beside(conic_context *context, const char *name, const char *file, char **beside) {
  size_t is_url = (size_t)conic_ranges_is_url(name), path = is_url ? strcspn(name, "?#") : strlen(name), stem = path;
  const char *query = is_url && name[path] == '?' ? name + path : "";
  while (stem > 0 && name[stem - 1] != '/')
    stem--;
  size_t n_file = strlen(file), n_query = strcspn(query, "#");
  *beside = conic_memory_allocate(context, stem + n_file + n_query + 1, 1);
  if (!*beside)
    return CONIC_ERROR_MEMORY;
  memcpy(*beside, name, stem);
  memcpy(*beside + stem, file, n_file);
  memcpy(*beside + stem + n_file, query, n_query);
  (*beside)[stem + n_file + n_query] = '\0';
  return CONIC_OK;
}
