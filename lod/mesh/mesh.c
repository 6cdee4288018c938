/* Which faces of a mesh lie side by side, and meshes with one index a corner. */
#include "lod/mesh/mesh.h"

#include "core/base/radix.h"
#include "core/base/random.h"
#include "core/base/vectors.h"
#include "core/estimate/places.h"

static const uint32_t none = UINT32_MAX;

/* --- vertices that lie in one place --- */

static int is_finite_vertex(const conic_mesh *mesh, size_t i) {
  float zero = (mesh->position[0][i] * 0.0f + mesh->position[1][i] * 0.0f) + mesh->position[2][i] * 0.0f;
  return zero == 0.0f;
}

static conic_status weld(conic_context *context, const conic_mesh *mesh, conic_adjacency *adjacency) {
  conic_status status = conic_places_find(context, mesh->position, mesh->n_vertices, adjacency->place);
  for (size_t i = 0; i < mesh->n_vertices && status == CONIC_OK; i++) {
    if (!is_finite_vertex(mesh, i))
      adjacency->place[i] = (uint32_t)i;
    adjacency->oddities.welded += adjacency->place[i] != i;
  }
  return status;
}

/* --- faces of use --- */

static void look_at_faces(const conic_mesh *mesh, conic_adjacency *adjacency) {
  for (size_t i = 0; i < mesh->n_faces; i++) {
    const uint32_t *face = mesh->faces[i];
    int is_finite =
        is_finite_vertex(mesh, face[0]) && is_finite_vertex(mesh, face[1]) && is_finite_vertex(mesh, face[2]);
    uint32_t a = adjacency->place[face[0]], b = adjacency->place[face[1]], c = adjacency->place[face[2]];
    int is_three = a != b && b != c && c != a;
    adjacency->oddities.nan += !is_finite;
    adjacency->oddities.zero += is_finite && !is_three;
    adjacency->side[i] = (int8_t)(is_finite && is_three);
  }
}

/* --- edges --- */

typedef struct edge_list {
  size_t n;
  conic_radix_item *items; /* key: the two places, the lesser first; value: 3 · face + the corner where it begins */
} edge_list;

static conic_status list_edges(conic_context *context, const conic_mesh *mesh, const conic_adjacency *adjacency,
                               edge_list *edges) {
  int bits = conic_bits_below(mesh->n_vertices);
  edges->n = 0;
  edges->items = conic_memory_allocate(context, mesh->n_faces, 3 * sizeof *edges->items);
  if (!edges->items)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < mesh->n_faces; i++)
    for (int corner = 0; corner < 3 && adjacency->side[i]; corner++) {
      uint64_t a = adjacency->place[mesh->faces[i][corner]], b = adjacency->place[mesh->faces[i][(corner + 1) % 3]];
      uint64_t key = a < b ? a << bits | b : b << bits | a;
      edges->items[edges->n++] = (conic_radix_item){key, (uint32_t)(3 * i + (size_t)corner)};
    }
  return conic_radix_sort(context, edges->items, edges->n, 2 * bits);
}

static double edge_length(const conic_mesh *mesh, uint32_t half_edge) {
  double a[3], b[3];
  conic_mesh_corner(mesh, half_edge / 3, (int)(half_edge % 3), a);
  conic_mesh_corner(mesh, half_edge / 3, (int)(half_edge + 1) % 3, b);
  for (int axis = 0; axis < 3; axis++)
    b[axis] -= a[axis];
  return conic_length(b);
}

static uint32_t start_of(const conic_mesh *mesh, const conic_adjacency *adjacency, uint32_t half_edge) {
  return adjacency->place[mesh->faces[half_edge / 3][half_edge % 3]];
}

/* The faces of an edge are joined one to the next. Where there are more than two, every other joint has no length, so
 * that no cluster's outline becomes shorter than nothing. A face has each edge once. */
static void join_edges(const conic_mesh *mesh, const edge_list *edges, conic_adjacency *adjacency) {
  for (size_t begin = 0, end; begin < edges->n; begin = end) {
    for (end = begin + 1; end < edges->n && edges->items[end].key == edges->items[begin].key;)
      end++;
    adjacency->oddities.open += end == begin + 1;
    adjacency->oddities.crowded += end > begin + 2;
    double length = edge_length(mesh, edges->items[begin].value);
    for (size_t i = begin; i + 1 < end; i++) {
      conic_joint *joint = &adjacency->joints[adjacency->n_joints++];
      joint->faces[0] = edges->items[i].value / 3;
      joint->faces[1] = edges->items[i + 1].value / 3;
      joint->length = (i - begin) % 2 ? 0.0 : length;
    }
  }
}

/* --- orientation --- */

typedef struct orienting {
  const conic_mesh *mesh;
  conic_adjacency *adjacency;
  uint32_t *queue;
  uint8_t *is_seen;
} orienting;

static void pair_up(const conic_mesh *mesh, const edge_list *edges, conic_adjacency *adjacency) {
  memset(adjacency->across, 0xFF, mesh->n_faces * 3 * sizeof *adjacency->across);
  for (size_t begin = 0, end; begin < edges->n; begin = end) {
    for (end = begin + 1; end < edges->n && edges->items[end].key == edges->items[begin].key;)
      end++;
    for (size_t i = begin; i < end && end > begin + 2; i++)
      adjacency->across[edges->items[i].value] = CONIC_CROWDED_EDGE;
    if (end != begin + 2)
      continue;
    adjacency->across[edges->items[begin].value] = edges->items[begin + 1].value;
    adjacency->across[edges->items[begin + 1].value] = edges->items[begin].value;
  }
}

