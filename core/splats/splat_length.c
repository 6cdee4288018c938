#include "core/base/base.h"
#include "core/base/rank.h"
#include "core/splats/columns.h"
#include "core/splats/shares.h"

enum { CHUNK = 65536 };

/* The longer axis as the bits of a float, which order like the lengths themselves; 0 for a splat that is not usable. */
static uint32_t length_bits(const conic_splats *splats, size_t i) {
  float uu = 0.0f, vv = 0.0f, sum = 0.0f;
  for (int axis = 0; axis < 3; axis++) {
    float u = splats->tangent_u[axis][i], v = splats->tangent_v[axis][i];
    uu += u * u;
    vv += v * v;
    sum += splats->position[axis][i] * 0.0f;
  }
  if (!(sum == 0.0f) || !(uu > 0.0f) || !(vv > 0.0f))
    return 0;
  float length = sqrtf(uu > vv ? uu : vv);
  if (!(length * 0.0f == 0.0f))
    return 0;
  return conic_bits_of_float(length);
}

typedef struct length_list {
  const conic_splats *splats;
  uint32_t *bits;
} length_list;

static void length_chunk(void *data, size_t i_chunk) {
  const length_list *list = data;
  size_t begin = i_chunk * CHUNK, end = begin + CHUNK < list->splats->count ? begin + CHUNK : list->splats->count;
  for (size_t i = begin; i < end; i++)
    list->bits[i] = length_bits(list->splats, i);
}

/* conic_bits_of_rank over all processes' bits: byte by byte, from how often each value of a byte occurs. */
static uint32_t bits_of_rank_among_shares(const conic_splats_shares *shares, const uint32_t *bits, size_t n,
                                          uint64_t rank) {
  uint64_t counts[256], found = 0;
  for (int shift = 24; shift >= 0; shift -= 8) {
    size_t byte = 0;
    memset(counts, 0, sizeof counts);
    for (size_t i = 0; i < n; i++)
      counts[bits[i] >> shift & 255] += (uint64_t)bits[i] >> (shift + 8) == found;
    conic_shares_take_sums(shares, counts, 256);
    while (rank >= counts[byte])
      rank -= counts[byte++];
    found = found << 8 | byte;
  }
  return (uint32_t)found;
}

/* The median of the usable lengths. */
static conic_status find_length(conic_context *context, const conic_splats_shares *shares, const conic_splats *splats,
                                double *length) {
  size_t n = splats->count;
  uint64_t counts[2] = {n, 0}; /* of all, and of the unusable */
  length_list list = {splats, conic_memory_allocate(context, n, sizeof *list.bits)};
  conic_status status = conic_team_agree(shares->team, list.bits ? CONIC_OK : CONIC_ERROR_MEMORY);
  if (status == CONIC_OK) {
    conic_parallel_for(context, (n + CHUNK - 1) / CHUNK, length_chunk, &list);
    for (size_t i = 0; i < n; i++)
      counts[1] += list.bits[i] == 0;
    conic_shares_take_sums(shares, counts, 2);
  }
  if (status == CONIC_OK && counts[0] > counts[1]) { /* those stand first */
    uint64_t rank = counts[1] + (counts[0] - counts[1] - 1) / 2;
    *length = (double)conic_float_of_bits(shares->team ? bits_of_rank_among_shares(shares, list.bits, n, rank)
                                                       : conic_bits_of_rank(list.bits, n, (size_t)rank));
  }
  conic_memory_release(context, list.bits);
  return status;
}

conic_status conic_shares_length(conic_context *context, const conic_splats_shares *shares, const conic_splats *splats,
                                 double *length) {
  *length = 0.0;
  return find_length(context, shares, splats, length);
}

conic_status conic_splats_length(conic_context *context, const conic_splats *splats, double *length) {
  static const conic_splats_shares alone = {.team = NULL};
  conic_splats close;
  float *block;
  *length = 0.0;
  conic_status status = conic_splats_enter(context, "length", splats, &close, &block);
  if (status == CONIC_OK && !close.tangent_u[0])
    status = conic_fail(context, CONIC_ERROR_ARGUMENT, "the splats have no tangent axes");
  if (status == CONIC_OK)
    status = find_length(context, &alone, &close, length);
  conic_memory_release(context, block);
  return status;
}
