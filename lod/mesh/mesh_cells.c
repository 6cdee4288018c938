#include "lod/mesh/mesh_cells.h"

#include "core/base/radix.h"
#include "core/base/real.h"
#include "core/base/vectors.h"
#include "core/files/disk.h"
#include "core/files/pile.h"
#include "core/formats/model_read.h"

/* Faces that are looked at together, and that a cell gathers before they go to the disk; of all about so many tell
 * where the planes are. */
enum { FACES_AT_ONCE = 1 << 16, FACES_A_BLOCK = 1 << 10, SAMPLES = 1 << 20, FILTER_BITS = 24, MOST_DEPTH = 48 };

/* A place where a face of a cell has a corner that lies in another one. */
typedef struct shared_place {
  uint32_t at[3]; /* the bits of its floats */
  uint32_t cell;
} shared_place;

/* Faces that wait; and where those lie that went. A cell has two: of its own, and those beside it. */
typedef struct face_bucket {
  uint32_t (*faces)[3];
  size_t n, n_blocks, blocks_room;
  uint64_t *blocks;
} face_bucket;

struct conic_mesh_cells {
  conic_context *context;
  conic_scratch vertices, faces;
  conic_pile buckets_file;
  conic_mesh_counts counts;
  double origin[3];
  int has_normals, has_colors, is_begun;
  size_t stride; /* floats a vertex */
  const float *map;
  size_t map_bytes;
  size_t n_nodes, nodes_room, n_cells;
  conic_cell_node *nodes;
  size_t most_faces;
  size_t n_shared, shared_room;
  shared_place *shared;
  uint8_t *filter; /* bits of hashes of shared places */
  face_bucket *buckets;
};

void conic_mesh_cells_release(conic_mesh_cells *c) {
  if (!c)
    return;
  for (size_t i = 0; c->buckets && i < 2 * c->n_cells; i++) {
    conic_memory_release_these(c->context, c->buckets[i].faces, c->buckets[i].blocks);
  }
  if (c->map)
    conic_disk_unmap((void *)c->map, c->map_bytes);
  conic_scratch_close(&c->vertices);
  conic_scratch_close(&c->faces);
  conic_pile_end(&c->buckets_file);
  conic_memory_release_these(c->context, c->buckets, c->filter, c->shared, c->nodes);
  conic_memory_release(c->context, c);
}

size_t conic_mesh_cells_count(const conic_mesh_cells *c) {
  return c->n_cells;
}

const conic_cell_node *conic_mesh_cells_tree(const conic_mesh_cells *c) {
  return c->nodes;
}

conic_mesh_counts conic_mesh_cells_counts(const conic_mesh_cells *c) {
  return c->counts;
}

/* --- to the disk --- */

static conic_status receive_vertices(void *cookie, const conic_splats *batch) {
  conic_mesh_cells *c = cookie;
  if (!c->is_begun) {
    c->is_begun = 1;
    memcpy(c->origin, batch->origin, sizeof c->origin);
    c->has_normals = batch->normal[0] != NULL;
    c->has_colors = batch->color[0] != NULL;
    c->stride = 3 + (c->has_normals ? 3u : 0u) + (c->has_colors ? 3u : 0u);
  }
  float *records = conic_memory_allocate(c->context, batch->count, c->stride * sizeof *records);
  if (!records)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < batch->count; i++) {
    float *to = records + i * c->stride;
    for (int axis = 0; axis < 3; axis++)
      *to++ = batch->position[axis][i];
    for (int axis = 0; axis < 3 && c->has_normals; axis++)
      *to++ = batch->normal[axis][i];
    for (int channel = 0; channel < 3 && c->has_colors; channel++)
      *to++ = batch->color[channel][i];
  }
  size_t n_bytes = c->stride * sizeof *records;
  conic_status status =
      conic_scratch_write(&c->vertices, c->counts.n_vertices * n_bytes, records, batch->count * n_bytes);
  c->counts.n_vertices += batch->count;
  conic_memory_release(c->context, records);
  return status;
}

static conic_status receive_faces(void *cookie, const uint32_t (*corners)[3], size_t n) {
  conic_mesh_cells *c = cookie;
  conic_status status =
      conic_scratch_write(&c->faces, c->counts.n_faces * sizeof *corners, corners, n * sizeof *corners);
  c->counts.n_faces += n;
  return status;
}

