#include "source/mesh_input.h"

#include <string.h>

#include "core/base/message.h"

static int is_apart(const conic_triangles *mesh, uint32_t a, uint32_t b) {
  for (int axis = 0; axis < 3; axis++)
    if (mesh->position[axis][a] != mesh->position[axis][b])
      return 1;
  return 0;
}

/* Whether any face has three finite corners at three places. */
static int has_face(const conic_triangles *mesh) {
  for (size_t i = 0; i < mesh->count; i++) {
    const uint32_t *c = mesh->corners[i];
    int is_finite = 1;
    for (int corner = 0; corner < 3; corner++)
      for (int axis = 0; axis < 3; axis++)
        is_finite &= mesh->position[axis][c[corner]] - mesh->position[axis][c[corner]] == 0.0f;
    if (is_finite && is_apart(mesh, c[0], c[1]) && is_apart(mesh, c[1], c[2]) && is_apart(mesh, c[2], c[0]))
      return 1;
  }
  return 0;
}

conic_status conic_mesh_check(conic_context *context, const char *path, const conic_triangles *triangles) {
  if (has_face(triangles))
    return CONIC_OK;
  return conic_fail(context, CONIC_ERROR_INPUT, "%s: no face has three finite corners at three places", path);
}

conic_status conic_mesh_lay_texture(conic_context *context, const char *texture_path, conic_triangles *triangles) {
  conic_texture *texture;
  if (!triangles->texture_coordinate[0])
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: the mesh has no texture coordinates for it", texture_path);
  conic_status status = conic_texture_read(context, texture_path, CONIC_WRAP_REPEAT, &texture);
  if (status != CONIC_OK)
    return status;
  status = conic_triangles_texture(context, triangles, texture);
  if (status != CONIC_OK)
    conic_texture_destroy(texture);
  return status;
}

static conic_status read_faces(conic_context *context, const char *path, const conic_coloring_options *coloring,
                               conic_triangles *triangles) {
  conic_read_options options;
  conic_model model;
  memset(triangles, 0, sizeof *triangles);
  conic_read_options_init(&options);
  options.keeps_faces = 1;
  conic_coloring_read(coloring, &options);
  conic_status status = conic_model_read(context, path, &options, &model);
  if (status != CONIC_OK)
    return status;
  if (model.n_triangles == 0)
    status = conic_fail(context, CONIC_ERROR_INPUT, "%s: the file has no faces", path);
  if (status == CONIC_OK)
    status = conic_triangles_take(context, &model, triangles);
  conic_model_release(context, &model);
  return status;
}

conic_status conic_mesh_read(conic_context *context, const char *path, const char *texture_path,
                             const conic_coloring_options *coloring, conic_triangles *triangles) {
  conic_status status = read_faces(context, path, coloring, triangles);
  if (status == CONIC_OK)
    status = conic_mesh_check(context, path, triangles);
  if (status == CONIC_OK && texture_path)
    status = conic_mesh_lay_texture(context, texture_path, triangles);
  if (status != CONIC_OK)
    conic_triangles_release(context, triangles);
  return status;
}
