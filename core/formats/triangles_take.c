/* From a model to triangles. */

#include "core/files/file.h"
#include "core/formats/material_file.h"
#include "core/formats/model_read.h"

static int are_opaque(const conic_splats *points) {
  size_t i = 0;
  while (points->opacity && i < points->count && points->opacity[i] >= 1.0f)
    i++;
  return !points->opacity || i == points->count;
}

/* Moves the model's vertices, their colours, normals, scalars and alpha, and its faces. */
static void take_arrays(conic_model *model, conic_triangles *triangles) {
  conic_splats *points = &model->points;
  triangles->count = model->n_triangles;
  triangles->corners = model->triangles;
  triangles->n_vertices = points->count;
  memcpy(triangles->origin, points->origin, sizeof triangles->origin);
  memcpy(triangles->position, points->position, sizeof triangles->position);
  memcpy(triangles->color, points->color, sizeof triangles->color);
  memcpy(triangles->normal, points->normal, sizeof triangles->normal);
  triangles->scalar = points->scalar;
  triangles->scalar_origin = points->scalar_origin;
  if (!are_opaque(points)) {
    triangles->alpha = points->opacity;
    points->opacity = NULL;
  }
  triangles->n_normals = triangles->normal[0] ? points->count : 0;
  points->scalar = NULL;
  memset(points->position, 0, sizeof points->position);
  memset(points->color, 0, sizeof points->color);
  memset(points->normal, 0, sizeof points->normal);
  model->triangles = NULL;
  model->n_triangles = 0;
}

/* Splits an array of n vectors into arrays of one component, with one more, `none`, for corners without the
 * attribute. */
static conic_status split(conic_context *context, const void *rows, size_t n, int n_components, float **arrays) {
  const float *values = rows; /* null: corners name what is not there */
  for (int c = 0; c < n_components; c++) {
    arrays[c] = conic_memory_allocate(context, n + 1, sizeof(float));
    if (!arrays[c])
      return CONIC_ERROR_MEMORY;
    for (size_t i = 0; i < n; i++)
      arrays[c][i] = values[i * (size_t)n_components + (size_t)c];
    arrays[c][n] = 0.0f;
  }
  return CONIC_OK;
}

/* Corners without the attribute get the value after all others. */
static void name_none(uint32_t (*corners)[3], size_t count, size_t none) {
  for (size_t i = 0; i < count; i++)
    for (int k = 0; k < 3; k++)
      if (corners[i][k] == CONIC_NO_CORNER)
        corners[i][k] = (uint32_t)none;
}

/* Corners without a texture coordinate get their vertex's. */
static void name_vertices(uint32_t (*corners)[3], const conic_triangles *triangles, size_t first) {
  for (size_t i = 0; i < triangles->count; i++)
    for (int k = 0; k < 3; k++)
      if (corners[i][k] == CONIC_NO_CORNER)
        corners[i][k] = (uint32_t)(first + triangles->corners[i][k]);
}

static conic_status take_normals(conic_context *context, conic_faces *faces, conic_triangles *triangles) {
  if (!faces->has_normal_corners)
    return CONIC_OK;
  for (int axis = 0; axis < 3; axis++) {
    conic_memory_release(context, triangles->normal[axis]);
    triangles->normal[axis] = NULL;
  }
  triangles->n_normals = faces->n_normals + 1;
  triangles->normal_corners = faces->normal_corners;
  faces->normal_corners = NULL;
  name_none(triangles->normal_corners, triangles->count, faces->n_normals);
  return split(context, faces->normals, faces->n_normals, 3, triangles->normal);
}

static conic_status take_coordinates(conic_context *context, conic_faces *faces, conic_triangles *triangles) {
  if (!faces->has_texture_corners && !faces->has_vertex_coordinates)
    return CONIC_OK;
  if (!faces->has_texture_corners) {
    triangles->n_texture_coordinates = triangles->n_vertices;
    return split(context, faces->coordinates[faces->first_vertex_coordinate], triangles->n_vertices, 2,
                 triangles->texture_coordinate);
  }
  triangles->n_texture_coordinates = faces->n_coordinates + 1;
  triangles->texture_corners = faces->texture_corners;
  faces->texture_corners = NULL;
  if (faces->has_vertex_coordinates)
    name_vertices(triangles->texture_corners, triangles, faces->first_vertex_coordinate);
  name_none(triangles->texture_corners, triangles->count, faces->n_coordinates);
  return split(context, faces->coordinates, faces->n_coordinates, 2, triangles->texture_coordinate);
}