static conic_status spool_mesh(conic_mesh_cells *c, const char *mesh, const char *path) {
  conic_status status = conic_scratch_open(c->context, path, &c->vertices);
  if (status == CONIC_OK)
    status = conic_scratch_open(c->context, path, &c->faces);
  if (status == CONIC_OK)
    status = conic_pile_begin(c->context, path, &c->buckets_file);
  if (status == CONIC_OK)
    status = conic_mesh_stream(c->context, mesh, receive_vertices, receive_faces, c);
  if (status == CONIC_OK && (c->counts.n_faces == 0 || c->counts.n_vertices == 0))
    status = conic_fail(c->context, CONIC_ERROR_INPUT, "%s: the mesh has no face that could be drawn", mesh);
  if (status != CONIC_OK)
    return status;
  c->map_bytes = c->counts.n_vertices * c->stride * sizeof *c->map;
  c->map = conic_disk_map(c->vertices.descriptor, c->map_bytes);
  return c->map ? CONIC_OK : conic_fail(c->context, CONIC_ERROR_IO, "%s: cannot map a temporary file beside it", path);
}

/* --- all faces --- */

static const float *position_of(const conic_mesh_cells *c, uint32_t vertex) {
  return c->map + (size_t)vertex * c->stride;
}

static void find_center(const conic_mesh_cells *c, const uint32_t corners[3], float center[3]) {
  for (int axis = 0; axis < 3; axis++)
    center[axis] =
        (position_of(c, corners[0])[axis] + position_of(c, corners[1])[axis] + position_of(c, corners[2])[axis]) / 3.0f;
}

static uint32_t cell_at(const conic_mesh_cells *c, const float at[3]) {
  uint32_t i = 0;
  while (c->nodes[i].above)
    i = at[c->nodes[i].axis] < c->nodes[i].at ? i + 1 : c->nodes[i].above;
  return c->nodes[i].cell;
}

typedef conic_status see_face(conic_mesh_cells *c, const uint32_t corners[3]);

/* What of the map was looked at is given back, so that it does not count as this program's memory. */
static conic_status for_faces(conic_mesh_cells *c, see_face *see, double from, double to) {
  uint32_t(*faces)[3] = conic_memory_allocate(c->context, FACES_AT_ONCE, sizeof *faces);
  conic_status status = faces ? CONIC_OK : CONIC_ERROR_MEMORY;
  for (size_t first = 0, n; first < c->counts.n_faces && status == CONIC_OK; first += n) {
    n = c->counts.n_faces - first < FACES_AT_ONCE ? c->counts.n_faces - first : FACES_AT_ONCE;
    status = conic_scratch_read(&c->faces, first * sizeof *faces, faces, n * sizeof *faces);
    for (size_t i = 0; i < n && status == CONIC_OK; i++)
      status = see(c, faces[i]);
    conic_disk_give_back((void *)c->map, c->map_bytes);
    if (status == CONIC_OK)
      status = conic_progress(c->context, "part", from + (to - from) * (double)(first + n) / (double)c->counts.n_faces);
  }
  conic_memory_release(c->context, faces);
  return status;
}

/* --- planes --- */

typedef struct cell_samples {
  float (*at)[3];
  size_t n;
  double faces_each; /* for how many faces one stands */
} cell_samples;

CONIC_DEFINE_ORDER_OF(compare_floats, float)

/* The middle along the longest axis; 0 where all lie at one place. */
static int find_cell_plane(float (*at)[3], size_t n, float *sorted, conic_cell_node *plane) {
  float widest = 0.0f;
  for (int axis = 0; axis < 3; axis++) {
    float low = at[0][axis], high = at[0][axis];
    for (size_t i = 1; i < n; i++)
      CONIC_WIDEN(low, high, at[i][axis], at[i][axis]);
    if (high - low > widest) {
      widest = high - low;
      plane->axis = axis;
      plane->at = low;
    }
  }
  if (!(widest > 0.0f))
    return 0;
  float lowest = plane->at;
  for (size_t i = 0; i < n; i++)
    sorted[i] = at[i][plane->axis];
  qsort(sorted, n, sizeof *sorted, compare_floats);
  size_t middle = n / 2;
  while (middle + 1 < n && !(sorted[middle] > lowest)) /* so that something lies below */
    middle++;
  plane->at = sorted[middle];
  return 1;
}

