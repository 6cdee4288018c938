#include <math.h>

#include "core/base/base.h"
#include "core/base/vectors.h"
#include "core/lanes/lanes.h"
#include "core/splats/columns.h"
#include "core/splats/splats_gather.h"

/* Chunks of points that threads bound, of which no picture has more. */
enum { LEAST_IN_CHUNK = 65536, MOST_CHUNKS = 256 };

/* Bounds columns side by side, several points at a time, from the first on; returns where it ends. */
static size_t bound_columns(float *const position[3], size_t n, float low[3], float high[3], size_t *n_finite) {
  const lanes zero = lanes_of(0.0f);
  lanes lows[3], highs[3];
  size_t end = n - n % CONIC_LANES;
  for (int axis = 0; axis < 3; axis++) {
    lows[axis] = lanes_of(INFINITY);
    highs[axis] = lanes_of(-INFINITY);
  }
  for (size_t k = 0; k < end; k += CONIC_LANES) {
    lanes at[3], nothing = zero; /* not a number where a coordinate is not finite: it is neither below nor above */
    for (int axis = 0; axis < 3; axis++) {
      at[axis] = lanes_load(position[axis] + k);
      nothing = nothing + at[axis] * zero;
    }
    *n_finite += lanes_count(lanes_at_least(nothing, zero));
    for (int axis = 0; axis < 3; axis++) {
      lows[axis] = lanes_min(at[axis] + nothing, lows[axis]);
      highs[axis] = lanes_max(at[axis] + nothing, highs[axis]);
    }
  }
  for (int axis = 0; axis < 3; axis++)
    for (int lane = 0; lane < CONIC_LANES; lane++)
      CONIC_WIDEN(low[axis], high[axis], lows[axis][lane], highs[axis][lane]);
  return end;
}

size_t conic_points_bounds(float *const position[3], size_t stride, const double origin[3], const uint32_t *indices,
                           size_t n, double minimum[3], double maximum[3]) {
  float low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
  size_t n_finite = 0, first = 0;
  if (!indices && (!stride || stride == sizeof(float)))
    first = bound_columns(position, n, low, high, &n_finite);
  for (size_t k = first; k < n; k++) {
    float p[3];
    for (int axis = 0; axis < 3; axis++)
      p[axis] = conic_column_at(position[axis], stride, indices ? indices[k] : k);
    if (!(p[0] * 0.0f == 0.0f && p[1] * 0.0f == 0.0f && p[2] * 0.0f == 0.0f))
      continue;
    for (int axis = 0; axis < 3; axis++)
      CONIC_WIDEN(low[axis], high[axis], p[axis], p[axis]);
    n_finite++;
  }
  for (int axis = 0; axis < 3; axis++) {
    minimum[axis] = n_finite ? origin[axis] + (double)low[axis] : 0.0;
    maximum[axis] = n_finite ? origin[axis] + (double)high[axis] : 0.0;
  }
  return n_finite;
}

typedef struct bounds_of_chunk {
  double low[3], high[3];
  size_t n_finite;
} bounds_of_chunk;

typedef struct splat_bounds {
  const conic_splats *splats;
  size_t n_a_chunk;
  bounds_of_chunk chunks[MOST_CHUNKS];
} splat_bounds;

static void bound_chunk(void *data, size_t i_chunk) {
  splat_bounds *work = data;
  const conic_splats *splats = work->splats;
  bounds_of_chunk *chunk = &work->chunks[i_chunk];
  size_t begin = i_chunk * work->n_a_chunk, stride = splats->strides.position, left = splats->count - begin;
  float *position[3];
  for (int axis = 0; axis < 3; axis++)
    position[axis] = (float *)((char *)splats->position[axis] + begin * (stride ? stride : sizeof(float)));
  chunk->n_finite = conic_points_bounds(position, stride, splats->origin, NULL,
                                        left < work->n_a_chunk ? left : work->n_a_chunk, chunk->low, chunk->high);
}

size_t conic_splats_bounds_by(conic_context *context, const conic_splats *splats, double minimum[3],
                              double maximum[3]) {
  splat_bounds work = {.splats = splats, .n_a_chunk = LEAST_IN_CHUNK};
  size_t n = conic_splats_fault(splats) ? 0 : splats->count, n_finite = 0;
  if (!context || n <= LEAST_IN_CHUNK)
    return conic_points_bounds(splats->position, splats->strides.position, splats->origin, NULL, n, minimum, maximum);
  if ((n - 1) / MOST_CHUNKS >= LEAST_IN_CHUNK)
    work.n_a_chunk = (n - 1) / MOST_CHUNKS + 1;
  size_t n_chunks = (n - 1) / work.n_a_chunk + 1;
  conic_parallel_for(context, n_chunks, bound_chunk, &work);
  for (int axis = 0; axis < 3; axis++)
    minimum[axis] = maximum[axis] = 0.0;
  for (size_t i = 0; i < n_chunks; i++) {
    const bounds_of_chunk *chunk = &work.chunks[i];
    for (int axis = 0; axis < 3 && chunk->n_finite; axis++) {
      minimum[axis] = !n_finite || chunk->low[axis] < minimum[axis] ? chunk->low[axis] : minimum[axis];
      maximum[axis] = !n_finite || chunk->high[axis] > maximum[axis] ? chunk->high[axis] : maximum[axis];
    }
    n_finite += chunk->n_finite;
  }
  return n_finite;
}

size_t conic_splats_bounds(const conic_splats *splats, double minimum[3], double maximum[3]) {
  return conic_splats_bounds_by(NULL, splats, minimum, maximum);
}
