#include "core/assimp/assimp_part.h"

#include "core/base/color.h"
#include "core/base/vectors.h"

/* A part's arrays as they come, and which point each vertex became. */
typedef struct assimp_part {
  size_t n_vertices, n_triangles;
  double (*position)[3];
  float (*normal)[3], (*coordinate)[2], (*color)[3], *alpha;
  uint32_t (*triangles)[3];
  uint32_t *point;
} assimp_part;

float conic_assimp_decode(const conic_assimp_part_builder *parts, float value) {
  if (parts->is_linear)
    return value;
  double code = 255.0 * (double)value, whole = code >= 0.0 && code <= 255.0 ? (double)(int)(code + 0.5) : -1.0;
  int is_code = code - whole < 1e-4 && whole - code < 1e-4; /* an 8-bit code before it became a float */
  return (float)conic_srgb_decode(is_code ? whole / 255.0 : (double)value);
}

conic_status conic_assimp_parts_begin(conic_context *context, const char *name, conic_model_kind kind,
                                      const conic_read_options *options, conic_model *model,
                                      conic_assimp_part_builder *parts) {
  memset(parts, 0, sizeof *parts);
  parts->context = context;
  parts->name = name;
  parts->is_linear = kind == CONIC_MODEL_GLTF || kind == CONIC_MODEL_GLB;
  conic_status status = conic_builder_begin(context, model, 0, NULL, &parts->builder);
  if (status == CONIC_OK && options->keeps_faces)
    status = conic_faces_create(context, &model->faces);
  parts->faces = model->faces;
  return status;
}

void conic_assimp_parts_release(conic_assimp_part_builder *parts) {
  conic_memory_release_these(parts->context, parts->slots.slots, parts->normals);
}

static void release_part(conic_context *context, assimp_part *taken) {
  conic_memory_release_these(context, taken->position, taken->normal, taken->coordinate, taken->color, taken->alpha,
                             taken->triangles, taken->point);
}

/* Takes one of its arrays; null where there is none. */
static conic_status take_array(conic_assimp_process *process, int is_there, size_t n, size_t size, void *array) {
  void *bytes = is_there ? conic_memory_allocate(process->context, n, size) : NULL;
  memcpy(array, &bytes, sizeof bytes);
  if (!is_there)
    return CONIC_OK;
  return bytes ? conic_assimp_process_take(process, bytes, n * size) : CONIC_ERROR_MEMORY;
}

static conic_status take_part_arrays(conic_assimp_process *process, const conic_assimp_record *record,
                                     assimp_part *taken) {
  size_t n = taken->n_vertices, n_triangles = taken->n_triangles;
  conic_status status = take_array(process, 1, n, sizeof *taken->position, &taken->position);
  if (status == CONIC_OK)
    status =
        take_array(process, (record->fields & CONIC_ASSIMP_NORMALS) != 0, n, sizeof *taken->normal, &taken->normal);
  if (status == CONIC_OK)
    status = take_array(process, (record->fields & CONIC_ASSIMP_COORDINATES) != 0, n, sizeof *taken->coordinate,
                        &taken->coordinate);
  if (status == CONIC_OK)
    status = take_array(process, (record->fields & CONIC_ASSIMP_COLORS) != 0, n, sizeof *taken->color, &taken->color);
  if (status == CONIC_OK)
    status = take_array(process, (record->fields & CONIC_ASSIMP_ALPHAS) != 0, n, sizeof *taken->alpha, &taken->alpha);
  if (status == CONIC_OK)
    status = take_array(process, 1, n_triangles, sizeof *taken->triangles, &taken->triangles);
  for (size_t i = 0; status == CONIC_OK && i < n_triangles; i++)
    for (int corner = 0; corner < 3; corner++)
      if (taken->triangles[i][corner] >= n)
        return conic_fail(process->context, CONIC_ERROR_INPUT, "%s: index %u, but there are only %zu vertices",
                          process->name, taken->triangles[i][corner], n);
  return status;
}

/* The point of a vertex: an earlier one, or a new one of the model. */
static uint32_t add_vertex(conic_assimp_part_builder *parts, const assimp_part *taken, size_t i) {
  conic_splats *points = &parts->builder.model->points;
  size_t next = points->count;
  conic_builder_store_position(&parts->builder, taken->position[i]);
  for (int channel = 0; channel < 3 && points->color[0]; channel++)
    points->color[channel][next] = taken->color ? conic_assimp_decode(parts, taken->color[i][channel]) : 1.0f;
  if (points->opacity)
    points->opacity[next] = taken->alpha ? taken->alpha[i] : 1.0f;
  if (taken->n_triangles) /* points of parts without triangles have no slot */
    return conic_point_slots_join(&parts->builder, &parts->slots);
  points->count++;
  return (uint32_t)next;
}

static conic_status add_vertices(conic_assimp_part_builder *parts, assimp_part *taken) {
  size_t count = parts->builder.model->points.count + taken->n_vertices;
  if (count > CONIC_MAX_POINTS)
    return conic_fail(parts->context, CONIC_ERROR_INPUT, "%s: there are too many vertices", parts->name);
  conic_status status = conic_builder_reserve_points(&parts->builder, count);
  if (status == CONIC_OK && taken->color)
    status = conic_builder_add_field(&parts->builder, CONIC_SPLATS_COLORS);
  if (status == CONIC_OK && taken->alpha)
    status = conic_builder_add_field(&parts->builder, CONIC_SPLATS_OPACITIES);
  if (status == CONIC_OK && taken->n_triangles)
    status = conic_point_slots_reserve(&parts->builder, &parts->slots, count);
  if (status != CONIC_OK)
    return status;
  taken->point = conic_memory_allocate(parts->context, taken->n_vertices, sizeof *taken->point);
  if (!taken->point)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < taken->n_vertices; i++)
    taken->point[i] = add_vertex(parts, taken, i);
  return CONIC_OK;
}

