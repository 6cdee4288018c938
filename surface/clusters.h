/* Cells of the tree as single samples (PSS §3.4.2). */
#ifndef CONIC_CLUSTERS_H
#define CONIC_CLUSTERS_H

#include "surface/mls_surface.h"

/* Errors: MEMORY. */
conic_status conic_clusters_create(conic_surface *surface);
void conic_clusters_release(conic_surface *surface);

#endif
