/* Triangles lifted as splats are (source/top_lift.h): corners are where the parallel projection has them; edges are
 * straight between them. */
#ifndef CONIC_TOP_MESH_H
#define CONIC_TOP_MESH_H

#include "conic/triangles.h"
#include "source/top_lift.h"

/* Zero before the first use; the memory is kept for more of the same triangles. */
typedef struct conic_top_mesh {
  conic_triangles triangles; /* its positions and corners are its own, everything else belongs to the lifted
                                triangles */
  uint32_t (*corners[3])[3]; /* of positions, normals and texture coordinates */
  uint32_t *material;
} conic_top_mesh;

/* Fills the mesh with the triangles whose boxes reach into the place. Errors: MEMORY. */
conic_status conic_top_mesh_lift(conic_context *context, const conic_top_place *place, const conic_triangles *from,
                                 conic_top_mesh *mesh);
void conic_top_mesh_release(conic_context *context, conic_top_mesh *mesh);

#endif
