#include "core/meshes/mesh_parts.h"

#include "core/base/vectors.h"

conic_status conic_mesh_parts_begin(conic_context *context, const char *name, const conic_read_options *options,
                                    conic_model *model, conic_mesh_parts *parts) {
  memset(parts, 0, sizeof *parts);
  parts->context = context;
  parts->name = name;
  conic_status status = conic_builder_begin(context, model, 0, NULL, &parts->builder);
  if (status == CONIC_OK && options->keeps_faces)
    status = conic_faces_create(context, &model->faces);
  parts->faces = model->faces;
  return status;
}

void conic_mesh_parts_release(conic_mesh_parts *parts) {
  conic_memory_release_these(parts->context, parts->slots.slots, parts->normals);
}

void conic_mesh_part_release(conic_context *context, conic_mesh_part *part) {
  conic_memory_release_these(context, part->position, part->normal, part->coordinate, part->color, part->alpha,
                             part->point);
  *part = (conic_mesh_part){.n_vertices = 0};
}

/* The point of a vertex: an earlier one, or a new one of the model. */
static uint32_t add_vertex(conic_mesh_parts *parts, const conic_mesh_part *part, size_t i) {
  conic_splats *points = &parts->builder.model->points;
  size_t next = points->count;
  conic_builder_store_position(&parts->builder, part->position[i]);
  for (int channel = 0; channel < 3 && points->color[0]; channel++)
    points->color[channel][next] = part->color ? part->color[i][channel] : 1.0f;
  if (points->opacity)
    points->opacity[next] = part->alpha ? part->alpha[i] : 1.0f;
  if (!part->is_points) /* those have no slot */
    return conic_point_slots_join(&parts->builder, &parts->slots);
  points->count++;
  return (uint32_t)next;
}

static conic_status add_vertices(conic_mesh_parts *parts, conic_mesh_part *part) {
  size_t count = parts->builder.model->points.count + part->n_vertices;
  if (count > CONIC_MAX_POINTS)
    return conic_fail(parts->context, CONIC_ERROR_INPUT, "%s: there are too many vertices", parts->name);
  conic_status status = conic_builder_reserve_points(&parts->builder, count);
  if (status == CONIC_OK && part->color)
    status = conic_builder_add_field(&parts->builder, CONIC_SPLATS_COLORS);
  if (status == CONIC_OK && part->alpha)
    status = conic_builder_add_field(&parts->builder, CONIC_SPLATS_OPACITIES);
  if (status == CONIC_OK && !part->is_points)
    status = conic_point_slots_reserve(&parts->builder, &parts->slots, count);
  if (status != CONIC_OK)
    return status;
  part->point = conic_memory_allocate(parts->context, part->n_vertices, sizeof *part->point);
  if (!part->point)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < part->n_vertices; i++)
    part->point[i] = add_vertex(parts, part, i);
  return CONIC_OK;
}

static void add_normal(conic_mesh_parts *parts, const conic_mesh_part *part, size_t i_vertex) {
  for (int axis = 0; axis < 3; axis++)
    parts->normals[part->point[i_vertex]][axis] += (double)part->normal[i_vertex][axis];
}

static conic_status make_room_for_normals(conic_mesh_parts *parts) {
  size_t n = parts->builder.model->points.count, n_before = parts->normal_room;
  conic_status status =
      conic_memory_reserve(parts->context, &parts->normals, n_before, n, &parts->normal_room, sizeof *parts->normals);
  if (status == CONIC_OK)
    memset(parts->normals + n_before, 0, (parts->normal_room - n_before) * sizeof *parts->normals);
  return status;
}

/* The corners' attributes, which each corner keeps for itself. */
static conic_status add_attributes(conic_mesh_parts *parts, conic_mesh_part *part) {
  conic_faces *faces = parts->faces;
  conic_status status = CONIC_OK;
  part->first_normal = faces->n_normals;
  part->first_coordinate = faces->n_coordinates;
  for (size_t i = 0; status == CONIC_OK && part->normal && i < part->n_vertices; i++) {
    const double normal[3] = {(double)part->normal[i][0], (double)part->normal[i][1], (double)part->normal[i][2]};
    status = conic_faces_add_normal(parts->context, faces, normal);
  }
  for (size_t i = 0; status == CONIC_OK && part->coordinate && i < part->n_vertices; i++) {
    const double coordinate[2] = {(double)part->coordinate[i][0], (double)part->coordinate[i][1]};
    status = conic_faces_add_coordinate(parts->context, faces, coordinate);
  }
  if (status == CONIC_OK && (faces->n_normals > CONIC_MAX_POINTS || faces->n_coordinates > CONIC_MAX_POINTS))
    status = conic_fail(parts->context, CONIC_ERROR_INPUT, "%s: there are too many vertices", parts->name);
  return status;
}

conic_status conic_mesh_parts_add(conic_mesh_parts *parts, conic_mesh_part *part) {
  conic_status status = add_vertices(parts, part);
  if (status == CONIC_OK && part->normal)
    status = make_room_for_normals(parts);
  for (size_t i = 0; status == CONIC_OK && part->normal && part->is_points && i < part->n_vertices; i++)
    add_normal(parts, part, i);
  return status == CONIC_OK && parts->faces && !part->is_points ? add_attributes(parts, part) : status;
}

static conic_status add_triangle(conic_mesh_parts *parts, const conic_mesh_part *part, const uint32_t corners[3]) {
  uint32_t normals[3], coordinates[3];
  for (int k = 0; k < 3; k++) {
    if (corners[k] >= part->n_vertices)
      return conic_fail(parts->context, CONIC_ERROR_INPUT,
                        "%s: index %u of a face is out of range: there are only %zu vertices", parts->name, corners[k],
                        part->n_vertices);
    normals[k] = (uint32_t)(part->first_normal + corners[k]);
    coordinates[k] = (uint32_t)(part->first_coordinate + corners[k]);
    if (part->normal)
      add_normal(parts, part, corners[k]);
  }
  conic_status status = conic_builder_add_triangle(&parts->builder, part->point[corners[0]], part->point[corners[1]],
                                                   part->point[corners[2]]);
  if (status == CONIC_OK && parts->faces)
    status = conic_faces_add(parts->context, parts->faces, part->normal ? normals : NULL,
                             part->coordinate ? coordinates : NULL);
  return status;
}

conic_status conic_mesh_parts_add_triangles(conic_mesh_parts *parts, const conic_mesh_part *part,
                                            const uint32_t (*triangles)[3], size_t n) {
  conic_status status = CONIC_OK;
  for (size_t i = 0; status == CONIC_OK && i < n; i++)
    status = add_triangle(parts, part, triangles[i]);
  return status;
}

conic_status conic_mesh_parts_end(conic_mesh_parts *parts) {
  conic_splats *points = &parts->builder.model->points;
  if (!parts->normals)
    return CONIC_OK;
  conic_status status = make_room_for_normals(parts);
  if (status == CONIC_OK)
    status = conic_builder_add_field(&parts->builder, CONIC_SPLATS_NORMALS);
  for (size_t i = 0; status == CONIC_OK && i < points->count; i++) {
    conic_normalize(parts->normals[i]);
    for (int axis = 0; axis < 3; axis++)
      points->normal[axis][i] = (float)parts->normals[i][axis];
  }
  return status;
}