static void add_normal(conic_assimp_part_builder *parts, const assimp_part *taken, size_t i_vertex) {
  for (int axis = 0; axis < 3; axis++)
    parts->normals[taken->point[i_vertex]][axis] += (double)taken->normal[i_vertex][axis];
}

static conic_status add_normals(conic_assimp_part_builder *parts, const assimp_part *taken) {
  size_t n = parts->builder.model->points.count, n_before = parts->normal_room;
  conic_status status =
      conic_memory_reserve(parts->context, &parts->normals, n_before, n, &parts->normal_room, sizeof *parts->normals);
  if (status != CONIC_OK)
    return status;
  memset(parts->normals + n_before, 0, (parts->normal_room - n_before) * sizeof *parts->normals);
  if (!taken->normal)
    return CONIC_OK;
  parts->has_normals = 1;
  for (size_t i = 0; i < taken->n_vertices && taken->n_triangles == 0; i++)
    add_normal(parts, taken, i);
  for (size_t i = 0; i < taken->n_triangles; i++)
    for (int corner = 0; corner < 3; corner++)
      add_normal(parts, taken, taken->triangles[i][corner]);
  return CONIC_OK;
}

/* The corners' attributes, which each corner keeps for itself. */
static conic_status add_attributes(conic_assimp_part_builder *parts, const assimp_part *taken) {
  conic_status status = CONIC_OK;
  for (size_t i = 0; status == CONIC_OK && taken->normal && i < taken->n_vertices; i++) {
    const double normal[3] = {(double)taken->normal[i][0], (double)taken->normal[i][1], (double)taken->normal[i][2]};
    status = conic_faces_add_normal(parts->context, parts->faces, normal);
  }
  for (size_t i = 0; status == CONIC_OK && taken->coordinate && i < taken->n_vertices; i++) {
    const double coordinate[2] = {(double)taken->coordinate[i][0], (double)taken->coordinate[i][1]};
    status = conic_faces_add_coordinate(parts->context, parts->faces, coordinate);
  }
  return status;
}

static conic_status add_triangles(conic_assimp_part_builder *parts, const assimp_part *taken) {
  size_t first_normal = parts->faces ? parts->faces->n_normals : 0;
  size_t first_coordinate = parts->faces ? parts->faces->n_coordinates : 0;
  conic_status status = parts->faces ? add_attributes(parts, taken) : CONIC_OK;
  if (status == CONIC_OK && parts->faces &&
      (parts->faces->n_normals > CONIC_MAX_POINTS || parts->faces->n_coordinates > CONIC_MAX_POINTS))
    status = conic_fail(parts->context, CONIC_ERROR_INPUT, "%s: there are too many vertices", parts->name);
  for (size_t i = 0; status == CONIC_OK && i < taken->n_triangles; i++) {
    uint32_t normals[3], coordinates[3];
    const uint32_t *corners = taken->triangles[i];
    for (int k = 0; k < 3; k++) {
      normals[k] = (uint32_t)(first_normal + corners[k]);
      coordinates[k] = (uint32_t)(first_coordinate + corners[k]);
    }
    status = conic_builder_add_triangle(&parts->builder, taken->point[corners[0]], taken->point[corners[1]],
                                        taken->point[corners[2]]);
    if (status == CONIC_OK && parts->faces)
      status = conic_faces_add(parts->context, parts->faces, taken->normal ? normals : NULL,
                               taken->coordinate ? coordinates : NULL);
  }
  return status;
}

conic_status conic_assimp_take_part(conic_assimp_process *process, const conic_assimp_record *record,
                                    conic_assimp_part_builder *parts) {
  assimp_part taken = {.n_vertices = (size_t)record->n_vertices, .n_triangles = (size_t)record->n_triangles};
  if (record->n_vertices < 1 || record->n_vertices > CONIC_MAX_POINTS ||
      record->n_triangles > SIZE_MAX / sizeof *taken.triangles)
    return conic_fail(process->context, CONIC_ERROR_INPUT, "%s: there are no vertices, or too many", process->name);
  conic_status status = take_part_arrays(process, record, &taken);
  if (parts->faces)
    parts->faces->current_material =
        record->i_material < parts->faces->n_made ? record->i_material : (uint32_t)parts->faces->n_made;
  if (status == CONIC_OK)
    status = add_vertices(parts, &taken);
  if (status == CONIC_OK)
    status = add_normals(parts, &taken);
  if (status == CONIC_OK && taken.n_triangles)
    status = add_triangles(parts, &taken);
  release_part(parts->context, &taken);
  return status;
}

conic_status conic_assimp_parts_end(conic_assimp_part_builder *parts) {
  conic_splats *points = &parts->builder.model->points;
  if (!parts->has_normals)
    return CONIC_OK;
  conic_status status = conic_builder_add_field(&parts->builder, CONIC_SPLATS_NORMALS);
  for (size_t i = 0; status == CONIC_OK && i < points->count; i++) {
    conic_normalize(parts->normals[i]);
    for (int axis = 0; axis < 3; axis++)
      points->normal[axis][i] = (float)parts->normals[i][axis];
  }
  return status;
}
