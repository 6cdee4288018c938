/* What the prefilter makes of a kernel that is no Gaussian, over what it makes of a Gaussian's peak: a table over the
 * filter's share in the variance along either axis, the direction and the radius (docs/reference/picture.md, Profile).
 * The same bits everywhere. OpenCL C reads this text, too. */
#pragma once

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "conic/context.h"
#include "core/splats/kernel.h"

/* Where the table is: OpenCL's programs have it behind the view. */
#ifndef CONIC_FAR
#define CONIC_FAR
#endif

/* Levels of the share t, s = (2ⁱ - 1)/131072 with t = 4s/(1 + 3s); for each two of them the coefficients of a
 * polynomial in the direction, each at so many radii. */
enum { CONIC_PROFILE_LEVELS = 18, CONIC_PROFILE_TERMS = 5, CONIC_PROFILE_RADII = 16 };
enum { CONIC_PROFILE_SLICE = CONIC_PROFILE_TERMS * CONIC_PROFILE_RADII };
enum { CONIC_PROFILE_STEEP = CONIC_PROFILE_LEVELS * CONIC_PROFILE_LEVELS * CONIC_PROFILE_SLICE };

/* Behind them, for what has a share of 1/16 or more along both axes and so is smooth: for each two shares i/16 a
 * polynomial in q and its part across, of 7, 4, 3 and 2 terms. */
enum { CONIC_PROFILE_SMOOTH_LEVELS = 16, CONIC_PROFILE_SMOOTH_TERMS = 16 };
enum {
  CONIC_PROFILE_FLOATS =
      CONIC_PROFILE_STEEP + CONIC_PROFILE_SMOOTH_LEVELS * CONIC_PROFILE_SMOOTH_LEVELS * CONIC_PROFILE_SMOOTH_TERMS
};

#define CONIC_PROFILE_PLACES 131072.0f
#define CONIC_PROFILE_ROUND 0x1p-12f     /* keeps roundings from choosing the direction of a nearly round splat */
#define CONIC_PROFILE_LAST 0x1.dffffep3f /* the last place between the radii */
#define CONIC_PROFILE_BEND 0.002f        /* added to the shares of a bent direction */

/* How a kernel's table is read, and the table; null for a kernel that has none. */
typedef struct conic_profile {
  float at_center, by_q; /* the square of the radius is at_center + by_q·q */
  float narrowing;       /* 1/μ - 1, where μ is the kernel's integral over 2π */
  int is_bent;           /* the direction is */
  CONIC_FAR const float *table;
} conic_profile;

/* Finds or makes the kernel's table, which lasts as long as the context. Not from inside a task. Errors: MEMORY. */
conic_status conic_profile_make(conic_context *context, const conic_kernel *kernel, conic_profile *profile);

/* The most that the kernel falls by over a part of its radius, over that part. */
double conic_profile_slope(const conic_kernel *kernel);

/* One splat's part in it. */
typedef struct conic_aim {
  int is_smooth;
  float n_xx, n_xy, n_yy; /* two quadratic forms, whose ratio is the direction: 0 along the splat's longer axis, … */
  float d_xx, d_xy, d_yy; /* … 1 across it; a smooth one has the first alone: q's part across */
  int level[2];
  float part[2]; /* of the way to the next level */
  float peak;    /* the table's values are over it; a smooth one has none */
} conic_aim;

/* The share of the prefilter as a level; what is no number counts as all. */
static inline void conic_profile_level(float share, int *level, float *part) {
  share = share < 1.0f ? share : 1.0f;
  share = share > 0.0f ? share : 0.0f;
  float place = share / (4.0f - 3.0f * share) * CONIC_PROFILE_PLACES + 1.0f;
  uint32_t bits;
  place = place < 0x1.fffffep16f ? place : 0x1.fffffep16f;
  memcpy(&bits, &place, sizeof bits);
  *level = (int)(bits >> 23) - 127;
  bits = (bits & 0x7fffffu) | 0x3f800000u;
  memcpy(part, &bits, sizeof bits);
  *part -= 1.0f;
}

/* A share of 1/16 or more; what is no number counts as all. */
static inline void conic_profile_smooth_level(float share, int *level, float *part) {
  float place = (share < 1.0f ? share : 1.0f) * (float)CONIC_PROFILE_SMOOTH_LEVELS - 1.0f;
  place = place < CONIC_PROFILE_LAST ? place : CONIC_PROFILE_LAST;
  *level = (int)place;
  *part = place - (float)*level;
}

/* Of the symmetric matrix of the shares, in coordinates in which q is x² + y²; or, with is_ray, of h·JJᵀ, in those of
 * the splat's plane. */
