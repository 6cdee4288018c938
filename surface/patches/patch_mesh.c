/* The corners of a mesh by their places, and by the sides of its creases there. */

#include "surface/patches/patch_mesh.h"
#include "core/base/vectors.h"
#include "core/estimate/neighbourhood.h"

/* A vertex of more corners gets no patch: each would have to look at all others. */
enum { MOST_CORNERS = 64 };

/* Normals of one vertex with a lesser cosine are two; a triangle with a lesser one to a vertex's normal is steep. */
static const double SAME_NORMAL = 0.9998, STEEP = 0.5;

/* From a vertex to the next the normal turns by no more than 30°: a polynomial would swing about a surface that turns
 * faster. */
static const double LEAST_TURN = 0.866;

static int read_normal(const conic_triangles *t, uint32_t triangle, int k, double normal[3]) {
  size_t at = t->normal_corners ? t->normal_corners[triangle][k] : t->corners[triangle][k];
  for (int axis = 0; axis < 3; axis++)
    normal[axis] = (double)t->normal[axis][at];
  return conic_normalize(normal);
}

int conic_patch_mesh_corner(const conic_patch_mesh *mesh, uint32_t number, conic_patch_corner *c) {
  const conic_triangles *t = mesh->triangles;
  uint32_t triangle = number / 3;
  for (int i = 0; i < 3; i++) {
    int k = (int)(number + (uint32_t)i - 3 * triangle) % 3;
    c->slots[i] = mesh->slots[t->corners[triangle][k]];
    for (int axis = 0; axis < 3; axis++)
      c->offsets[i][axis] = (double)t->position[axis][t->corners[triangle][k]] -
                            (double)t->position[axis][t->corners[triangle][number % 3]];
    if (!read_normal(t, triangle, k, c->normals[i]))
      return 0;
  }
  conic_cross(c->offsets[1], c->offsets[2], c->across);
  double sign = conic_dot(c->across, c->normals[0]) < 0.0 ? -1.0 : 1.0;
  for (int axis = 0; axis < 3; axis++)
    c->across[axis] *= sign;
  return conic_normalize(c->across);
}

/* --- sides of creases --- */

/* Brings corners of one normal together, in the order of their first ones. Returns how many normals there are. */
static int group_corners(const conic_patch_mesh *mesh, size_t slot) {
  uint32_t *corners = mesh->corners + mesh->starts[slot], sorted[MOST_CORNERS];
  size_t n = mesh->starts[slot + 1] - mesh->starts[slot], n_sorted = 0;
  int n_sides = 0, is_taken[MOST_CORNERS] = {0};
  conic_patch_corner first, c;
  for (size_t i = 0; i < n; i++) {
    if (is_taken[i])
      continue;
    conic_patch_mesh_corner(mesh, corners[i], &first);
    n_sides++;
    for (size_t j = i; j < n; j++)
      if (j == i || (!is_taken[j] && conic_patch_mesh_corner(mesh, corners[j], &c) &&
                     conic_dot(first.normals[0], c.normals[0]) >= SAME_NORMAL)) {
        is_taken[j] = 1;
        sorted[n_sorted++] = corners[j];
      }
  }
  memcpy(corners, sorted, n * sizeof *corners);
  return n_sides;
}

size_t conic_patch_mesh_side_end(const conic_patch_mesh *mesh, size_t begin, size_t end) {
  conic_patch_corner first, c;
  size_t at = begin + 1;
  conic_patch_mesh_corner(mesh, mesh->corners[begin], &first);
  while (at < end && conic_patch_mesh_corner(mesh, mesh->corners[at], &c) &&
         conic_dot(first.normals[0], c.normals[0]) >= SAME_NORMAL)
    at++;
  return at;
}

int conic_patch_mesh_bound_side(const conic_patch_mesh *mesh, size_t begin, size_t end, uint32_t rays[2],
                                int others[2]) {
  conic_patch_corner c, d;
  int n_rays = 0;
  for (size_t i = begin; i < end; i++) {
    if (!conic_patch_mesh_corner(mesh, mesh->corners[i], &c) || !(conic_dot(c.normals[0], c.across) >= STEEP))
      return -1;
    for (int k = 1; k < 3; k++) {
      int n_same = 0;
      for (size_t j = begin; j < end; j++)
        if (conic_patch_mesh_corner(mesh, mesh->corners[j], &d))
          n_same += (d.slots[1] == c.slots[k]) + (d.slots[2] == c.slots[k]);
      if (n_same > 2 || c.slots[k] == CONIC_NO_SLOT || !(conic_dot(c.normals[0], c.normals[k]) >= LEAST_TURN) ||
          (n_same == 1 && n_rays == 2))
        return -1;
      if (n_same == 1) {
        rays[n_rays] = mesh->corners[i];
        others[n_rays++] = k;
      }
    }
  }
  return n_rays == 1 ? -1 : n_rays;
}

