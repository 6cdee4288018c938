/* What plain C and lanes share to find the reach of leaves (octree_fit.h). */
#pragma once

/* Leaves whose reach is compared with the same one before. */
enum { CONIC_REACH_BATCH = 8 };

/* An outline is held by the polygon of 16 corners around it: eight, and eight opposite. */
enum { CONIC_OUTLINE_CORNERS = 8 };
static const double conic_corners_x[CONIC_OUTLINE_CORNERS] = {
    1.0195911582083184,  0.9419794021690183,  0.7209598220069479, 0.3901806440322565, 0.0,
    -0.3901806440322565, -0.7209598220069479, -0.9419794021690183};
static const double conic_corners_y[CONIC_OUTLINE_CORNERS] = {0.0,
                                                              0.3901806440322565,
                                                              0.7209598220069479,
                                                              0.9419794021690183,
                                                              1.0195911582083184,
                                                              0.9419794021690183,
                                                              0.7209598220069479,
                                                              0.3901806440322565};

/* Parts of a shape's ratio that choose_ratio tries. */
enum { CONIC_N_RATIOS = 9 };
static const double conic_ratio_factors[CONIC_N_RATIOS] = {0.5, 0.59, 0.68, 0.77, 0.86, 1.0, 1.15, 1.3, 1.5};
