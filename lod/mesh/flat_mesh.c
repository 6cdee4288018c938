/* Turns meshes whose attributes have indices of their own into ones with one index a corner. */
#include "lod/mesh/mesh.h"

#include <string.h>

#include "core/base/memory.h"
#include "core/base/message.h"
#include "core/base/radix.h"
#include "core/base/random.h"

static const uint32_t none = UINT32_MAX;

typedef struct wedge {
  uint32_t vertex, normal, texture;
} wedge;

typedef struct flattening {
  conic_context *context;
  const conic_triangles *mesh;
  size_t n_wedges;
  wedge *wedges;
  uint32_t *table; /* wedges by hash */
  size_t table_mask;
} flattening;

static wedge wedge_at(const conic_triangles *mesh, size_t i, int corner) {
  uint32_t vertex = mesh->corners[i][corner];
  return (wedge){vertex, mesh->normal_corners ? mesh->normal_corners[i][corner] : vertex,
                 mesh->texture_corners ? mesh->texture_corners[i][corner] : vertex};
}

/* The number of a wedge, which is a new one where it is not known yet. */
static uint32_t number_of(flattening *f, wedge w) {
  uint64_t hash = conic_random_bits((uint64_t)w.vertex << 32 | w.normal, w.texture, 0);
  size_t slot = (size_t)hash & f->table_mask;
  while (f->table[slot] != none && memcmp(&f->wedges[f->table[slot]], &w, sizeof w) != 0)
    slot = (slot + 1) & f->table_mask;
  if (f->table[slot] == none) {
    f->table[slot] = (uint32_t)f->n_wedges;
    f->wedges[f->n_wedges++] = w;
  }
  return f->table[slot];
}

static void copy_attributes(const flattening *f, conic_triangles *flat) {
  const conic_triangles *mesh = f->mesh;
  memcpy(flat->origin, mesh->origin, sizeof flat->origin);
  for (size_t i = 0; i < f->n_wedges; i++) {
    const wedge *w = &f->wedges[i];
    for (int axis = 0; axis < 3; axis++) {
      flat->position[axis][i] = mesh->position[axis][w->vertex];
      if (flat->normal[0])
        flat->normal[axis][i] = mesh->normal[axis][w->normal];
      if (flat->color[0])
        flat->color[axis][i] = mesh->color[axis][w->vertex];
    }
    for (int k = 0; k < 2 && flat->texture_coordinate[0]; k++)
      flat->texture_coordinate[k][i] = mesh->texture_coordinate[k][w->texture];
  }
}

static conic_status number_wedges(flattening *f, uint32_t (*corners)[3]) {
  size_t n = 3 * f->mesh->count, room = (size_t)1 << (conic_bits_below(n) + 1);
  f->wedges = conic_memory_allocate(f->context, n, sizeof *f->wedges);
  f->table = conic_memory_allocate(f->context, room, sizeof *f->table);
  if (!f->wedges || !f->table)
    return CONIC_ERROR_MEMORY;
  f->table_mask = room - 1;
  memset(f->table, 0xFF, room * sizeof *f->table);
  for (size_t i = 0; i < f->mesh->count; i++)
    for (int corner = 0; corner < 3; corner++)
      corners[i][corner] = number_of(f, wedge_at(f->mesh, i, corner));
  return CONIC_OK;
}

conic_status conic_flat_mesh(conic_context *context, const conic_triangles *mesh, conic_triangles *flat) {
  flattening f = {.context = context, .mesh = mesh};
  unsigned fields = (mesh->color[0] ? CONIC_TRIANGLES_COLORS : 0u) | (mesh->normal[0] ? CONIC_TRIANGLES_NORMALS : 0u) |
                    (mesh->texture_coordinate[0] ? CONIC_TRIANGLES_TEXTURE_COORDINATES : 0u);
  memset(flat, 0, sizeof *flat);
  if (mesh->count > UINT32_MAX / 6)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "%zu triangles are too many", mesh->count);
  uint32_t(*corners)[3] = conic_memory_allocate(context, mesh->count, sizeof *corners);
  conic_status status = corners ? number_wedges(&f, corners) : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK)
    status = conic_triangles_allocate(context, mesh->count, f.n_wedges, fields, flat);
  if (status == CONIC_OK) {
    memcpy(flat->corners, corners, mesh->count * sizeof *corners);
    copy_attributes(&f, flat);
    if (mesh->material) {
      flat->material = conic_memory_allocate(context, mesh->count, sizeof *flat->material);
      status = flat->material ? CONIC_OK : CONIC_ERROR_MEMORY;
      if (status == CONIC_OK)
        memcpy(flat->material, mesh->material, mesh->count * sizeof *flat->material);
    }
  }
  conic_memory_release_these(context, f.wedges, f.table, corners);
  if (status != CONIC_OK)
    conic_triangles_release(context, flat);
  return status;
}
