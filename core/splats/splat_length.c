#include "core/base/base.h"
#include "core/splats/columns.h"
#include "core/splats/shares.h"

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

/* Digits are found from the highest down; at each, only lengths that share the higher digits count. */
enum { DIGIT_BITS = 11, N_DIGITS = 1 << DIGIT_BITS, MOST_CHUNKS = 64 };

typedef struct length_list {
  const conic_splats *splats;
  uint32_t *bits;
  size_t n_a_chunk, n_chunks;
  uint32_t (*counts)[N_DIGITS]; /* of each chunk: how often each digit occurs */
  uint32_t found;               /* the digits above, */
  int above, shift;             /* which end at this bit, and where the present one begins */
} length_list;

static size_t end_of_chunk(const length_list *list, size_t i_chunk) {
  size_t end = (i_chunk + 1) * list->n_a_chunk;
  return end < list->splats->count ? end : list->splats->count;
}

/* Also counts those of length 0. */
static void length_chunk(void *data, size_t i_chunk) {
  const length_list *list = data;
  uint32_t n_zero = 0;
  for (size_t i = i_chunk * list->n_a_chunk, end = end_of_chunk(list, i_chunk); i < end; i++) {
    list->bits[i] = length_bits(list->splats, i);
    n_zero += list->bits[i] == 0;
  }
  list->counts[i_chunk][0] = n_zero;
}

static void count_chunk(void *data, size_t i_chunk) {
  const length_list *list = data;
  uint32_t *counts = list->counts[i_chunk];
  const uint32_t *bits = list->bits, found = list->found, mask = (UINT32_C(1) << (list->above - list->shift)) - 1;
  const int above = list->above, shift = list->shift;
  memset(counts, 0, sizeof list->counts[i_chunk]);
  for (size_t i = i_chunk * list->n_a_chunk, end = end_of_chunk(list, i_chunk); i < end; i++)
    if ((uint64_t)bits[i] >> above == found)
      counts[bits[i] >> shift & mask]++;
}

/* How often each value of a digit occurs among all processes' lengths. */
static void count_digits(conic_context *context, const conic_splats_shares *shares, length_list *list,
                         uint64_t counts[N_DIGITS]) {
  conic_parallel_for(context, list->n_chunks, count_chunk, list);
  for (size_t digit = 0; digit < N_DIGITS; digit++) {
    counts[digit] = 0;
    for (size_t i = 0; i < list->n_chunks; i++)
      counts[digit] += list->counts[i][digit];
  }
  conic_shares_take_sums(shares, counts, N_DIGITS);
}

/* The median of the usable lengths, of which there is one. */
static double median_length(conic_context *context, const conic_splats_shares *shares, length_list *list,
                            uint64_t rank) {
  uint64_t counts[N_DIGITS];
  list->found = 0;
  for (list->above = 32; list->above > 0; list->above = list->shift) {
    uint32_t digit = 0;
    list->shift = list->above > DIGIT_BITS ? list->above - DIGIT_BITS : 0;
    count_digits(context, shares, list, counts);
    while (rank >= counts[digit])
      rank -= counts[digit++];
    list->found = list->found << (list->above - list->shift) | digit;
  }
  return (double)conic_float_of_bits(list->found);
}

/* Of the usable splats, whose bits stand behind the zeros of the others. */
static conic_status find_length(conic_context *context, const conic_splats_shares *shares, const conic_splats *splats,
                                double *length) {
  size_t n = splats->count;
  uint64_t counts[2] = {n, 0}; /* of all, and of the unusable */
  length_list list = {.splats = splats, .n_a_chunk = n / MOST_CHUNKS + 1};
  list.n_chunks = (n + list.n_a_chunk - 1) / list.n_a_chunk;
  conic_status status =
      conic_memory_allocate_these(context, CONIC_ROOM(list.bits, n), CONIC_ROOM(list.counts, list.n_chunks));
  status = conic_team_agree(shares->team, status);
  if (status == CONIC_OK) {
    conic_parallel_for(context, list.n_chunks, length_chunk, &list);
    for (size_t i = 0; i < list.n_chunks; i++)
      counts[1] += list.counts[i][0];
    conic_shares_take_sums(shares, counts, 2);
  }
  if (status == CONIC_OK && counts[0] > counts[1])
    *length = median_length(context, shares, &list, counts[1] + (counts[0] - counts[1] - 1) / 2);
  conic_memory_release_these(context, list.bits, list.counts);
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
