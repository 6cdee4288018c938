/* A stable random choice of splats. */
#include "core/base/memory.h"
#include "core/base/random.h"
#include "core/splats/columns.h"

/* A bijection: no two indices have the same rank under one seed. */
static uint64_t rank_of(uint64_t seed, uint64_t index) {
  return conic_random_mix(seed * 0xD1342543DE82EF95u + (index + 1) * 0x9E3779B97F4A7C15u);
}

/* The rank that exactly `count` of the n are below (Hoare's FIND); the ranks are random, so any pivot is. */
static uint64_t select_rank(uint64_t *ranks, size_t n, size_t count) {
  ptrdiff_t begin = 0, last = (ptrdiff_t)n - 1, wanted = (ptrdiff_t)count;
  while (begin < last) {
    uint64_t pivot = ranks[begin + (last - begin) / 2];
    ptrdiff_t low = begin, high = last;
    while (low <= high) {
      while (ranks[low] < pivot)
        low++;
      while (pivot < ranks[high])
        high--;
      if (low <= high) {
        uint64_t swap = ranks[low];
        ranks[low++] = ranks[high];
        ranks[high--] = swap;
      }
    }
    if (high < wanted)
      begin = low;
    if (wanted < low)
      last = high;
  }
  return ranks[count];
}

static void keep_points(float *values, size_t n, uint64_t seed, uint64_t below) {
  size_t n_kept = 0;
  for (size_t i = 0; values && i < n; i++)
    if (rank_of(seed, i) < below)
      values[n_kept++] = values[i];
}

/* The kept splats' clip lines, under their new numbers. */
static void keep_clips(conic_splats *splats, uint64_t seed, uint64_t below) {
  size_t n_kept = 0, number = 0, next = 0;
  for (size_t i = 0; i < splats->n_clips; i++) {
    conic_clip clip = splats->clips[i];
    for (; next < clip.splat; next++)
      number += rank_of(seed, next) < below;
    if (rank_of(seed, clip.splat) >= below)
      continue;
    clip.splat = (uint32_t)number;
    splats->clips[n_kept++] = clip;
  }
  splats->n_clips = n_kept;
}

conic_status conic_splats_thin(conic_context *context, conic_splats *splats, size_t count, uint64_t seed) {
  conic_column columns[CONIC_SPLATS_COLUMNS];
  conic_status status = conic_splats_check_own(context, "thin", splats);
  if (status != CONIC_OK)
    return status;
  size_t n = splats->count;
  if (count >= n)
    return CONIC_OK;
  uint64_t *ranks = conic_memory_allocate(context, n, sizeof *ranks);
  if (!ranks)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < n; i++)
    ranks[i] = rank_of(seed, i);
  uint64_t below = select_rank(ranks, n, count);
  conic_memory_release(context, ranks);
  conic_splats_list_columns(splats, columns);
  for (int i = 0; i < CONIC_SPLATS_COLUMNS; i++)
    keep_points(*columns[i].floats, n, seed, below);
  keep_clips(splats, seed, below);
  splats->count = count;
  return CONIC_OK;
}