static conic_status grow_tree(conic_mesh_cells *c, float (*at)[3], size_t n, double faces_each, float *sorted,
                              int depth) {
  conic_cell_node plane = {.cell = 0};
  size_t own = c->n_nodes, n_below = 0;
  conic_status status = conic_memory_append(c->context, &c->nodes, &c->n_nodes, &c->nodes_room, &plane, sizeof plane);
  if (status != CONIC_OK)
    return status;
  if ((double)n * faces_each <= (double)c->most_faces || n < 2 || depth == MOST_DEPTH ||
      !find_cell_plane(at, n, sorted, &plane)) {
    c->nodes[own].cell = (uint32_t)c->n_cells++;
    return CONIC_OK;
  }
  c->nodes[own] = plane;
  for (size_t i = 0; i < n; i++)
    if (at[i][plane.axis] < plane.at) {
      float swapped[3];
      memcpy(swapped, at[i], sizeof swapped);
      memcpy(at[i], at[n_below], sizeof swapped);
      memcpy(at[n_below++], swapped, sizeof swapped);
    }
  status = grow_tree(c, at, n_below, faces_each, sorted, depth + 1);
  c->nodes[own].above = (uint32_t)c->n_nodes;
  if (status == CONIC_OK)
    status = grow_tree(c, at + n_below, n - n_below, faces_each, sorted, depth + 1);
  return status;
}

/* By the centres of some faces, those of finite ones. */
static conic_status find_tree(conic_mesh_cells *c) {
  size_t step = c->counts.n_faces / SAMPLES + 1, n = 0, n_most = c->counts.n_faces / step + 1;
  float(*at)[3] = conic_memory_allocate(c->context, n_most, sizeof *at);
  float *sorted = conic_memory_allocate(c->context, n_most, sizeof *sorted);
  conic_status status = at && sorted ? CONIC_OK : CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < c->counts.n_faces && status == CONIC_OK; i += step) {
    uint32_t corners[3];
    status = conic_scratch_read(&c->faces, i * sizeof corners, corners, sizeof corners);
    if (status == CONIC_OK) {
      find_center(c, corners, at[n]);
      n += conic_is_finite((double)at[n][0]) && conic_is_finite((double)at[n][1]) && conic_is_finite((double)at[n][2]);
    }
    if (n % FACES_AT_ONCE == 0)
      conic_disk_give_back((void *)c->map, c->map_bytes);
  }
  if (status == CONIC_OK)
    status = grow_tree(c, at, n, (double)step, sorted, 0);
  conic_memory_release_these(c->context, sorted, at);
  return status;
}

/* --- what cells share --- */

static shared_place shared_place_at(const float at[3], uint32_t cell) {
  shared_place place = {.cell = cell};
  for (int axis = 0; axis < 3; axis++)
    place.at[axis] = conic_bits_of_float(at[axis] + 0.0f); /* no negative zero */
  return place;
}

static size_t hash_place(const shared_place *place) {
  uint64_t h = place->at[0] * UINT64_C(0x9E3779B97F4A7C15);
  h = (h ^ (h >> 29) ^ place->at[1]) * UINT64_C(0xBF58476D1CE4E5B9);
  h = (h ^ (h >> 32) ^ place->at[2]) * UINT64_C(0x94D049BB133111EB);
  return (size_t)(h >> (64 - FILTER_BITS));
}

static int compare_shared(const void *a, const void *b) {
  const shared_place *first = a, *second = b;
  for (int axis = 0; axis < 3; axis++)
    if (first->at[axis] != second->at[axis])
      return first->at[axis] < second->at[axis] ? -1 : 1;
  return (first->cell > second->cell) - (first->cell < second->cell);
}

/* Each is there once. */
static void sort_shared(conic_mesh_cells *c) {
  size_t n = 0;
  if (c->n_shared > 0)
    qsort(c->shared, c->n_shared, sizeof *c->shared, compare_shared);
  for (size_t i = 0; i < c->n_shared; i++)
    if (n == 0 || compare_shared(&c->shared[i], &c->shared[n - 1]) != 0)
      c->shared[n++] = c->shared[i];
  c->n_shared = n;
}

