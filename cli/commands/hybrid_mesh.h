/* Meshes: those that become hybrid models, for the commands that make them, and what any mesh must have. */
#ifndef CONIC_HYBRID_MESH_H
#define CONIC_HYBRID_MESH_H

#include "cli/session.h"

/* Reads the mesh, and lays the texture on it in place of its own; null: none. On success the caller releases
 * *triangles. */
conic_status cli_mesh_read(cli_session *session, const char *path, const char *texture_path,
                           conic_triangles *triangles);

/* Refuses a mesh of which nothing could be drawn, by name: INPUT. */
conic_status cli_mesh_check(const char *path, const conic_triangles *triangles);

#endif
