/* core/splats/profile.h lane by lane, with the same operations in the same order. C and OpenCL C share this text. */
#ifndef CONIC_PROFILE_LANES_H
#define CONIC_PROFILE_LANES_H

#include "core/lanes/lanes_table.h"
#include "core/splats/profile.h"

/* One splat's part of the table, the same for all its pixels. */
typedef struct profile_slice {
  conic_aim aim;
  lanes_table terms[CONIC_PROFILE_TERMS];
} profile_slice;

CONIC_INLINE lanes mix_lanes(lanes a, lanes b, float part) {
  return a + part * (b - a);
}

/* conic_profile_entry of the whole slice. */
CONIC_INLINE void cut_slice(const conic_profile *profile, profile_slice *slice) {
  CONIC_FAR const float *low =
      profile->table + (slice->aim.level[0] * CONIC_PROFILE_LEVELS + slice->aim.level[1]) * CONIC_PROFILE_SLICE;
  CONIC_FAR const float *high = low + CONIC_PROFILE_LEVELS * CONIC_PROFILE_SLICE;
  float part = slice->aim.part[1];
  for (int term = 0; term < CONIC_PROFILE_TERMS; term++)
    for (int i = 0; i < CONIC_TABLE_PARTS; i++) {
      int at = term * CONIC_PROFILE_RADII + i * CONIC_LANES;
      lanes a = mix_lanes(lanes_load(low + at), lanes_load(low + CONIC_PROFILE_SLICE + at), part);
      lanes b = mix_lanes(lanes_load(high + at), lanes_load(high + CONIC_PROFILE_SLICE + at), part);
      slice->terms[term].part[i] = mix_lanes(a, b, slice->aim.part[0]);
    }
}

/* conic_profile_at; lanes in which q is not below the support may hold anything. */
CONIC_INLINE lanes profile_lanes(const conic_profile *profile, const profile_slice *slice, lanes q, lanes x, lanes y) {
  const conic_aim *aim = &slice->aim;
  lanes n = (aim->n_xx * x + aim->n_xy * y) * x + aim->n_yy * (y * y);
  lanes d = (aim->d_xx * x + aim->d_xy * y) * x + aim->d_yy * (y * y);
  lanes w = n / lanes_max(d, lanes_of(0x1p-100f)), value = w;
  w = lanes_min(lanes_max(w, lanes_of(0.0f)), lanes_of(1.0f));
  lanes square = lanes_max(profile->at_center + profile->by_q * q, lanes_of(0.0f));
  lanes radius = lanes_min(lanes_sqrt(square) * (float)(CONIC_PROFILE_RADII - 1), lanes_of(CONIC_PROFILE_LAST));
  int_lanes i = lanes_to_ints(radius), next = i + 1;
  lanes part = radius - lanes_of_ints(i);
  for (int term = CONIC_PROFILE_TERMS - 1; term >= 0; term--) {
    lanes a = lanes_look_up(&slice->terms[term], i), b = lanes_look_up(&slice->terms[term], next);
    lanes here = a + part * (b - a);
    value = term == CONIC_PROFILE_TERMS - 1 ? here : value * w + here;
  }
  return aim->peak * value;
}

#endif
