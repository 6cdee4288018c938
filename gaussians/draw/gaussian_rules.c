#include "gaussians/draw/gaussian_rules.h"

#include "core/base/base.h"

#define LEAST_ALPHA (1.0f / 255.0f)
#define LIKE_INRIA                                                                                                     \
  .coverage = CONIC_COVERAGE_TILES, .near_z = 0.2, .is_beyond_near = 1, .alpha_most = 0.99f,                           \
  .alpha_least = LEAST_ALPHA, .stop = 1e-4f, .compensation_least = -1.0, .takes_rotation_as_is = 1, .takes_middle = 1, \
  .has_float_eye = 1
#define LIKE_GSPLAT                                                                                                    \
  .near_z = 0.01, .alpha_least = LEAST_ALPHA, .stop = 1e-4f, .is_beyond_stop = 1, .dilation = 0.3,                     \
  .slope_margin = 0.3, .has_float_eye = 1

static const conic_gaussian_rules all_rules[CONIC_N_GAUSSIAN_PROFILES] = {
    [CONIC_PROFILE_EXACT] = {.shape = CONIC_SHAPE_RAY, .alpha_most = 0.99f, .alpha_least = LEAST_ALPHA, .stop = 1e-4f},
    [CONIC_PROFILE_INRIA_2023] = {LIKE_INRIA, .dilation = 0.3, .slope_margin = 0.3},
    [CONIC_PROFILE_GSPLAT_1_5] = {LIKE_GSPLAT, .alpha_most = 0.999f, .compensation_least = -1.0},
    [CONIC_PROFILE_GSPLAT_1_5_AA] = {LIKE_GSPLAT, .alpha_most = 0.999f, .compensation_least = 0.0},
    [CONIC_PROFILE_GSPLAT_1_6] = {LIKE_GSPLAT, .alpha_most = 0.99f, .compensation_least = -1.0},
    [CONIC_PROFILE_GSPLAT_1_6_AA] = {LIKE_GSPLAT, .alpha_most = 0.99f, .compensation_least = 2.5e-5},
    [CONIC_PROFILE_2DGS_2024] = {LIKE_INRIA, .shape = CONIC_SHAPE_DISC, .has_late_median = 1, .disc_cutoff = 3.0,
                                 .disc_near = 0.2f},
    [CONIC_PROFILE_2DGS_GSPLAT] = {LIKE_GSPLAT, .shape = CONIC_SHAPE_DISC, .coverage = CONIC_COVERAGE_BOX,
                                   .is_beyond_near = 1, .alpha_most = 0.99f, .disc_cutoff = 1.0, .disc_extent = 3.33},
    [CONIC_PROFILE_KHR_2026] = {.alpha_most = 1.0f,
                                .compensation_least = -1.0,
                                .slope_margin = -1.0,
                                .greatest_half_q = 4.5f,
                                .orders_by_distance = 1,
                                .has_float_eye = 1},
};

const conic_gaussian_rules *conic_gaussian_rules_of(conic_gaussian_profile profile) {
  return (unsigned)profile < CONIC_N_GAUSSIAN_PROFILES ? &all_rules[profile] : NULL;
}

CONIC_DEFINE_NAMES(conic_gaussian_profile_name, conic_gaussian_profile, CONIC_N_GAUSSIAN_PROFILES, "exact",
                   "inria-2023", "gsplat-1.5", "gsplat-1.5-aa", "gsplat-1.6", "gsplat-1.6-aa", "2dgs-2024",
                   "2dgs-gsplat", "khr-2026")

CONIC_DEFINE_OPTIONS(conic_gaussian_options, .profile = CONIC_PROFILE_EXACT)
