/* core/splats/profile.h lane by lane, with the same operations in the same order. C and OpenCL C share this text. */
#pragma once

#include "core/lanes/lanes_table.h"
#include "core/splats/profile.h"

/* One splat's part of the table, the same for all its pixels: its coefficients where it is smooth, … */
typedef struct smooth_part {
  float coefficients[CONIC_PROFILE_SMOOTH_TERMS];
  float n_xx, n_xy, n_yy;
} smooth_part;

/* … and otherwise its numbers by the radius. */
typedef struct profile_slice {
  conic_aim aim;
  smooth_part smooth;
  lanes_table terms[CONIC_PROFILE_TERMS];
} profile_slice;

CONIC_INLINE lanes mix_lanes(lanes a, lanes b, float part) {
  return a + part * (b - a);
}

/* conic_profile_coefficient of all terms. */
CONIC_INLINE void cut_smooth(const conic_profile *profile, int first_level, int second_level, float first_part,
                             float second_part, smooth_part *to) {
  enum { ROW = CONIC_PROFILE_SMOOTH_LEVELS * CONIC_PROFILE_SMOOTH_TERMS };
  CONIC_FAR const float *low =
      profile->table + CONIC_PROFILE_STEEP + first_level * ROW + second_level * CONIC_PROFILE_SMOOTH_TERMS;
  CONIC_FAR const float *high = low + ROW;
  for (int i = 0; i < CONIC_PROFILE_SMOOTH_TERMS; i += CONIC_LANES) {
    lanes a = mix_lanes(lanes_load(low + i), lanes_load(low + CONIC_PROFILE_SMOOTH_TERMS + i), second_part);
    lanes b = mix_lanes(lanes_load(high + i), lanes_load(high + CONIC_PROFILE_SMOOTH_TERMS + i), second_part);
    lanes_store(to->coefficients + i, mix_lanes(a, b, first_part));
  }
}

/* conic_profile_entry of the whole slice. */
CONIC_INLINE void cut_slice(const conic_profile *profile, profile_slice *slice) {
  const conic_aim *aim = &slice->aim;
  if (aim->is_smooth) {
    slice->smooth.n_xx = aim->n_xx;
    slice->smooth.n_xy = aim->n_xy;
    slice->smooth.n_yy = aim->n_yy;
    cut_smooth(profile, aim->level[0], aim->level[1], aim->part[0], aim->part[1], &slice->smooth);
    return;
  }
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

/* conic_profile_smooth_at */
CONIC_INLINE lanes smooth_lanes(const smooth_part *s, lanes q, lanes x, lanes y) {
  const float *c = s->coefficients;
  lanes across = lanes_min((s->n_xx * x + s->n_xy * y) * x + s->n_yy * (y * y), q);
  lanes q2 = q * q, first = (c[0] + c[1] * q) + q2 * ((c[2] + c[3] * q) + q2 * ((c[4] + c[5] * q) + q2 * c[6]));
  lanes second = (c[7] + c[8] * q) + q2 * (c[9] + c[10] * q), third = (c[11] + c[12] * q) + q2 * c[13];
  return (first + across * second) + (across * across) * (third + across * (c[14] + c[15] * q));
}

/* conic_profile_at; lanes in which q is not below the support may hold anything. */
CONIC_INLINE lanes profile_lanes(const conic_profile *profile, const profile_slice *slice, lanes q, lanes x, lanes y) {
  const conic_aim *aim = &slice->aim;
  if (aim->is_smooth)
    return smooth_lanes(&slice->smooth, q, x, y);
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
