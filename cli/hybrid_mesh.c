#include "cli/hybrid_mesh.h"

conic_status cli_mesh_read(cli_session *session, const char *path, const char *texture_path,
                           conic_triangles *triangles) {
  conic_texture *texture;
  conic_status status = conic_triangles_read(session->context, path, triangles);
  if (status != CONIC_OK || !texture_path)
    return status;
  if (!triangles->texture_coordinate[0]) {
    cli_error(CLI_INPUT, "%s: the mesh has no texture coordinates for it", texture_path);
    status = CONIC_ERROR_INPUT;
  } else
    status = conic_texture_read(session->context, texture_path, CONIC_WRAP_REPEAT, &texture);
  if (status == CONIC_OK) {
    status = conic_triangles_texture(session->context, triangles, texture);
    if (status != CONIC_OK)
      conic_texture_destroy(texture);
  }
  if (status != CONIC_OK)
    conic_triangles_release(session->context, triangles);
  return status;
}