static void find_sides(void *data, size_t begin, size_t end) {
  const conic_patch_mesh *mesh = data;
  for (size_t slot = begin; slot < end; slot++) {
    size_t n = mesh->starts[slot + 1] - mesh->starts[slot];
    uint32_t rays[2];
    int others[2], n_sides = n > 0 && n <= MOST_CORNERS ? group_corners(mesh, slot) : 0, is_sound = n_sides < UINT8_MAX;
    size_t at = mesh->starts[slot];
    for (int i = 0; i < n_sides && is_sound; i++) {
      size_t side_end = conic_patch_mesh_side_end(mesh, at, mesh->starts[slot + 1]);
      int n_rays = conic_patch_mesh_bound_side(mesh, at, side_end, rays, others);
      is_sound = n_rays >= 0;
      mesh->is_smooth[slot] |= n_sides == 1 && n_rays == 0;
      at = side_end;
    }
    mesh->n_sides[slot] = (uint8_t)(is_sound ? n_sides : 0);
  }
}

/* A counting sort, as of vertices' triangles. */
static void sort_corners(conic_patch_mesh *mesh, size_t n_slots) {
  const conic_triangles *t = mesh->triangles;
  for (size_t i = 0; i < 3 * t->count; i++) {
    uint32_t slot = mesh->slots[t->corners[i / 3][i % 3]];
    if (slot != CONIC_NO_SLOT)
      mesh->starts[slot + 2]++;
  }
  for (size_t slot = 0; slot < n_slots; slot++)
    mesh->starts[slot + 2] += mesh->starts[slot + 1];
  for (size_t i = 0; i < 3 * t->count; i++) {
    uint32_t slot = mesh->slots[t->corners[i / 3][i % 3]];
    if (slot != CONIC_NO_SLOT)
      mesh->corners[mesh->starts[slot + 1]++] = (uint32_t)i;
  }
}

typedef struct slot_search {
  const conic_patch_mesh *mesh;
  const conic_neighbours *tree;
  double shift[3], limit2;
} slot_search;

static void find_slots(void *data, size_t begin, size_t end) {
  const slot_search *search = data;
  for (size_t i = begin; i < end; i++) {
    double place[3], distance2;
    for (int axis = 0; axis < 3; axis++)
      place[axis] = (double)search->mesh->triangles->position[axis][i] + search->shift[axis];
    if (!conic_neighbours_nearest(search->tree, place, CONIC_NO_SLOT, 1, search->limit2, &search->mesh->slots[i],
                                  &distance2))
      search->mesh->slots[i] = CONIC_NO_SLOT;
  }
}

conic_status conic_patch_mesh_create(conic_context *context, const conic_triangles *triangles,
                                     const conic_neighbours *tree, const double origin[3], conic_patch_mesh *mesh) {
  slot_search search = {mesh, tree, {0.0}, 0.0};
  *mesh = (conic_patch_mesh){.triangles = triangles};
  if (!triangles || triangles->count >= UINT32_MAX / 3)
    return CONIC_OK;
  if (conic_memory_allocate_these(
          context, CONIC_ROOM(mesh->slots, triangles->n_vertices), CONIC_ZEROED(mesh->starts, tree->n_slots + 2),
          CONIC_ROOM(mesh->corners, 3 * triangles->count), CONIC_ZEROED(mesh->is_smooth, tree->n_slots),
          CONIC_ZEROED(mesh->n_sides, tree->n_slots)) != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  for (int axis = 0; axis < 3; axis++) {
    double side = (double)tree->boxes[0][3 + axis] - (double)tree->boxes[0][axis];
    search.shift[axis] = triangles->origin[axis] - origin[axis];
    search.limit2 += 1e-13 * side * side; /* files are rebased to one origin */
  }
  conic_status status = conic_slots_for(context, triangles->n_vertices, find_slots, &search, 0.0, 0.0);
  if (status != CONIC_OK)
    return status;
  sort_corners(mesh, tree->n_slots);
  return triangles->normal[0] ? conic_slots_for(context, tree->n_slots, find_sides, mesh, 0.0, 0.0) : CONIC_OK;
}

void conic_patch_mesh_release(conic_context *context, conic_patch_mesh *mesh) {
  conic_memory_release_these(context, mesh->slots, mesh->starts, mesh->corners, mesh->is_smooth, mesh->n_sides);
}
