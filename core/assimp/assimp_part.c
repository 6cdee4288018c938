#include "core/assimp/assimp_part.h"

#include "core/base/color.h"

float conic_assimp_decode(float value) {
  double code = 255.0 * (double)value, whole = code >= 0.0 && code <= 255.0 ? (double)(int)(code + 0.5) : -1.0;
  int is_code = code - whole < 1e-4 && whole - code < 1e-4; /* an 8-bit code before it became a float */
  return (float)conic_srgb_decode(is_code ? whole / 255.0 : (double)value);
}

/* Takes one of its arrays; null where there is none. */
static conic_status take_array(conic_assimp_process *process, int is_there, size_t n, size_t size, void *array) {
  void *bytes = is_there ? conic_memory_allocate(process->context, n, size) : NULL;
  memcpy(array, &bytes, sizeof bytes);
  if (!is_there)
    return CONIC_OK;
  return bytes ? conic_assimp_process_take(process, bytes, n * size) : CONIC_ERROR_MEMORY;
}

static conic_status take_vertices(conic_assimp_process *process, uint32_t fields, conic_mesh_part *part) {
  size_t n = part->n_vertices;
  conic_status status = take_array(process, 1, n, sizeof *part->position, &part->position);
  if (status == CONIC_OK)
    status = take_array(process, (fields & CONIC_ASSIMP_NORMALS) != 0, n, sizeof *part->normal, &part->normal);
  if (status == CONIC_OK)
    status =
        take_array(process, (fields & CONIC_ASSIMP_COORDINATES) != 0, n, sizeof *part->coordinate, &part->coordinate);
  if (status == CONIC_OK)
    status = take_array(process, (fields & CONIC_ASSIMP_COLORS) != 0, n, sizeof *part->color, &part->color);
  for (size_t i = 0; status == CONIC_OK && part->color && i < n; i++)
    for (int channel = 0; channel < 3; channel++)
      part->color[i][channel] = conic_assimp_decode(part->color[i][channel]);
  return status;
}

conic_status conic_assimp_take_part(conic_assimp_process *process, const conic_assimp_record *record,
                                    conic_mesh_parts *parts) {
  conic_mesh_part part = {.n_vertices = (size_t)record->n_vertices, .is_points = record->n_triangles == 0};
  uint32_t(*triangles)[3] = NULL;
  size_t n = (size_t)record->n_triangles;
  if (record->n_vertices < 1 || record->n_vertices > CONIC_MAX_POINTS ||
      record->n_triangles > SIZE_MAX / sizeof *triangles)
    return conic_fail(process->context, CONIC_ERROR_INPUT, "%s: there are no vertices, or too many", process->name);
  conic_status status = take_vertices(process, record->fields, &part);
  if (status == CONIC_OK)
    status = take_array(process, 1, n, sizeof *triangles, &triangles);
  if (parts->faces)
    parts->faces->current_material =
        record->i_material < parts->faces->n_made ? record->i_material : (uint32_t)parts->faces->n_made;
  if (status == CONIC_OK)
    status = conic_mesh_parts_add(parts, &part);
  if (status == CONIC_OK)
    status = conic_mesh_parts_add_triangles(parts, &part, (const uint32_t(*)[3])triangles, n);
  conic_mesh_part_release(parts->context, &part);
  conic_memory_release(parts->context, triangles);
  return status;
}
