#include "core/splats/gaussian_profile.h"

#include "core/base/base.h"

#define LEAST_ALPHA (1.0 / 255.0)
#define LIKE_INRIA                                                                                                     \
  .coverage = CONIC_COVERAGE_TILES, .near_z = 0.2, .is_beyond_near = 1, .alpha_most = 0.99,                            \
  .alpha_least = LEAST_ALPHA, .stop = 1e-4, .compensation_least = -1.0, .takes_rotation_as_is = 1, .takes_middle = 1,  \
  .has_float_eye = 1
#define LIKE_GSPLAT                                                                                                    \
  .near_z = 0.01, .alpha_least = LEAST_ALPHA, .stop = 1e-4, .is_beyond_stop = 1, .dilation = 0.3, .slope_margin = 0.3, \
  .has_float_eye = 1

static const conic_profile_row rows[CONIC_N_GAUSSIAN_PROFILES] = {
    [CONIC_PROFILE_EXACT] = {"exact", .shape = CONIC_SHAPE_RAY, .alpha_most = 0.99, .alpha_least = LEAST_ALPHA,
                             .stop = 1e-4},
    [CONIC_PROFILE_INRIA_2023] = {"inria-2023", LIKE_INRIA, .dilation = 0.3, .slope_margin = 0.3},
    [CONIC_PROFILE_GSPLAT_1_5] = {"gsplat-1.5", LIKE_GSPLAT, .alpha_most = 0.999, .compensation_least = -1.0},
    [CONIC_PROFILE_GSPLAT_1_5_AA] = {"gsplat-1.5-aa", LIKE_GSPLAT, .alpha_most = 0.999, .compensation_least = 0.0},
    [CONIC_PROFILE_GSPLAT_1_6] = {"gsplat-1.6", LIKE_GSPLAT, .alpha_most = 0.99, .compensation_least = -1.0},
    [CONIC_PROFILE_GSPLAT_1_6_AA] = {"gsplat-1.6-aa", LIKE_GSPLAT, .alpha_most = 0.99, .compensation_least = 2.5e-5},
    [CONIC_PROFILE_2DGS_2024] = {"2dgs-2024", LIKE_INRIA, .shape = CONIC_SHAPE_DISC, .has_late_median = 1,
                                 .disc_cutoff = 3.0, .disc_near = 0.2},
    [CONIC_PROFILE_2DGS_GSPLAT] = {"2dgs-gsplat", LIKE_GSPLAT, .shape = CONIC_SHAPE_DISC,
                                   .coverage = CONIC_COVERAGE_BOX, .is_beyond_near = 1, .alpha_most = 0.99,
                                   .disc_cutoff = 1.0, .disc_extent = 3.33},
    [CONIC_PROFILE_KHR_2026] = {"khr-2026", .alpha_most = 1.0, .compensation_least = -1.0, .slope_margin = -1.0,
                                .greatest_half_q = 4.5, .orders_by_distance = 1, .has_float_eye = 1},
};

const conic_profile_row *conic_profile_row_of(conic_gaussian_profile profile) {
  return (unsigned)profile < CONIC_N_GAUSSIAN_PROFILES ? &rows[profile] : NULL;
}

const char *conic_gaussian_profile_name(conic_gaussian_profile profile) {
  return (unsigned)profile < CONIC_N_GAUSSIAN_PROFILES ? rows[profile].name : NULL;
}
