/* Meshes from files: what any must have, and the texture that may lie on it in place of its own. */
#ifndef CONIC_MESH_INPUT_H
#define CONIC_MESH_INPUT_H

#include "conic/coloring.h"
#include "conic/triangles.h"

/* Reads a mesh; `texture_path` may be null, and so may `coloring`, which names the scalar that its vertices get. On
 * success the caller releases *triangles. Errors: as conic_triangles_read's; INPUT where nothing of it could be drawn.
 */
conic_status conic_mesh_read(conic_context *context, const char *path, const char *texture_path,
                             const conic_coloring_options *coloring, conic_triangles *triangles);

/* Refuses a mesh without a face that has an area, by name: INPUT. */
conic_status conic_mesh_check(conic_context *context, const char *path, const conic_triangles *triangles);

/* Lays a picture on the triangles. Errors: INPUT (they have no texture coordinates), UNSUPPORTED, MEMORY. */
conic_status conic_mesh_lay_texture(conic_context *context, const char *texture_path, conic_triangles *triangles);

#endif
