#include "source/top_mesh.h"

#include <string.h>

#include "core/base/memory.h"
#include "core/splats/columns.h"

void conic_top_mesh_release(conic_context *context, conic_top_mesh *mesh) {
  for (int i = 0; i < 3; i++)
    conic_memory_release_these(context, mesh->triangles.position[i], mesh->corners[i]);
  conic_memory_release(context, mesh->material);
  memset(mesh, 0, sizeof *mesh);
}

/* Makes room for all triangles, once. */
static conic_status begin_mesh(conic_context *context, const conic_triangles *from, conic_top_mesh *mesh) {
  conic_triangles *to = &mesh->triangles;
  uint32_t(*const wanted[3])[3] = {from->corners, from->normal_corners, from->texture_corners};
  int is_whole = 1;
  if (mesh->corners[0])
    return CONIC_OK;
  *to = *from;
  memset(to->origin, 0, sizeof to->origin);
  to->strides.position = 0;
  to->cluster = NULL;
  for (int i = 0; i < 3; i++) {
    to->position[i] = conic_memory_allocate_zeroed(context, from->n_vertices, sizeof(float));
    mesh->corners[i] = wanted[i] ? conic_memory_allocate(context, from->count, sizeof **wanted) : NULL;
    is_whole &= to->position[i] && (mesh->corners[i] || !wanted[i]);
  }
  mesh->material = from->material ? conic_memory_allocate(context, from->count, sizeof *from->material) : NULL;
  to->corners = mesh->corners[0];
  to->normal_corners = mesh->corners[1];
  to->texture_corners = mesh->corners[2];
  to->material = mesh->material;
  return is_whole && (mesh->material || !from->material) ? CONIC_OK : CONIC_ERROR_MEMORY;
}

static void place_vertex(const conic_top_place *place, const conic_triangles *from, size_t i, double p[3]) {
  for (int axis = 0; axis < 3; axis++)
    p[axis] = from->origin[axis] + (double)conic_column_at(from->position[axis], from->strides.position, i) -
              place->origin[axis];
}

/* Whether a triangle may show; triangles that are not finite do not. */
static int reaches_in(const conic_top_place *place, const double corner[3][3]) {
  const double low[3] = {place->low[0], place->low[1], place->heights[0] - place->origin[2]};
  const double high[3] = {place->high[0], place->high[1], place->heights[1] - place->origin[2]};
  for (int axis = 0; axis < 3; axis++) {
    const double a = corner[0][axis], b = corner[1][axis], c = corner[2][axis];
    if (!(a >= low[axis] || b >= low[axis] || c >= low[axis]) ||
        !(a <= high[axis] || b <= high[axis] || c <= high[axis]) || !(a + b + c - (a + b + c) == 0.0))
      return 0;
  }
  return 1;
}

static void lift_vertex(const conic_top_place *place, const double p[3], conic_triangles *to, size_t i) {
  double share = (place->distance - p[2]) / place->distance;
  to->position[0][i] = (float)(p[0] * share);
  to->position[1][i] = (float)(p[1] * share);
  to->position[2][i] = (float)p[2];
}

conic_status conic_top_mesh_lift(conic_context *context, const conic_top_place *place, const conic_triangles *from,
                                 conic_top_mesh *mesh) {
  conic_triangles *to = &mesh->triangles;
  conic_status status = begin_mesh(context, from, mesh);
  to->count = 0;
  for (size_t i = 0; i < from->count && status == CONIC_OK; i++) {
    double corner[3][3];
    for (int k = 0; k < 3; k++)
      place_vertex(place, from, from->corners[i][k], corner[k]);
    if (!reaches_in(place, (const double(*)[3])corner))
      continue;
    for (int k = 0; k < 3; k++)
      lift_vertex(place, corner[k], to, from->corners[i][k]);
    memcpy(to->corners[to->count], from->corners[i], sizeof *to->corners);
    if (to->normal_corners)
      memcpy(to->normal_corners[to->count], from->normal_corners[i], sizeof *to->corners);
    if (to->texture_corners)
      memcpy(to->texture_corners[to->count], from->texture_corners[i], sizeof *to->corners);
    if (to->material)
      to->material[to->count] = from->material[i];
    to->count++;
  }
  return status;
}
