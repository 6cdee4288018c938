#include "surface/skin/skin.h"

#include <math.h>
#include <string.h>

#include "core/base/memory.h"
#include "core/base/vectors.h"
#include "surface/skin/skin_search.h"

int conic_skin_ellipse(const conic_skin_search *search, uint32_t slot, double u[3], double v[3]) {
  const conic_splats *splats = search->splats;
  uint32_t splat = search->tree.point_of_slot[slot];
  conic_vector_at(splats->tangent_u, splat, u);
  conic_vector_at(splats->tangent_v, splat, v);
  double uu = search->cutoff * conic_dot(u, u), vv = search->cutoff * conic_dot(v, v);
  int is_ellipse = uu > 0.0 && vv > 0.0 && uu < 1e300 && vv < 1e300;
  for (int axis = 0; axis < 3 && is_ellipse; axis++) {
    u[axis] /= uu;
    v[axis] /= vv;
  }
  return is_ellipse;
}

/* The unit normal of a splat that can be part of a surface; returns 0 for a dot, or a splat that spans no plane. */
static int find_splat_plane(const conic_splats *splats, size_t splat, double normal[3]) {
  double u[3], v[3];
  conic_vector_at(splats->tangent_u, splat, u);
  conic_vector_at(splats->tangent_v, splat, v);
  conic_cross(u, v, normal);
  return conic_normalize(normal) && !(splats->dot && splats->dot[splat] != 0.0f);
}

/* Builds the tree of splats that can be part of a surface; for the tree, the others have no position. */
static conic_status build_tree(conic_skin_search *search) {
  const conic_splats *splats = search->splats;
  size_t n = splats->count;
  float *places = conic_memory_allocate(search->context, n, 3 * sizeof *places);
  if (!places)
    return CONIC_ERROR_MEMORY;
  const float *const positions[3] = {places, places + n, places + 2 * n};
  for (size_t i = 0; i < n; i++) {
    double normal[3];
    int is_of_use = find_splat_plane(splats, i, normal);
    for (size_t axis = 0; axis < 3; axis++)
      places[axis * n + i] = is_of_use ? splats->position[axis][i] : NAN;
  }
  conic_status status = conic_neighbours_build(search->context, positions, n, &search->tree);
  conic_memory_release(search->context, places);
  return status;
}

static conic_status find_own_normals(conic_skin_search *search) {
  for (int axis = 0; axis < 3; axis++) {
    search->normal[axis] = conic_memory_allocate(search->context, search->tree.n_slots, sizeof *search->normal[axis]);
    if (!search->normal[axis])
      return CONIC_ERROR_MEMORY;
  }
  for (size_t slot = 0; slot < search->tree.n_slots; slot++) {
    double normal[3];
    find_splat_plane(search->splats, search->tree.point_of_slot[slot], normal);
    for (int axis = 0; axis < 3; axis++)
      search->normal[axis][slot] = (float)normal[axis];
  }
  return CONIC_OK;
}

/* Finds normals, colours and lifts; all later steps use these normals. */
static conic_status look_all_over(conic_skin_search *search, conic_skin *skin) {
  size_t n = search->splats->count;
  skin->normal = conic_memory_allocate_zeroed(search->context, n, sizeof *skin->normal);
  skin->color = conic_memory_allocate_zeroed(search->context, n, sizeof *skin->color);
  skin->lift = conic_memory_allocate_zeroed(search->context, n, sizeof *skin->lift);
  if (!skin->normal || !skin->color || !skin->lift)
    return CONIC_ERROR_MEMORY;
  conic_skin_look(search, skin);
  for (size_t slot = 0; slot < search->tree.n_slots; slot++)
    for (int axis = 0; axis < 3; axis++)
      search->normal[axis][slot] = skin->normal[search->tree.point_of_slot[slot]][axis];
  return CONIC_OK;
}

/* --- all --- */

static conic_status fill_skin(const conic_skin_search *search, conic_skin *skin) {
  conic_context *context = search->context;
  size_t n = search->splats->count;
  skin->n_triangles = search->n_triangles;
  skin->corners = conic_memory_allocate(context, search->n_triangles, sizeof *skin->corners);
  skin->is_inner = conic_memory_allocate_zeroed(context, n, 1);
  if (!skin->corners || !skin->is_inner)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < search->n_triangles; i++)
    for (int k = 0; k < 3; k++)
      skin->corners[i][k] = search->tree.point_of_slot[search->triangles[i].slots[k]];
  for (size_t i = 0; i < n; i++) {
    uint32_t slot = search->tree.slot_of_point[i];
    skin->is_inner[i] = slot != CONIC_NO_SLOT && search->is_closed[slot];
  }
  return CONIC_OK;
}

static void release_search(conic_skin_search *search) {
  conic_context *context = search->context;
  conic_memory_release_these(context, search->is_closed, search->heads, search->next, search->triangles);
  for (int axis = 0; axis < 3; axis++)
    conic_memory_release(context, search->normal[axis]);
  conic_neighbours_release(context, &search->tree);
}

conic_status conic_skin_find(conic_context *context, const conic_splats *splats, double cutoff, conic_skin *skin) {
  conic_skin_search search = {.context = context, .splats = splats, .cutoff = cutoff};
  memset(skin, 0, sizeof *skin);
  conic_status status = build_tree(&search);
  if (status == CONIC_OK)
    status = find_own_normals(&search);
  if (status == CONIC_OK)
    status = look_all_over(&search, skin);
  if (status == CONIC_OK)
    status = conic_skin_candidates(&search);
  if (status == CONIC_OK)
    status = conic_skin_choose(&search);
  if (status == CONIC_OK)
    status = conic_skin_fill(&search);
  if (status == CONIC_OK)
    status = conic_skin_finish(&search);
  if (status == CONIC_OK)
    status = fill_skin(&search, skin);
  release_search(&search);
  if (status != CONIC_OK)
    conic_skin_release(context, skin);
  return status;
}

void conic_skin_release(conic_context *context, conic_skin *skin) {
  conic_memory_release_these(context, skin->corners, skin->is_inner, skin->normal, skin->color, skin->lift);
  memset(skin, 0, sizeof *skin);
}