static conic_status allocate_materials(conic_context *context, size_t n, conic_triangles *triangles) {
  triangles->materials = conic_memory_allocate_zeroed(context, n, sizeof *triangles->materials);
  if (!triangles->materials)
    return CONIC_ERROR_MEMORY;
  triangles->n_materials = n;
  for (size_t i = 0; i < n; i++)
    for (int channel = 0; channel < 3; channel++)
      triangles->materials[i].color[channel] = 1.0f;
  return CONIC_OK;
}

/* White stands for what a missing material file would have said. */
static conic_status take_named_materials(conic_context *context, conic_faces *faces, conic_triangles *triangles) {
  size_t n = faces->material_names.count;
  if (n < 2)
    return CONIC_OK;
  conic_status status = allocate_materials(context, n, triangles);
  if (status != CONIC_OK)
    return status;
  triangles->material = faces->material;
  faces->material = NULL;
  for (size_t i = 0; i < faces->libraries.count; i++) {
    const char *path = conic_texts_at(&faces->libraries, i);
    if (!conic_file_is_there(path)) {
      conic_log(context, CONIC_LOG_WARNING, "%s: the material file is not there, and is left out", path);
      continue;
    }
    status = conic_material_file_read(context, path, &faces->material_names, triangles->materials);
    if (status != CONIC_OK)
      return status;
  }
  return CONIC_OK;
}

/* Without texture corners, all triangles have the first picture. */
static conic_status take_pictures(conic_context *context, conic_faces *faces, conic_triangles *triangles) {
  size_t n = faces->pictures.count;
  if (n == 0 || !triangles->texture_coordinate[0])
    return CONIC_OK;
  conic_status status = allocate_materials(context, n + (faces->count > 0), triangles);
  for (size_t i = 0; status == CONIC_OK && i < n; i++) {
    const char *path = conic_texts_at(&faces->pictures, i);
    if (conic_file_is_there(path))
      status = conic_texture_read(context, path, CONIC_WRAP_REPEAT, &triangles->materials[i].texture);
    else
      conic_log(context, CONIC_LOG_WARNING, "%s: the texture is not there, and is left out", path);
  }
  if (faces->count) {
    triangles->material = faces->material;
    faces->material = NULL;
  }
  return status;
}

/* One more material, white, is for triangles without any. */
static conic_status take_made(conic_context *context, conic_faces *faces, conic_triangles *triangles) {
  size_t n = faces->n_made;
  if (n == 0)
    return CONIC_OK;
  conic_status status = allocate_materials(context, n + 1, triangles);
  if (status != CONIC_OK)
    return status;
  memcpy(triangles->materials, faces->made, n * sizeof *faces->made);
  faces->n_made = 0;
  triangles->material = faces->material;
  faces->material = NULL;
  return CONIC_OK;
}

conic_status conic_triangles_take(conic_context *context, conic_model *model, conic_triangles *triangles) {
  conic_faces *faces = model->faces;
  conic_status status = CONIC_OK;
  memset(triangles, 0, sizeof *triangles);
  if (model->n_triangles == 0)
    return conic_fail(context, CONIC_ERROR_INPUT, "the model has no faces");
  take_arrays(model, triangles);
  if (faces) {
    status = take_normals(context, faces, triangles);
    if (status == CONIC_OK)
      status = take_coordinates(context, faces, triangles);
    if (status == CONIC_OK)
      status = take_named_materials(context, faces, triangles);
    if (status == CONIC_OK)
      status = take_pictures(context, faces, triangles);
    if (status == CONIC_OK)
      status = take_made(context, faces, triangles);
  }
  conic_faces_destroy(context, faces);
  model->faces = NULL;
  conic_splats_release(context, &model->points);
  if (status != CONIC_OK)
    conic_triangles_release(context, triangles);
  return status;
}

conic_status conic_triangles_read_model(conic_context *context, const char *path, conic_read_options *options,
                                        conic_triangles *triangles) {
  conic_model model;
  memset(triangles, 0, sizeof *triangles);
  options->keeps_faces = 1;
  conic_status status = conic_model_read(context, path, options, &model);
  if (status != CONIC_OK)
    return status;
  if (model.n_triangles == 0)
    status = conic_fail(context, CONIC_ERROR_INPUT, "%s: the file has no faces", path);
  if (status == CONIC_OK)
    status = conic_triangles_take(context, &model, triangles);
  conic_model_release(context, &model);
  return status;
}

conic_status conic_triangles_read(conic_context *context, const char *path, conic_triangles *triangles) {
  conic_read_options options;
  conic_read_options_init(&options);
  return conic_triangles_read_model(context, path, &options, triangles);
}
