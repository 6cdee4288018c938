#include "lod/ranges/ranges.h"

#include <math.h>
#include <string.h>

#include "core/base/message.h"
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
  if (conic_ranges_is_url(name))
    return conic_ranges_open_url(context, name, options, ranges);
  return conic_ranges_open_file(context, name, ranges);
}

void conic_ranges_close(conic_ranges *ranges) {
  if (!ranges)
    return;
  conic_range_queue_release(ranges->context, &ranges->queue);
  ranges->backend->close(ranges);
}

uint64_t conic_ranges_size(const conic_ranges *ranges) {
  return ranges->size;
}

uint64_t conic_ranges_received(const conic_ranges *ranges) {
  return ranges->n_received;
}

conic_status conic_ranges_request(conic_ranges *ranges, const conic_range *range) {
  if (range->n_bytes == 0 || range->offset > ranges->size || range->n_bytes > ranges->size - range->offset)
    return conic_fail(ranges->context, CONIC_ERROR_ARGUMENT, "a range of %zu bytes at byte %llu is not in the file",
                      range->n_bytes, (unsigned long long)range->offset);
  conic_queued_range item = {.range = *range};
  conic_status status = conic_range_queue_push(ranges->context, &ranges->queue, &item);
  ranges->n_pending += status == CONIC_OK;
  return status;
}

int conic_ranges_next(conic_ranges *ranges, double wait_seconds, conic_range_answer *answer) {
  memset(answer, 0, sizeof *answer);
  if (ranges->n_pending == 0 || !ranges->backend->next(ranges, wait_seconds, answer))
    return 0;
  ranges->n_pending--;
  return 1;
}

void conic_ranges_release(conic_ranges *ranges, conic_range_answer *answer) {
  ranges->backend->release(ranges, answer);
  memset(answer, 0, sizeof *answer);
}

void conic_ranges_cancel(conic_ranges *ranges) {
  ranges->queue.n = 0;
  ranges->n_pending = 0;
  ranges->backend->cancel(ranges);
}

size_t conic_ranges_pending(const conic_ranges *ranges) {
  return ranges->n_pending;
}
