/* Surfaces with creases: which side of a crease each sample is on, and projection where sides meet. */
#ifndef CONIC_CREASES_H
#define CONIC_CREASES_H

#include "surface/mls_surface.h"

/* Finds the normal of each slot's side, and its spacing. Errors: MEMORY, CANCELLED. */
conic_status conic_creases_find(conic_surface *surface);
void conic_creases_release(conic_surface *surface);

/* Projects r onto the nearest of the pieces that meet near it, or onto the edge or corner where they meet. Where there
 * is only one piece, returns 0; only the workspace's neighbours are then changed. */
int conic_creases_project(const conic_surface *surface, const double r[3], double h, uint32_t except,
                          conic_workspace *workspace, conic_landing *landing);

#endif
