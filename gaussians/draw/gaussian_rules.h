/* What pixels need of a profile (core/splats/gaussian_profile.h), in floats, as devices have it, too. */
#pragma once

#include "core/splats/gaussian_profile.h"
#ifdef CONIC_ON_DEVICE
#include "conic/image.h"
#endif

typedef struct conic_gaussian_rules {
  conic_gaussian_shape shape;
  float alpha_most, alpha_least, stop, greatest_half_q, disc_near;
  float fall_end, fall_factor; /* where the falloff falls to zero: what is taken off it, and the factor then; or 0 */
  int is_beyond_stop, has_late_median;
} conic_gaussian_rules;

#ifndef CONIC_ON_DEVICE
conic_gaussian_rules conic_gaussian_rules_of(const conic_profile_row *row);
#endif
