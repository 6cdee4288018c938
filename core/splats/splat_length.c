#include <math.h>

#include "conic/splats.h"
#include "core/base/memory.h"
#include "core/base/message.h"
#include "core/base/rank.h"
#include "core/base/real.h"
#include "core/base/threads.h"
#include "core/splats/columns.h"

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

static void length_chunk(void *data, size_t i_chunk, int i_thread) {
  const length_list *list = data;
  size_t begin = i_chunk * CHUNK, end = begin + CHUNK < list->splats->count ? begin + CHUNK : list->splats->count;
  (void)i_thread;
  for (size_t i = begin; i < end; i++)
    list->bits[i] = length_bits(list->splats, i);
}

/* The median of those that are usable. */
static conic_status find_length(conic_context *context, const conic_splats *splats, double *length) {
  size_t n = splats->count, n_unusable = 0;
  length_list list = {splats, conic_memory_allocate(context, n, sizeof *list.bits)};
  if (!list.bits)
    return CONIC_ERROR_MEMORY;
  conic_parallel_for(context, (n + CHUNK - 1) / CHUNK, length_chunk, &list);
  for (size_t i = 0; i < n; i++)
    n_unusable += list.bits[i] == 0;
  if (n > n_unusable) /* those stand first */
    *length = (double)conic_float_of_bits(conic_bits_of_rank(list.bits, n, n_unusable + (n - n_unusable - 1) / 2));
  conic_memory_release(context, list.bits);
  return CONIC_OK;
}

conic_status conic_splats_length(conic_context *context, const conic_splats *splats, double *length) {
  conic_splats close;
  float *block;
  *length = 0.0;
  conic_status status = conic_splats_enter(context, "length", splats, &close, &block);
  if (status == CONIC_OK && !close.tangent_u[0])
    status = conic_fail(context, CONIC_ERROR_ARGUMENT, "the splats have no tangent axes");
  if (status == CONIC_OK)
    status = find_length(context, &close, length);
  conic_memory_release(context, block);
  return status;
}
