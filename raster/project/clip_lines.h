/* Clip lines on the screen: half-planes at whose borders a splat ends (docs/reference/picture.md, Clip lines).
 *
 * A footprint that has some is marked by the sign of s3, which q does not see: s3 > 0 is an ellipse without lines,
 * s3 < 0 one with lines, +0 a ray without and -0 a ray with them. Its lines are clips[its index]. */
#pragma once

#include <math.h>

#include "raster/project/projected.h"

/* Two lines, dx and dy counted as for the footprint: line i keeps where (d0 + dy·by_y) + dx·by_x ≥ 0, with d0 the
 * distance of the reference in pixels and 1/256 px more, so that mates overlap. A line that is none keeps everything.
 * And only within a box. */
typedef struct conic_clip_record {
  float d0[2], by_x[2], by_y[2];
  uint32_t is_or;
  uint32_t reserved;
  float dx_low, dx_high, dy_low, dy_high; /* what is left of the disc, widened by the prefilter: low ≤ dx ≤ high */
} conic_clip_record;

static inline int conic_is_clipped(const conic_footprint *footprint) {
  return signbit(footprint->s3) != 0;
}

static inline int conic_clip_keeps(const conic_clip_record *clip, float dx, float dy) {
  int first = (clip->d0[0] + clip->by_y[0] * dy) + clip->by_x[0] * dx >= 0.0f;
  int second = (clip->d0[1] + clip->by_y[1] * dy) + clip->by_x[1] * dx >= 0.0f;
  int within = dx >= clip->dx_low && dx <= clip->dx_high && dy >= clip->dy_low && dy <= clip->dy_high;
  return (clip->is_or ? first | second : first & second) & within;
}

/* Marks the chunk's footprints whose splats have clip lines, and fills in their records. The splats are from `begin`
 * on. */
void conic_clip_chunk(const conic_view *view, const conic_splats *splats, size_t begin, conic_projected *projected,
                      const conic_chunk *chunk);
