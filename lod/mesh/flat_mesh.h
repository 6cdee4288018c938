/* Turns meshes whose attributes have indices of their own into ones with one index a corner. */
#ifndef CONIC_FLAT_MESH_H
#define CONIC_FLAT_MESH_H

#include "conic/triangles.h"

/* Gives *flat the triangles of `mesh`, which has been checked. Corners that share a place but differ in normal or
 * texture coordinates get vertices of their own. Vertices that no triangle uses go. Materials stay with `mesh`. The
 * caller releases *flat. Errors: ARGUMENT (over 2³¹ corners), MEMORY. */
conic_status conic_flat_mesh(conic_context *context, const conic_triangles *mesh, conic_triangles *flat);

#endif
