#include "gaussians/draw/gaussian_rules.h"

#include "core/base/base.h"

conic_gaussian_rules conic_gaussian_rules_of(const conic_profile_row *row) {
  return (conic_gaussian_rules){.shape = row->shape,
                                .alpha_most = (float)row->alpha_most,
                                .alpha_least = (float)row->alpha_least,
                                .stop = (float)row->stop,
                                .greatest_half_q = (float)row->greatest_half_q,
                                .disc_near = (float)row->disc_near,
                                .fall_end = (float)row->fall_end,
                                .fall_factor = (float)(1.0 / (1.0 - row->fall_end)),
                                .is_beyond_stop = row->is_beyond_stop,
                                .has_late_median = row->has_late_median};
}

CONIC_DEFINE_OPTIONS(conic_gaussian_options, .profile = CONIC_PROFILE_EXACT)
