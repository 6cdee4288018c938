/* Surfaces with creases: a sample's own side of them, and points of what meets there. */
#ifndef CONIC_CREASES_H
#define CONIC_CREASES_H

#include "surface/mls_surface.h"

/* Finds the normal of the side that each slot lies on, and its spacing. Errors: MEMORY, CANCELLED. */
conic_status conic_creases_find(conic_surface *surface);
void conic_creases_release(conic_surface *surface);

/* Projects r onto the nearest of the pieces that meet about it, or the edge or corner where they do. Returns 0, and has
 * done nothing but spoil the workspace's neighbours, where there is one piece only. */
int conic_creases_project(const conic_surface *surface, const double r[3], double h, uint32_t except,
                          conic_workspace *workspace, conic_landing *landing);

#endif
