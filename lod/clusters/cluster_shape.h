/* A plane for what each site stands for, and an ellipse that covers it. */
#ifndef CONIC_CLUSTER_SHAPE_H
#define CONIC_CLUSTER_SHAPE_H

#include "lod/clusters/cluster_sites.h"

/* Fills in the sums, planes, ellipses and errors of the sites that are not settled. Errors: MEMORY. */
conic_status conic_cluster_shape_sites(conic_sampler *sampler);

/* Fills in the planes of sites whose normals were summed up. */
void conic_cluster_settle_planes(conic_sampler *sampler);

/* Notes that a site, whose plane is known, must cover a place of that face; the face is seen straight on along
 * `facing`. Errors: MEMORY. */
conic_status conic_cluster_note_support(conic_sampler *sampler, uint32_t site, const double at[3], uint32_t face,
                                        const double facing[3]);

/* Finds the sites' ellipses and errors, from their planes and what was noted. Errors: MEMORY. */
conic_status conic_cluster_shape_supported(conic_sampler *sampler);

#endif