static inline conic_aim conic_aim_of(const conic_profile *profile, float xx, float xy, float yy, float determinant,
                                     int is_ray) {
  conic_aim aim;
  float difference = xx - yy, spread = sqrtf(difference * difference + 4.0f * (xy * xy));
  float high = 0.5f * ((xx + yy) + spread), low = high > 0.0f ? determinant / high : 0.0f;
  float by_low = is_ray ? 1.0f + low : 1.0f, by_high = is_ray ? 1.0f + high : 1.0f;
  float share[2] = {is_ray ? low / by_low : low, is_ray ? high / by_high : high};
  aim.is_smooth = !(share[0] < 1.0f / (float)CONIC_PROFILE_SMOOTH_LEVELS);
  if (aim.is_smooth) {
    float scale = 1.0f / ((spread + CONIC_PROFILE_ROUND * high) * by_high);
    aim.n_xx = scale * (xx - low);
    aim.n_xy = scale * (2.0f * xy);
    aim.n_yy = scale * (yy - low);
    for (int i = 0; i < 2; i++)
      conic_profile_smooth_level(share[i], &aim.level[i], &aim.part[i]);
    return aim;
  }
  float bend = profile->is_bent ? sqrtf((share[0] + CONIC_PROFILE_BEND) / (share[1] + CONIC_PROFILE_BEND)) : 1.0f;
  by_high *= bend;
  aim.n_xx = by_low * (xx - low);
  aim.n_xy = by_low * (2.0f * xy);
  aim.n_yy = by_low * (yy - low);
  aim.d_xx = aim.n_xx + by_high * (high - xx);
  aim.d_xy = aim.n_xy - by_high * (2.0f * xy);
  aim.d_yy = aim.n_yy + by_high * (high - yy);
  aim.d_xx += CONIC_PROFILE_ROUND * share[1];
  aim.d_yy += CONIC_PROFILE_ROUND * share[1];
  aim.peak = 1.0f / sqrtf((1.0f + profile->narrowing * share[0]) * (1.0f + profile->narrowing * share[1]));
  for (int i = 0; i < 2; i++)
    conic_profile_level(share[i], &aim.level[i], &aim.part[i]);
  return aim;
}

/* An entry between the levels. */
static inline float conic_profile_entry(const conic_profile *profile, const conic_aim *aim, int i) {
  CONIC_FAR const float *low =
      profile->table + (ptrdiff_t)((aim->level[0] * CONIC_PROFILE_LEVELS + aim->level[1]) * CONIC_PROFILE_SLICE) + i;
  CONIC_FAR const float *high = low + (ptrdiff_t)(CONIC_PROFILE_LEVELS * CONIC_PROFILE_SLICE);
  float a = low[0] + aim->part[1] * (low[CONIC_PROFILE_SLICE] - low[0]);
  float b = high[0] + aim->part[1] * (high[CONIC_PROFILE_SLICE] - high[0]);
  return a + aim->part[0] * (b - a);
}

/* Of what is smooth, a coefficient between the levels. */
static inline float conic_profile_coefficient(const conic_profile *profile, const conic_aim *aim, int i) {
  CONIC_FAR const float *low =
      profile->table + CONIC_PROFILE_STEEP +
      (ptrdiff_t)((aim->level[0] * CONIC_PROFILE_SMOOTH_LEVELS + aim->level[1]) * CONIC_PROFILE_SMOOTH_TERMS) + i;
  CONIC_FAR const float *high = low + (ptrdiff_t)(CONIC_PROFILE_SMOOTH_LEVELS * CONIC_PROFILE_SMOOTH_TERMS);
  float a = low[0] + aim->part[1] * (low[CONIC_PROFILE_SMOOTH_TERMS] - low[0]);
  float b = high[0] + aim->part[1] * (high[CONIC_PROFILE_SMOOTH_TERMS] - high[0]);
  return a + aim->part[0] * (b - a);
}

static inline float conic_profile_smooth_at(const conic_profile *profile, const conic_aim *aim, float q, float x,
                                            float y) {
  float c[CONIC_PROFILE_SMOOTH_TERMS], across = (aim->n_xx * x + aim->n_xy * y) * x + aim->n_yy * (y * y);
  across = across < q ? across : q;
  for (int i = 0; i < CONIC_PROFILE_SMOOTH_TERMS; i++)
    c[i] = conic_profile_coefficient(profile, aim, i);
  float q2 = q * q, first = (c[0] + c[1] * q) + q2 * ((c[2] + c[3] * q) + q2 * ((c[4] + c[5] * q) + q2 * c[6]));
  float second = (c[7] + c[8] * q) + q2 * (c[9] + c[10] * q), third = (c[11] + c[12] * q) + q2 * c[13];
  return (first + across * second) + (across * across) * (third + across * (c[14] + c[15] * q));
}

/* The profile at (x, y), where q is below the support. */
static inline float conic_profile_at(const conic_profile *profile, const conic_aim *aim, float q, float x, float y) {
  if (aim->is_smooth)
    return conic_profile_smooth_at(profile, aim, q, x, y);
  float n = (aim->n_xx * x + aim->n_xy * y) * x + aim->n_yy * (y * y);
  float d = (aim->d_xx * x + aim->d_xy * y) * x + aim->d_yy * (y * y);
  float w = n / (d > 0x1p-100f ? d : 0x1p-100f);
  w = w > 0.0f ? w : 0.0f;
  w = w < 1.0f ? w : 1.0f;
  float square = profile->at_center + profile->by_q * q;
  float radius = sqrtf(square > 0.0f ? square : 0.0f) * (float)(CONIC_PROFILE_RADII - 1);
  radius = radius < CONIC_PROFILE_LAST ? radius : CONIC_PROFILE_LAST;
  int i = (int)radius;
  float part = radius - (float)i, value = w;
  for (int term = CONIC_PROFILE_TERMS - 1; term >= 0; term--) {
    float a = conic_profile_entry(profile, aim, term * CONIC_PROFILE_RADII + i);
    float b = conic_profile_entry(profile, aim, term * CONIC_PROFILE_RADII + i + 1);
    float here = a + part * (b - a);
    value = term == CONIC_PROFILE_TERMS - 1 ? here : value * w + here;
  }
  return aim->peak * value;
}
