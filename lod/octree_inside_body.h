/* Which leaves cannot widen what a node reaches, in lanes of doubles: FIND_INSIDE is the function's name. */
#include <math.h>
#include <string.h>

#include "lod/octree_kernels.h"
#include "raster/lanes.h"

#if defined(__AVX2__)
enum { WIDE = 4 };
#else
enum { WIDE = 2 };
#endif

typedef double wide __attribute__((vector_size(8 * WIDE)));
typedef int64_t wide_mask __attribute__((vector_size(8 * WIDE)));
typedef float narrow __attribute__((vector_size(4 * WIDE)));

CONIC_INLINE unsigned wide_bits(wide_mask mask) {
#if defined(__AVX2__)
  return (unsigned)_mm256_movemask_pd((__m256d)mask);
#elif defined(__SSE2__)
  return (unsigned)_mm_movemask_pd((__m128d)mask);
#else
  return (unsigned)((mask[0] & 1) | (mask[1] & 2));
#endif
}

CONIC_INLINE wide load_wide(const float *from) {
  narrow value;
  memcpy(&value, from, sizeof value);
  return __builtin_convertvector(value, wide);
}

CONIC_INLINE wide dot_wide(const wide a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Whether (a + b)² ≤ (1 + 1/8) a² + (1 + 8) b² is no more than c². */
CONIC_INLINE wide_mask is_within(wide a2, wide b2, double c) {
  return a2 * 1.125 + b2 * 9.0 <= (wide){0} + c * c;
}

CONIC_INLINE wide_mask find_wide(const conic_splats *leaves, size_t first, double cutoff, const conic_node_frame *frame,
                                 const conic_leaf_reach *reach) {
  const double across = 1.0 / frame->ratio, cutoff2 = cutoff * cutoff;
  wide p[3], u[3], v[3];
  for (int axis = 0; axis < 3; axis++) {
    p[axis] = load_wide(leaves->position[axis] + first) - frame->position[axis];
    u[axis] = load_wide(leaves->tangent_u[axis] + first);
    v[axis] = load_wide(leaves->tangent_v[axis] + first);
  }
  wide x = dot_wide(p, frame->u), y = dot_wide(p, frame->v) * across, z = dot_wide(p, frame->n);
  wide ux = dot_wide(u, frame->u), uy = dot_wide(u, frame->v) * across, uz = dot_wide(u, frame->n);
  wide vx = dot_wide(v, frame->u), vy = dot_wide(v, frame->v) * across, vz = dot_wide(v, frame->n);
  wide uu = u[0] * u[0] + u[1] * u[1] + u[2] * u[2], vv = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
  const wide normal[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
  wide along = dot_wide(normal, frame->n);
  wide square = normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2];
  return is_within(x * x + y * y, cutoff2 * (ux * ux + uy * uy + vx * vx + vy * vy), reach->reach) &
         is_within(p[0] * p[0] + p[1] * p[1] + p[2] * p[2], cutoff2 * (uu + vv), reach->radius) &
         is_within(z * z, cutoff2 * (uz * uz + vz * vz), reach->height) & (along > 0.0) &
         (along * along > square * (reach->cosine * fabs(reach->cosine)));
}

unsigned FIND_INSIDE(const conic_splats *leaves, size_t first, double cutoff, const conic_node_frame *frame,
                     const conic_leaf_reach *reach) {
  unsigned bits = 0;
  for (unsigned part = 0; part < CONIC_INSIDE_BATCH; part += WIDE)
    bits |= wide_bits(find_wide(leaves, first + part, cutoff, frame, reach)) << part;
  return bits;
}
