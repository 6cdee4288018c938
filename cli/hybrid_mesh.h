/* A mesh that becomes a hybrid model, for the commands that make one. */
#ifndef CLI_HYBRID_MESH_H
#define CLI_HYBRID_MESH_H

#include "cli/session.h"

/* Reads the mesh, and lays the texture on it in place of its own; null: none. On success the caller releases
 * *triangles. */
conic_status cli_mesh_read(cli_session *session, const char *path, const char *texture_path,
                           conic_triangles *triangles);

#endif
