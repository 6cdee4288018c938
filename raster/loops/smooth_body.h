/* The parts of smooth splats in the profile's table, several at a time: beside what one of them has in scalar code,
 * that is a tenth of the work, and what is stored is in the cache when pixels read it number by number. Included by
 * pass_body.h. */
#pragma once

#include "raster/loops/coverage_lanes.h"

typedef struct smooth_group {
  unsigned is_smooth; /* by bits */
  smooth_part parts[CONIC_LANES];
} smooth_group;

/* What of the group is found in lanes. */
typedef struct smooth_aims {
  float s1[CONIC_LANES], s2[CONIC_LANES], s3[CONIC_LANES];
  float n_xx[CONIC_LANES], n_xy[CONIC_LANES], n_yy[CONIC_LANES];
  uint32_t level[2][CONIC_LANES];
  float part[2][CONIC_LANES];
} smooth_aims;

/* conic_profile_smooth_level, lane by lane. */
CONIC_INLINE void put_smooth_level(lanes share, uint32_t *level, float *part) {
  lanes place = lanes_min(share, lanes_of(1.0f)) * (float)CONIC_PROFILE_SMOOTH_LEVELS - 1.0f;
  place = lanes_min(place, lanes_of(CONIC_PROFILE_LAST));
  int_lanes whole = lanes_to_ints(lanes_max(place, lanes_of(0.0f)));
  lanes_store_indices(level, indices_of_ints(whole));
  lanes_store(part, place - lanes_of_ints(whole));
}

/* conic_variance_aim, lane by lane; returns which are smooth. */
CONIC_INLINE unsigned find_smooth_aims(float h, smooth_aims *aims) {
  lanes s1 = lanes_load(aims->s1), s2 = lanes_load(aims->s2), s3 = lanes_load(aims->s3), area = h * (s1 * s3);
  lanes xx = h * (s1 * s1 + s2 * s2), xy = h * (s2 * s3), yy = h * (s3 * s3), determinant = area * area;
  lanes difference = xx - yy, spread = lanes_sqrt(difference * difference + 4.0f * (xy * xy));
  lanes high = 0.5f * ((xx + yy) + spread), low = determinant / high;
  lanes scale = 1.0f / (spread + CONIC_PROFILE_ROUND * high);
  lanes_store(aims->n_xx, scale * (xx - low));
  lanes_store(aims->n_xy, scale * (2.0f * xy));
  lanes_store(aims->n_yy, scale * (yy - low));
  put_smooth_level(low, aims->level[0], aims->part[0]);
  put_smooth_level(high, aims->level[1], aims->part[1]);
  return lanes_bits(lanes_at_least(low, lanes_of(1.0f / (float)CONIC_PROFILE_SMOOTH_LEVELS)));
}

/* So many ellipses of a block, in the order of their places. */
CONIC_INLINE void find_smooth(const sources *from, const conic_kept *kept, const uint32_t *places, size_t n,
                              smooth_group *group) {
  smooth_aims aims;
  for (size_t i = 0; i < CONIC_LANES; i++) {
    const conic_footprint *footprint = &from->footprints[kept->footprint[places[i < n ? i : n - 1]]];
    aims.s1[i] = footprint->s1;
    aims.s2[i] = footprint->s2;
    aims.s3[i] = footprint->s3;
  }
  group->is_smooth = find_smooth_aims(from->view->prefilter, &aims);
  for (size_t i = 0; i < n; i++) {
    smooth_part *part = &group->parts[i];
    if (!(group->is_smooth >> i & 1))
      continue;
    part->n_xx = aims.n_xx[i];
    part->n_xy = aims.n_xy[i];
    part->n_yy = aims.n_yy[i];
    cut_smooth(&from->view->profile, (int)aims.level[0][i], (int)aims.level[1][i], aims.part[0][i], aims.part[1][i],
               part);
  }
}

/* The places of the ellipses that a block shows; returns how many there are. */
CONIC_INLINE size_t find_seen(const sources *from, const conic_kept *kept, size_t n_kept, uint32_t *places) {
  size_t n = 0;
  for (size_t i = 0; i < n_kept; i++) {
    unsigned seen = 0;
    for (size_t at = 0; at < CONIC_BLOCK_PIXELS; at += CONIC_LANES)
      seen |= lanes_bits(lanes_at_least(lanes_load(kept->fragments[i].seen_iz + at), lanes_load(kept->threshold + at)));
    places[n] = (uint32_t)i;
    n +=
        (size_t)(seen != 0) & (size_t)(from->footprints[kept->footprint[i]].s3 > 0.0f); /* no branch could foresee it */
  }
  return n;
}

/* Puts an ellipse's profile in the place of its q. */
CONIC_INLINE void weigh_ellipse(const sources *from, const sites *s, size_t block, const conic_footprint *footprint,
                                const smooth_part *smooth, float *q) {
  const splat_kind kind = smooth ? SPLAT_SMOOTH : SPLAT_PROFILED;
  splat_rows rows = begin_rows(footprint, s->y);
  fragments f;
  rows.smooth = smooth;
  if (!smooth)
    begin_profile(from->view, footprint, from->rays, 0, &rows);
  for (size_t part = 0; part < CONIC_PARTS; part++) {
    ellipse_fragments(from->view, &rows, from->support, kind, (s->x[block * CONIC_PARTS + part] - rows.x) + rows.dx0,
                      &f);
    lanes_store(q + part * CONIC_LANES, f.scale);
  }
}

/* Of all ellipses that the band keeps and shows: what is hidden needs none. */
static __attribute__((noinline)) void weigh_ellipses(conic_band *band, const sources *from, const sites *s) {
  uint32_t places[CONIC_KEPT_SPLATS];
  smooth_group group;
  for (int block = 0; block < band->n_blocks; block++) {
    conic_kept *kept = &band->kept[block];
    const size_t n = find_seen(from, kept, band->n_kept[block], places);
    for (size_t i = 0; i < n; i++) {
      const size_t lane = i % CONIC_LANES;
      if (lane == 0)
        find_smooth(from, kept, places + i, n - i < CONIC_LANES ? n - i : CONIC_LANES, &group);
      const conic_footprint *footprint = &from->footprints[kept->footprint[places[i]]];
      float *q = kept->fragments[places[i]].q;
      if (__builtin_expect(group.is_smooth >> lane & 1, 1))
        weigh_ellipse(from, s, (size_t)block, footprint, &group.parts[lane], q);
      else
        weigh_ellipse(from, s, (size_t)block, footprint, NULL, q);
    }
  }
}
