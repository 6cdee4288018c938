#include "core/splats/gaussian_profile.h"

#define LEAST_ALPHA (1.0 / 255.0)
#define LIKE_INRIA                                                                                                     \
  .coverage = CONIC_COVERAGE_TILES, .near_z = 0.2, .is_beyond_near = 1, .alpha_most = 0.99,                            \
  .alpha_least = LEAST_ALPHA, .stop = 1e-4, .takes_rotation_as_is = 1, .takes_middle = 1, .has_float_eye = 1
#define LIKE_GSPLAT                                                                                                    \
  .near_z = 0.01, .alpha_least = LEAST_ALPHA, .stop = 1e-4, .is_beyond_stop = 1, .dilation = 0.3, .slope_margin = 0.3, \
  .has_float_eye = 1
#define ON_THE_WEB .alpha_most = 1.0, .slope_margin = -1.0, .greatest_half_q = 4.0, .has_float_eye = 1
#define ROOT_OF_2 1.4142135623730951
#define ROOT_OF_8 2.8284271247461903

static const conic_profile_row rows[CONIC_N_GAUSSIAN_PROFILES] = {
    [CONIC_PROFILE_EXACT] = {"exact", .shape = CONIC_SHAPE_RAY, .alpha_most = 0.99, .alpha_least = LEAST_ALPHA,
                             .stop = 1e-4},
    [CONIC_PROFILE_INRIA_2023] = {"inria-2023", LIKE_INRIA, .dilation = 0.3, .slope_margin = 0.3,
                                  .compensation_least = -1.0},
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
    [CONIC_PROFILE_INRIA_2023_AA] = {"inria-2023-aa", LIKE_INRIA, .dilation = 0.3, .slope_margin = 0.3,
                                     .compensation_least = 2.5e-5},
    [CONIC_PROFILE_MIP_2023] = {"mip-2023", LIKE_INRIA, .dilation = 0.1, .slope_margin = 0.3,
                                .compensation_slack = 1e-6},
    [CONIC_PROFILE_BRUSH_1] = {"brush-1", LIKE_GSPLAT, .alpha_most = 0.999, .compensation_least = -1.0},
    [CONIC_PROFILE_SPLAT_2023] = {"splat-2023", ON_THE_WEB, .near_z = 40.0 / 399.8, .is_beyond_near = 1, .fade_z = 0.2,
                                  .compensation_least = -1.0, .clip = 1.2, .axis_most = 1024.0 / ROOT_OF_2,
                                  .color_most = 1.0, .has_plain_color = 1, .takes_rotation_as_is = 2},
    [CONIC_PROFILE_PLAYCANVAS_2] = {"playcanvas-2", ON_THE_WEB, .alpha_least = LEAST_ALPHA, .dilation = 0.075,
                                    .compensation_least = -1.0, .axis_least = 0.025, .axis_most = 1024.0 / ROOT_OF_8,
                                    .axis_share = 1.0 / ROOT_OF_8, .axis_seen = 1.0 / ROOT_OF_8,
                                    .fall_end = 0.01831563888873418},
    [CONIC_PROFILE_SPARK_2] = {"spark-2", ON_THE_WEB, .near_z = 0.1, .alpha_least = 0.5 / 255.0, .dilation = 0.3,
                               .clip = 1.4, .axis_most = 512.0 / ROOT_OF_8, .orders_by_distance = 1,
                               .spread_cancels = 1},
    [CONIC_PROFILE_GS3D_0_4] = {"gs3d-0.4", ON_THE_WEB, .near_z = 0.1, .dilation = 0.3, .compensation_least = -1.0,
                                .clip = 1.2, .axis_most = 1024.0 / ROOT_OF_8, .spread_least = 0.31622776601683794,
                                .spread_cancels = 1, .color_most = 1.0},
    [CONIC_PROFILE_3DGUT_2025] = {"3dgut-2025", LIKE_GSPLAT, .shape = CONIC_SHAPE_SOLID, .coverage = CONIC_COVERAGE_BOX,
                                  .alpha_most = 0.99, .compensation_least = -1.0, .unscented = {0.1, 2.0, 0.0},
                                  .unscented_share = 0.1},
};

const conic_profile_row *conic_profile_row_of(conic_gaussian_profile profile) {
  return (unsigned)profile < CONIC_N_GAUSSIAN_PROFILES ? &rows[profile] : NULL;
}

const char *conic_gaussian_profile_name(conic_gaussian_profile profile) {
  return (unsigned)profile < CONIC_N_GAUSSIAN_PROFILES ? rows[profile].name : NULL;
}