/* Whether both faces run along the edge in the same direction: then one of them is wound against the other. */
static int runs_along(const orienting *o, uint32_t half_edge) {
  return start_of(o->mesh, o->adjacency, half_edge) == start_of(o->mesh, o->adjacency, o->adjacency->across[half_edge]);
}

/* Gives the faces that hang together with `first` their sides: most of them keep theirs. */
static void orient_piece(orienting *o, uint32_t first) {
  int8_t *side = o->adjacency->side;
  size_t n = 1, n_turned = 0;
  o->queue[0] = first;
  o->is_seen[first] = 1;
  for (size_t next = 0; next < n; next++) {
    uint32_t face = o->queue[next];
    n_turned += side[face] < 0;
    for (uint32_t half = 3 * face; half < 3 * face + 3; half++) {
      uint32_t across = o->adjacency->across[half], other = across / 3;
      if (!conic_edge_is_shared(across))
        continue;
      int8_t wanted = (int8_t)(runs_along(o, half) ? -side[face] : side[face]);
      if (o->is_seen[other]) {
        o->adjacency->oddities.twisted += side[other] != wanted && half < across;
        continue;
      }
      o->is_seen[other] = 1;
      side[other] = wanted;
      o->queue[n++] = other;
    }
  }
  int is_other_way = 2 * n_turned > n;
  for (size_t i = 0; i < n && is_other_way; i++)
    side[o->queue[i]] = (int8_t)-side[o->queue[i]];
  o->adjacency->oddities.turned += is_other_way ? n - n_turned : n_turned;
  o->adjacency->oddities.n_pieces++;
}

static conic_status orient(conic_context *context, const conic_mesh *mesh, conic_adjacency *adjacency) {
  orienting o = {mesh, adjacency, conic_memory_allocate(context, mesh->n_faces, sizeof *o.queue),
                 conic_memory_allocate_zeroed(context, mesh->n_faces, sizeof *o.is_seen)};
  conic_status status = o.queue && o.is_seen ? CONIC_OK : CONIC_ERROR_MEMORY;
  for (uint32_t i = 0; i < mesh->n_faces && status == CONIC_OK; i++)
    if (adjacency->side[i] && !o.is_seen[i])
      orient_piece(&o, i);
  conic_memory_release_these(context, o.is_seen, o.queue);
  return status;
}

conic_status conic_adjacency_find(conic_context *context, const conic_mesh *mesh, conic_adjacency *adjacency) {
  edge_list edges = {0};
  memset(adjacency, 0, sizeof *adjacency);
  if (mesh->n_faces > UINT32_MAX / 3 || mesh->n_vertices > UINT32_MAX / 2)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "%zu triangles are too many", mesh->n_faces);
  conic_status status = conic_memory_allocate_these(
      context, CONIC_ROOM(adjacency->place, mesh->n_vertices), CONIC_ROOM(adjacency->side, mesh->n_faces),
      CONIC_ROOM(adjacency->across, 3 * mesh->n_faces), CONIC_ROOM(adjacency->joints, 3 * mesh->n_faces));
  if (status == CONIC_OK)
    status = weld(context, mesh, adjacency);
  if (status == CONIC_OK) {
    look_at_faces(mesh, adjacency);
    status = list_edges(context, mesh, adjacency, &edges);
  }
  if (status == CONIC_OK) {
    join_edges(mesh, &edges, adjacency);
    pair_up(mesh, &edges, adjacency);
    status = orient(context, mesh, adjacency);
  }
  conic_memory_release(context, edges.items);
  if (status != CONIC_OK)
    conic_adjacency_release(context, adjacency);
  return status;
}

void conic_adjacency_release(conic_context *context, conic_adjacency *adjacency) {
  conic_memory_release_these(context, adjacency->place, adjacency->side, adjacency->across, adjacency->joints);
  memset(adjacency, 0, sizeof *adjacency);
}

/* --- one index a corner --- */

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
  if (conic_memory_allocate_these(f->context, CONIC_ROOM(f->wedges, n), CONIC_ROOM(f->table, room)) != CONIC_OK)
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
      flat->material = conic_memory_copy(context, mesh->material, mesh->count * sizeof *flat->material);
      status = flat->material ? CONIC_OK : CONIC_ERROR_MEMORY;
    }
  }
  conic_memory_release_these(context, f.wedges, f.table, corners);
  if (status != CONIC_OK)
    conic_triangles_release(context, flat);
  return status;
}

/* --- faces and normals --- */

static int is_apart(float *const position[3], uint32_t a, uint32_t b) {
  for (int axis = 0; axis < 3; axis++)
    if (position[axis][a] != position[axis][b])
      return 1;
  return 0;
}

int conic_has_face(float *const position[3], const uint32_t (*corners)[3], size_t count) {
  for (size_t i = 0; i < count; i++) {
    const uint32_t *c = corners[i];
    int is_finite = 1;
    for (int corner = 0; corner < 3; corner++)
      for (int axis = 0; axis < 3; axis++)
        is_finite &= position[axis][c[corner]] - position[axis][c[corner]] == 0.0f;
    if (is_finite && is_apart(position, c[0], c[1]) && is_apart(position, c[1], c[2]) && is_apart(position, c[2], c[0]))
      return 1;
  }
  return 0;
}

conic_status conic_mesh_round(conic_context *context, int is_smooth, double crease_deg, conic_triangles *triangles) {
  if (is_smooth)
    return conic_triangles_smooth(context, triangles);
  return crease_deg > 0.0 && !triangles->normal[0] ? conic_triangles_crease(context, triangles, crease_deg) : CONIC_OK;
}
