/* A plane for what each site stands for, and an ellipse that covers it. */
#ifndef LOD_PATCH_SHAPE_H
#define LOD_PATCH_SHAPE_H

#include "lod/patch_sites.h"

/* Fills in the sites' sums, planes, ellipses and errors. Errors: MEMORY. */
conic_status conic_patch_shape_sites(conic_sampler *sampler);

/* Fills in the planes of sites whose normals were summed up. */
void conic_patch_settle_planes(conic_sampler *sampler);

/* Notes that a site, whose plane is known, must cover a place: of that face, which is seen straight on along `facing`.
 * Errors: MEMORY. */
conic_status conic_patch_note_support(conic_sampler *sampler, uint32_t site, const double at[3], uint32_t face,
                                      const double facing[3]);

/* From the sites' planes and what was noted: their ellipses and errors. Errors: MEMORY. */
conic_status conic_patch_shape_supported(conic_sampler *sampler);

/* How far what the site stands for is from its plane, along the faces' normals, or its outline from the mesh, as
 * measured at twenty places; or how far it smears colours: the share of black and white by which they differ, of
 * its longest half axis. Where that is more than `known`; else `known`. In any case no more than *bound. */
double conic_site_error(const conic_sampler *sampler, const conic_site *site, double known, double *bound);

#endif
