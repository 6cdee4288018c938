/* How far a site's surfel is from what it stands for, and from the mesh. */
#ifndef CONIC_CLUSTER_ERROR_H
#define CONIC_CLUSTER_ERROR_H

#include "lod/clusters/cluster_sites.h"

/* The greatest of three, or `known` where that is more; in any case no more than *bound. How far what the site stands
 * for is from its plane, along the faces' normals. How far its outline is from the mesh, as measured at twenty places.
 * How far it smears colours: its longest half axis, times the share of black and white by which they differ. */
double conic_site_error(const conic_sampler *sampler, const conic_site *site, double known, double *bound);

/* How far the surfel is from the mesh, or `known` where that is more. It is measured at its centre and at forty places
 * of its outline, and off the mesh at 120 places between. */
double conic_site_off_mesh(const conic_sampler *sampler, const conic_site *site, double known);

#endif