static int is_one_place(const float *a, const float *b) {
  return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

static void count_oddity(conic_mesh_cells *c, const uint32_t corners[3]) {
  const float *at[3] = {position_of(c, corners[0]), position_of(c, corners[1]), position_of(c, corners[2])};
  int is_finite = 1;
  for (int k = 0; k < 9; k++)
    is_finite &= conic_is_finite((double)at[k / 3][k % 3]);
  c->counts.nan += !is_finite;
  c->counts.zero +=
      is_finite && (is_one_place(at[0], at[1]) || is_one_place(at[1], at[2]) || is_one_place(at[2], at[0]));
}

/* Notes the corners of a face that lie in other cells than it does. */
static conic_status see_shared(conic_mesh_cells *c, const uint32_t corners[3]) {
  float center[3];
  count_oddity(c, corners);
  find_center(c, corners, center);
  uint32_t cell = cell_at(c, center);
  for (int k = 0; k < 3; k++) {
    const float *at = position_of(c, corners[k]);
    if (cell_at(c, at) == cell)
      continue;
    const shared_place place = shared_place_at(at, cell);
    if (conic_memory_append(c->context, &c->shared, &c->n_shared, &c->shared_room, &place, sizeof place) != CONIC_OK)
      return CONIC_ERROR_MEMORY;
    size_t hash = hash_place(&place);
    c->filter[hash / 8] |= (uint8_t)(1u << hash % 8);
  }
  return CONIC_OK;
}

/* --- buckets --- */

static conic_status empty_bucket(conic_mesh_cells *c, face_bucket *b) {
  uint64_t at;
  conic_status status = conic_pile_append(&c->buckets_file, b->faces, b->n * sizeof *b->faces, &at);
  b->n = 0;
  return status == CONIC_OK ? conic_memory_append(c->context, &b->blocks, &b->n_blocks, &b->blocks_room, &at, sizeof at)
                            : status;
}

static conic_status put_face(conic_mesh_cells *c, size_t bucket, const uint32_t corners[3]) {
  face_bucket *b = &c->buckets[bucket];
  if (!b->faces)
    b->faces = conic_memory_allocate(c->context, FACES_A_BLOCK, sizeof *b->faces);
  if (!b->faces)
    return CONIC_ERROR_MEMORY;
  memcpy(b->faces[b->n++], corners, sizeof *b->faces);
  return b->n == FACES_A_BLOCK ? empty_bucket(c, b) : CONIC_OK;
}

static void add_cell(uint32_t *cells, size_t *n, size_t most, uint32_t own, uint32_t cell) {
  for (size_t i = 0; i < *n; i++)
    if (cells[i] == cell)
      return;
  if (cell != own && *n < most)
    cells[(*n)++] = cell;
}

/* The other cells that have a corner at a place of the face: where the place lies, and those that are noted with it. */
enum { MOST_BESIDE = 64 };

static size_t cells_beside(const conic_mesh_cells *c, const uint32_t corners[3], uint32_t own,
                           uint32_t cells[MOST_BESIDE]) {
  size_t n = 0;
  for (int k = 0; k < 3; k++) {
    const float *at = position_of(c, corners[k]);
    shared_place wanted = shared_place_at(at, 0);
    size_t hash = hash_place(&wanted), low = 0;
    if (!(c->filter[hash / 8] >> hash % 8 & 1))
      continue;
    CONIC_BISECT(low, c->n_shared, compare_shared(&c->shared[middle], &wanted) < 0);
    for (; low < c->n_shared && memcmp(c->shared[low].at, wanted.at, sizeof wanted.at) == 0; low++) {
      add_cell(cells, &n, MOST_BESIDE, own, c->shared[low].cell);
      add_cell(cells, &n, MOST_BESIDE, own, cell_at(c, at));
    }
  }
  return n;
}

static conic_status sort_face(conic_mesh_cells *c, const uint32_t corners[3]) {
  uint32_t cells[MOST_BESIDE];
  float center[3];
  find_center(c, corners, center);
  uint32_t own = cell_at(c, center);
  size_t n = cells_beside(c, corners, own, cells);
  conic_status status = put_face(c, 2 * (size_t)own, corners);
  for (size_t i = 0; i < n && status == CONIC_OK; i++)
    status = put_face(c, 2 * (size_t)cells[i] + 1, corners);
  return status;
}

static conic_status sort_faces_by_cell(conic_mesh_cells *c) {
  c->buckets = conic_memory_allocate_zeroed(c->context, 2 * c->n_cells, sizeof *c->buckets);
  return c->buckets ? for_faces(c, sort_face, 0.5, 1.0) : CONIC_ERROR_MEMORY;
}

conic_status conic_mesh_cells_find(conic_context *context, const char *mesh, const char *path, size_t most_faces,
                                   conic_mesh_cells **cells) {
  conic_mesh_cells *c = *cells = conic_memory_allocate_zeroed(context, 1, sizeof *c);
  if (!c)
    return CONIC_ERROR_MEMORY;
  c->context = context;
  c->most_faces = most_faces;
  c->vertices.descriptor = c->faces.descriptor = c->buckets_file.file.descriptor = -1;
  c->filter = conic_memory_allocate_zeroed(context, (size_t)1 << (FILTER_BITS - 3), 1);
  conic_status status = c->filter ? spool_mesh(c, mesh, path) : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK)
    status = find_tree(c);
  if (status == CONIC_OK)
    status = for_faces(c, see_shared, 0.0, 0.5);
  if (status != CONIC_OK)
    return status;
  sort_shared(c);
  status = sort_faces_by_cell(c);
  conic_scratch_close(&c->faces);
  return status;
}

