#include <math.h>
#include <string.h>

#include "conic/splats.h"
#include "core/base/memory.h"
#include "core/base/message.h"
#include "core/base/real.h"
#include "core/splats/columns.h"

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

/* The bucket that holds the element of that rank; *rank becomes its rank within the bucket. */
static uint32_t find_bucket(const size_t *histogram, size_t *rank) {
  uint32_t bucket = 0;
  while (*rank >= histogram[bucket])
    *rank -= histogram[bucket++];
  return bucket;
}

static conic_status find_length(conic_context *context, const conic_splats *splats, double *length) {
  enum { N_BUCKETS = 65536 };
  size_t *histogram = conic_memory_allocate_zeroed(context, N_BUCKETS, sizeof *histogram);
  if (!histogram)
    return CONIC_ERROR_MEMORY;
  /* The upper half of the bits first, then the lower half of those in the median's bucket. */
  size_t n_usable = 0;
  for (size_t i = 0; i < splats->count; i++) {
    uint32_t bits = length_bits(splats, i);
    if (bits) {
      histogram[bits >> 16]++;
      n_usable++;
    }
  }
  if (n_usable) {
    size_t rank = (n_usable - 1) / 2;
    uint32_t upper = find_bucket(histogram, &rank);
    memset(histogram, 0, N_BUCKETS * sizeof *histogram);
    for (size_t i = 0; i < splats->count; i++) {
      uint32_t bits = length_bits(splats, i);
      if (bits && bits >> 16 == upper)
        histogram[bits & 0xffff]++;
    }
    uint32_t bits = upper << 16 | find_bucket(histogram, &rank);
    float median = conic_float_of_bits(bits);
    *length = (double)median;
  }
  conic_memory_release(context, histogram);
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
