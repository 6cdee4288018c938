/* How far a site's surfel is from what it stands for, and from the mesh. */
#ifndef CONIC_CLUSTER_ERROR_H
#define CONIC_CLUSTER_ERROR_H

#include "lod/clusters/cluster_sites.h"

/* How far what the site stands for is from its plane, along the faces' normals, or its outline from the mesh, as
 * measured at twenty places; or how far it smears colours: the share of black and white by which they differ, of
 * its longest half axis. Where that is more than `known`; else `known`. In any case no more than *bound. */
double conic_site_error(const conic_sampler *sampler, const conic_site *site, double known, double *bound);

/* How far the surfel is from the mesh, as measured at forty places of its outline and its centre, and off the mesh at
 * 120 between, where that is more than `known`; else `known`. */
double conic_site_off_mesh(const conic_sampler *sampler, const conic_site *site, double known);

#endif
