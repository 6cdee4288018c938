#include "core/formats/readers.h"

#include "core/base/loan_find.h"
#include "core/splats/columns.h"

int conic_model_is_lent(const conic_context *context, const char *name) {
  return conic_loan_find(context, name, "splats") || conic_loan_find(context, name, "triangles");
}

static conic_status copy_lent_splats(conic_context *context, const char *name, const conic_splats *lent,
                                     const conic_read_options *options, conic_model *model) {
  conic_status status = conic_splats_check(context, name, lent);
  if (status == CONIC_OK && options->field && !options->field_is_optional && !lent->scalar)
    status = conic_fail(context, CONIC_ERROR_INPUT, "%s: the points have no '%s'", name, options->field);
  if (status == CONIC_OK && (options->keep || options->where))
    status = conic_fail(context, CONIC_ERROR_INPUT, "%s: the points have no values by name", name);
  conic_splats wanted = *lent;
  if (!options->field)
    wanted.scalar = NULL;
  memcpy(model->points.origin, lent->origin, sizeof model->points.origin);
  return status == CONIC_OK ? conic_splats_append(context, &model->points, &wanted) : status;
}

/* The vertices, as splats without axes. */
static conic_splats vertices_of(const conic_triangles *mesh) {
  conic_splats points = {.count = mesh->n_vertices, .scalar = mesh->scalar, .scalar_origin = mesh->scalar_origin};
  memcpy(points.origin, mesh->origin, sizeof points.origin);
  for (int axis = 0; axis < 3; axis++) {
    points.position[axis] = mesh->position[axis];
    points.normal[axis] = mesh->normal[axis];
    points.color[axis] = mesh->color[axis];
  }
  points.strides.position = mesh->strides.position;
  points.strides.normal = mesh->strides.normal;
  points.strides.color = mesh->strides.color;
  points.strides.scalar = mesh->strides.scalar;
  return points;
}

/* A texture coordinate a vertex. */
static conic_status keep_lent_coordinates(conic_context *context, const conic_triangles *mesh, conic_model *model) {
  conic_status status = conic_faces_create(context, &model->faces);
  for (size_t i = 0; i < mesh->count && status == CONIC_OK; i++)
    status = conic_faces_add(context, model->faces, NULL, NULL);
  if (!mesh->texture_coordinate[0] || status != CONIC_OK)
    return status;
  conic_faces_begin_vertices(model->faces);
  for (size_t i = 0; i < mesh->n_vertices && status == CONIC_OK; i++) {
    double coordinate[2];
    for (int axis = 0; axis < 2; axis++)
      coordinate[axis] = (double)conic_column_at(mesh->texture_coordinate[axis], mesh->strides.texture_coordinate, i);
    status = conic_faces_add_coordinate(context, model->faces, coordinate);
  }
  return status;
}

static conic_status copy_lent_triangles(conic_context *context, const char *name, const conic_triangles *lent,
                                        const conic_read_options *options, conic_model *model) {
  conic_status status = conic_triangles_check(context, lent, name);
  if (status == CONIC_OK && (lent->normal_corners || lent->texture_corners || lent->n_materials))
    status = conic_fail(context, CONIC_ERROR_ARGUMENT, "%s: what is lent has its attributes at its vertices", name);
  if (status != CONIC_OK)
    return status;
  conic_splats points = vertices_of(lent);
  status = copy_lent_splats(context, name, &points, options, model);
  if (status != CONIC_OK || lent->count == 0)
    return status;
  model->triangles = conic_memory_copy(context, lent->corners, lent->count * sizeof *model->triangles);
  if (!model->triangles)
    return CONIC_ERROR_MEMORY;
  model->n_triangles = lent->count;
  return options->keeps_faces ? keep_lent_coordinates(context, lent, model) : CONIC_OK;
}

conic_status conic_model_copy_lent(conic_context *context, const char *name, const conic_read_options *options,
                                   conic_model *model) {
  const conic_splats *splats = conic_loan_find(context, name, "splats");
  return splats ? copy_lent_splats(context, name, splats, options, model)
                : copy_lent_triangles(context, name, conic_loan_find(context, name, "triangles"), options, model);
}
