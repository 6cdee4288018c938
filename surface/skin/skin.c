#include "surface/skin/skin.h"

#include <string.h>

#include "core/base/memory.h"
#include "core/base/vectors.h"
#include "surface/skin/skin_search.h"

int conic_skin_ellipse(const conic_skin_search *search, uint32_t slot, double u[3], double v[3]) {
  const conic_splats *splats = search->splats;
  uint32_t splat = search->tree.point_of_slot[slot];
  for (int axis = 0; axis < 3; axis++) {
    u[axis] = (double)splats->tangent_u[axis][splat];
    v[axis] = (double)splats->tangent_v[axis][splat];
  }
  double uu = search->cutoff * conic_dot(u, u), vv = search->cutoff * conic_dot(v, v);
  int is_ellipse = uu > 0.0 && vv > 0.0 && uu < 1e300 && vv < 1e300;
  for (int axis = 0; axis < 3 && is_ellipse; axis++) {
    u[axis] /= uu;
    v[axis] /= vv;
  }
  return is_ellipse;
}

void conic_skin_place(const conic_skin_search *search, uint32_t slot, double place[3]) {
  for (int axis = 0; axis < 3; axis++)
    place[axis] = (double)search->tree.position[axis][slot];
}

void conic_skin_normal(const conic_skin_search *search, uint32_t slot, double normal[3]) {
  for (int axis = 0; axis < 3; axis++)
    normal[axis] = (double)search->normal[axis][slot];
}

static void find_own_normals(conic_skin_search *search) {
  const conic_splats *splats = search->splats;
  for (size_t slot = 0; slot < search->tree.n_slots; slot++) {
    uint32_t splat = search->tree.point_of_slot[slot];
    double u[3], v[3], normal[3];
    for (int axis = 0; axis < 3; axis++) {
      u[axis] = (double)splats->tangent_u[axis][splat];
      v[axis] = (double)splats->tangent_v[axis][splat];
    }
    conic_cross(u, v, normal);
    int is_of_use = conic_normalize(normal) && !(splats->dot && splats->dot[splat] != 0.0f);
    for (int axis = 0; axis < 3; axis++)
      search->normal[axis][slot] = is_of_use ? (float)normal[axis] : 0.0f;
  }
}

/* --- all --- */

static conic_status fill_skin(const conic_skin_search *search, conic_skin *skin) {
  conic_context *context = search->context;
  size_t n = search->splats->count;
  skin->n_triangles = search->n_triangles;
  skin->corners = conic_memory_allocate(context, search->n_triangles, sizeof *skin->corners);
  skin->is_inner = conic_memory_allocate_zeroed(context, n, 1);
  skin->normal = conic_memory_allocate_zeroed(context, n, sizeof *skin->normal);
  skin->color = conic_memory_allocate_zeroed(context, n, sizeof *skin->color);
  if (!skin->corners || !skin->is_inner || !skin->normal || !skin->color)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < search->n_triangles; i++)
    for (int k = 0; k < 3; k++)
      skin->corners[i][k] = search->tree.point_of_slot[search->triangles[i].slots[k]];
  for (size_t i = 0; i < n; i++) {
    uint32_t slot = search->tree.slot_of_point[i];
    skin->is_inner[i] = slot != CONIC_NO_SLOT && search->is_closed[slot];
  }
  conic_skin_look(search, skin);
  return CONIC_OK;
}

conic_status conic_skin_find(conic_context *context, const conic_splats *splats, double cutoff,
                               conic_skin *skin) {
  conic_skin_search search = {.context = context, .splats = splats, .cutoff = cutoff};
  const float *const positions[3] = {splats->position[0], splats->position[1], splats->position[2]};
  memset(skin, 0, sizeof *skin);
  conic_status status = conic_neighbours_build(context, positions, splats->count, &search.tree);
  if (status != CONIC_OK)
    return status;
  for (int axis = 0; axis < 3 && status == CONIC_OK; axis++) {
    search.normal[axis] = conic_memory_allocate(context, search.tree.n_slots, sizeof *search.normal[axis]);
    status = search.normal[axis] ? CONIC_OK : CONIC_ERROR_MEMORY;
  }
  if (status == CONIC_OK) {
    find_own_normals(&search);
    status = conic_skin_candidates(&search);
  }
  if (status == CONIC_OK)
    status = conic_skin_choose(&search);
  if (status == CONIC_OK)
    status = fill_skin(&search, skin);
  conic_memory_release(context, search.is_closed);
  conic_memory_release(context, search.triangles);
  for (int axis = 0; axis < 3; axis++)
    conic_memory_release(context, search.normal[axis]);
  conic_neighbours_release(context, &search.tree);
  if (status != CONIC_OK)
    conic_skin_release(context, skin);
  return status;
}

void conic_skin_release(conic_context *context, conic_skin *skin) {
  conic_memory_release(context, skin->corners);
  conic_memory_release(context, skin->is_inner);
  conic_memory_release(context, skin->normal);
  conic_memory_release(context, skin->color);
  memset(skin, 0, sizeof *skin);
}
