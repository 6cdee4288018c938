/* A plane for what each site stands for, and an ellipse that covers it. */
#ifndef LOD_PATCH_SHAPE_H
#define LOD_PATCH_SHAPE_H

#include "lod/patch_sites.h"

/* Fills in the sums, planes, ellipses and errors of the sites that are not settled. Errors: MEMORY. */
conic_status conic_patch_shape_sites(conic_sampler *sampler);

#endif