/* --- a cell's mesh --- */

static size_t bucket_faces(const face_bucket *b) {
  return b->n_blocks * FACES_A_BLOCK + b->n;
}

static conic_status read_bucket(const conic_mesh_cells *c, const face_bucket *b, uint32_t (*to)[3]) {
  conic_status status = CONIC_OK;
  for (size_t i = 0; i < b->n_blocks && status == CONIC_OK; i++)
    status = conic_pile_read(&c->buckets_file, b->blocks[i], to[i * FACES_A_BLOCK], FACES_A_BLOCK * sizeof *to);
  if (b->n > 0)
    memcpy(to[b->n_blocks * FACES_A_BLOCK], b->faces, b->n * sizeof *to);
  return status;
}

/* Gives the corners numbers from 0 on, in the order of the mesh's, and lists these. */
static conic_status number_corners(conic_mesh_cells *c, uint32_t *corners, size_t n, uint32_t *listed,
                                   size_t *n_listed) {
  conic_radix_item *items = conic_memory_allocate(c->context, n, sizeof *items);
  if (!items)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < n; i++)
    items[i] = (conic_radix_item){corners[i], (uint32_t)i};
  conic_status status = conic_radix_sort(c->context, items, n, 32);
  *n_listed = 0;
  for (size_t i = 0; i < n && status == CONIC_OK; i++) {
    if (i == 0 || items[i].key != items[i - 1].key)
      listed[(*n_listed)++] = (uint32_t)items[i].key;
    corners[items[i].value] = (uint32_t)(*n_listed - 1);
  }
  conic_memory_release(c->context, items);
  return status;
}

static void copy_cell_vertices(const conic_mesh_cells *c, const uint32_t *listed, conic_triangles *mesh) {
  for (size_t i = 0; i < mesh->n_vertices; i++) {
    const float *from = position_of(c, listed[i]);
    for (int axis = 0; axis < 3; axis++)
      mesh->position[axis][i] = *from++;
    for (int axis = 0; axis < 3 && c->has_normals; axis++)
      mesh->normal[axis][i] = *from++;
    for (int channel = 0; channel < 3 && c->has_colors; channel++)
      mesh->color[channel][i] = *from++;
  }
  memcpy(mesh->origin, c->origin, sizeof mesh->origin);
  conic_disk_give_back((void *)c->map, c->map_bytes);
}

conic_status conic_mesh_cells_take(conic_mesh_cells *c, size_t cell, conic_triangles *mesh, size_t *n_own) {
  const face_bucket *own = &c->buckets[2 * cell];
  size_t n = bucket_faces(own) + bucket_faces(own + 1), n_listed = 0;
  unsigned fields = (c->has_normals ? CONIC_TRIANGLES_NORMALS : 0u) | (c->has_colors ? CONIC_TRIANGLES_COLORS : 0u);
  uint32_t(*corners)[3] = conic_memory_allocate(c->context, n, sizeof *corners);
  uint32_t *listed = conic_memory_allocate(c->context, 3 * n, sizeof *listed);
  conic_status status = corners && listed ? CONIC_OK : CONIC_ERROR_MEMORY;
  memset(mesh, 0, sizeof *mesh);
  *n_own = bucket_faces(own);
  if (status == CONIC_OK)
    status = read_bucket(c, own, corners);
  if (status == CONIC_OK)
    status = read_bucket(c, own + 1, corners + *n_own);
  if (status == CONIC_OK)
    status = number_corners(c, corners[0], 3 * n, listed, &n_listed);
  if (status == CONIC_OK)
    status = conic_triangles_allocate(c->context, n, n_listed, fields, mesh);
  if (status == CONIC_OK) {
    memcpy(mesh->corners, corners, n * sizeof *corners);
    copy_cell_vertices(c, listed, mesh);
  }
  conic_memory_release_these(c->context, corners, listed);
  return status;
}
