#include "accumulation/scattered.h"

#include <string.h>

#include "accumulation/accumulation_struct.h"
#include "core/base/message.h"
#include "core/base/threads.h"

static size_t sums_bytes(const conic_accumulation *sums) {
  return (size_t)sums->width * (size_t)sums->height * sums->n_channels * sizeof *sums->sums;
}

/* A part is the sums from its begin to before the next part's. */
static size_t part_begin(const conic_accumulation *sums, int i, int n) {
  uint64_t n_sums = sums_bytes(sums) / sizeof *sums->sums;
  return (size_t)(n_sums / (uint64_t)n * (uint64_t)i + n_sums % (uint64_t)n * (uint64_t)i / (uint64_t)n);
}

const void *conic_accumulation_part(const conic_accumulation *sums, int i, int n, size_t *n_bytes) {
  size_t begin = part_begin(sums, i, n);
  *n_bytes = (part_begin(sums, i + 1, n) - begin) * sizeof *sums->sums;
  return sums->sums + begin;
}

static conic_status check_part_length(const conic_accumulation *sums, int i, int n, size_t n_bytes) {
  size_t n_wanted;
  conic_accumulation_part(sums, i, n, &n_wanted);
  return n_bytes == n_wanted
             ? CONIC_OK
             : conic_fail(sums->context, CONIC_ERROR_ARGUMENT, "accumulation: the sums are not of the same picture");
}

enum { RUN = 1 << 14 };

typedef struct part_joining {
  conic_exact_sum *sums;
  const conic_exact_sum *others;
  size_t n;
} part_joining;

static void join_run(void *data, size_t i_run) {
  const part_joining *work = data;
  size_t begin = i_run * RUN, end = work->n - begin < RUN ? work->n : begin + RUN;
  for (size_t i = begin; i < end; i++)
    conic_exact_merge(&work->sums[i], work->others[i]);
}

conic_status conic_accumulation_join_part(conic_accumulation *sums, int i, int n, const void *bytes, size_t n_bytes) {
  part_joining work = {sums->sums + part_begin(sums, i, n), bytes, n_bytes / sizeof *sums->sums};
  conic_status status = check_part_length(sums, i, n, n_bytes);
  if (status == CONIC_OK)
    conic_parallel_for(sums->context, (work.n + RUN - 1) / RUN, join_run, &work);
  return status;
}

conic_scattered conic_accumulation_scattered(const conic_accumulation *sums) {
  return (conic_scattered){sums->n_samples, sums->n_half, sums->key};
}

conic_status conic_accumulation_take_part(conic_accumulation *sums, int i, int n, const conic_scattered *other,
                                          const void *bytes, size_t n_bytes) {
  conic_status status = check_part_length(sums, i, n, n_bytes);
  if (status == CONIC_OK && sums->key && other->key && sums->key != other->key)
    status = conic_fail(sums->context, CONIC_ERROR_ARGUMENT, "accumulation: the sums are not of the same picture");
  if (status != CONIC_OK)
    return status;
  memcpy(sums->sums + part_begin(sums, i, n), bytes, n_bytes);
  sums->n_samples += other->n_samples;
  sums->n_half += other->n_half;
  sums->key = sums->key ? sums->key : other->key;
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
