#include "accumulation/scattered.h"

#include <string.h>

#include "accumulation/accumulation_struct.h"
#include "core/base/message.h"
#include "core/base/threads.h"

static size_t sums_bytes(const conic_accumulation *sums) {
  return (size_t)sums->width * (size_t)sums->height * sums->n_channels * sizeof *sums->sums;
}

const void *conic_accumulation_bytes(const conic_accumulation *sums, uint64_t header[CONIC_SCATTERED_HEADER],
                                     size_t *n_bytes) {
  header[0] = sums->n_samples;
  header[1] = sums->n_half;
  header[2] = sums->key;
  header[3] = sums->n_channels;
  *n_bytes = sums_bytes(sums);
  return sums->sums;
}

typedef struct sums_joining {
  conic_accumulation *sums;
  const conic_exact_sum *others;
} sums_joining;

static void join_row(void *data, size_t y, int i_thread) {
  const sums_joining *work = data;
  size_t n = (size_t)work->sums->width * work->sums->n_channels;
  (void)i_thread;
  for (size_t i = y * n; i < (y + 1) * n; i++)
    conic_exact_merge(&work->sums->sums[i], work->others[i]);
}

conic_status conic_accumulation_join(conic_accumulation *sums, const uint64_t header[CONIC_SCATTERED_HEADER],
                                     const void *bytes, size_t n_bytes) {
  sums_joining work = {sums, bytes};
  if (n_bytes != sums_bytes(sums) || header[3] != sums->n_channels ||
      (sums->key && header[2] && sums->key != header[2]))
    return conic_fail(sums->context, CONIC_ERROR_ARGUMENT, "accumulation: the sums are not of the same picture");
  conic_parallel_for(sums->context, (size_t)sums->height, join_row, &work);
  sums->n_samples += header[0];
  sums->n_half += header[1];
  sums->key = sums->key ? sums->key : header[2];
  return CONIC_OK;
}

void conic_accumulation_joined(conic_accumulation *sums, uint64_t first_sample) {
  sums->first_sample = first_sample;
}

void conic_accumulation_clear(conic_accumulation *sums) {
  memset(sums->sums, 0, sums_bytes(sums));
  sums->n_samples = 0;
  sums->n_half = 0;
  sums->key = 0;
}
