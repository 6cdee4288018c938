/* From a mesh to a hybrid model: flat, who beside whom, clusters, ways to draw each, all in one piece of memory. */
#include <math.h>
#include <string.h>
#include <time.h>

#include "core/color.h"
#include "core/memory.h"
#include "core/message.h"
#include "core/texture.h"
#include "lod/flat_mesh.h"
#include "lod/hybrid_layout.h"
#include "lod/hybrid_levels.h"
#include "lod/hybrid_tree.h"

static double seconds_now(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

void conic_hybrid_options_init(conic_hybrid_options *options) {
  memset(options, 0, sizeof *options);
  options->size = sizeof *options;
  options->phase1 = 0.12;
  options->phase2 = 0.4;
  options->density = 2.0;
  options->cutoff = 1.5f;
}

typedef struct building {
  conic_context *context;
  const conic_hybrid_options *options;
  conic_triangles flat;
  conic_adjacency adjacency;
  conic_mesh_clusters clusters;
  conic_patch_mesh mesh;
  uint32_t *faces;
  size_t *starts;
  conic_patch_ways *ways;
  uint32_t *local; /* of each vertex: its number in the level that is being listed, else none */
  conic_chy_header header;
  conic_chy_layout layout;
  unsigned char *bytes;
  float *reach;
  conic_hybrid_report *report;
} building;

static void release(building *b) {
  for (size_t i = 0; b->ways && i < b->clusters.n_clusters; i++)
    conic_patch_ways_release(b->context, &b->ways[i]);
  conic_memory_release(b->context, b->ways);
  conic_memory_release(b->context, b->faces);
  conic_memory_release(b->context, b->starts);
  conic_memory_release(b->context, b->local);
  conic_memory_release(b->context, b->reach);
  conic_mesh_clusters_release(b->context, &b->clusters);
  conic_adjacency_release(b->context, &b->adjacency);
  b->flat.materials = NULL; /* lent by the mesh */
  b->flat.n_materials = 0;
  conic_triangles_release(b->context, &b->flat);
}

/* --- clusters --- */

/* Where none is given, a share that has some 2000 faces if they are of one size; of small meshes a fiftieth. */
static double most_area_of(const building *b) {
  double share = 2000.0 / (double)b->flat.count;
  return b->options->most_area > 0.0 ? b->options->most_area : share < 0.02 ? share : 0.02;
}

static conic_status find_clusters(building *b) {
  const conic_clustering_options options = {b->options->phase1, b->options->phase2, most_area_of(b)};
  conic_patch_mesh *mesh = &b->mesh;
  mesh->triangles = &b->flat;
  mesh->mesh = (conic_mesh){.n_vertices = b->flat.n_vertices,
                            .n_faces = b->flat.count,
                            .position = {b->flat.position[0], b->flat.position[1], b->flat.position[2]},
                            .faces = (const uint32_t(*)[3])b->flat.corners};
  mesh->adjacency = &b->adjacency;
  mesh->clusters = &b->clusters;
  conic_status status = conic_adjacency_find(b->context, &mesh->mesh, &b->adjacency);
  if (status == CONIC_OK)
    status = conic_mesh_clusters_find(b->context, &mesh->mesh, &b->adjacency, &options, &b->clusters);
  if (status == CONIC_OK && b->clusters.n_clusters == 0)
    status = conic_fail(b->context, CONIC_ERROR_INPUT, "the mesh has no face that could be drawn");
  return status;
}

/* A counting sort of the faces by cluster. */
static void sort_faces(building *b) {
  const uint32_t *of_face = b->clusters.of_face;
  memset(b->starts, 0, (b->clusters.n_clusters + 2) * sizeof *b->starts);
  for (size_t i = 0; i < b->flat.count; i++)
    if (of_face[i] != CONIC_NO_CLUSTER)
      b->starts[of_face[i] + 2]++;
  for (size_t i = 0; i < b->clusters.n_clusters; i++)
    b->starts[i + 2] += b->starts[i + 1];
  for (size_t i = 0; i < b->flat.count; i++)
    if (of_face[i] != CONIC_NO_CLUSTER)
      b->faces[b->starts[of_face[i] + 1]++] = (uint32_t)i;
  b->mesh.faces = b->faces;
  b->mesh.starts = b->starts;
}

/* Numbers the clusters as the hierarchy has them: near each other where they are near. */
static conic_status order_clusters(building *b) {
  size_t n = b->clusters.n_clusters;
  conic_hybrid_bound *bounds = conic_memory_allocate(b->context, n, sizeof *bounds);
  uint32_t *order = conic_memory_allocate(b->context, n, sizeof *order);
  uint32_t *rank = conic_memory_allocate(b->context, n, sizeof *rank);
  uint8_t *is_gathered = conic_memory_allocate(b->context, n, 1);
  conic_status status = bounds && order && rank && is_gathered ? CONIC_OK : CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < n && status == CONIC_OK; i++)
    bounds[i] = conic_patch_bound(&b->mesh, (uint32_t)i);
  if (status == CONIC_OK)
    status = conic_hybrid_order(b->context, bounds, n, order);
  if (status == CONIC_OK) {
    memcpy(is_gathered, b->clusters.is_gathered, n);
    for (size_t i = 0; i < n; i++) {
      rank[order[i]] = (uint32_t)i;
      b->clusters.is_gathered[i] = is_gathered[order[i]];
    }
    for (size_t i = 0; i < b->flat.count; i++)
      if (b->clusters.of_face[i] != CONIC_NO_CLUSTER)
        b->clusters.of_face[i] = rank[b->clusters.of_face[i]];
    sort_faces(b);
  }
  conic_memory_release(b->context, is_gathered);
  conic_memory_release(b->context, rank);
  conic_memory_release(b->context, order);
  conic_memory_release(b->context, bounds);
  return status;
}

static conic_status make_patches(building *b) {
  size_t n = b->clusters.n_clusters;
  b->faces = conic_memory_allocate(b->context, b->flat.count, sizeof *b->faces);
  b->starts = conic_memory_allocate(b->context, n + 2, sizeof *b->starts);
  b->ways = conic_memory_allocate_zeroed(b->context, n, sizeof *b->ways);
  b->local = conic_memory_allocate(b->context, b->flat.n_vertices, sizeof *b->local);
  b->reach = conic_memory_allocate_zeroed(b->context, n, sizeof *b->reach);
  if (!b->faces || !b->starts || !b->ways || !b->local || !b->reach)
    return CONIC_ERROR_MEMORY;
  memset(b->local, 0xFF, b->flat.n_vertices * sizeof *b->local);
  sort_faces(b);
  return order_clusters(b);
}

/* --- sizes --- */

/* How many vertices so many triangles have. */
static size_t list_vertices(building *b, const uint32_t (*corners)[3], size_t n, uint32_t *listed,
                            uint32_t (*local_corners)[3]) {
  size_t n_listed = 0;
  for (size_t i = 0; i < n; i++)
    for (int corner = 0; corner < 3; corner++) {
      uint32_t vertex = corners[i][corner];
      if (b->local[vertex] == UINT32_MAX) {
        listed[n_listed] = vertex;
        b->local[vertex] = (uint32_t)n_listed++;
      }
      local_corners[i][corner] = b->local[vertex];
    }
  for (size_t i = 0; i < n_listed; i++)
    b->local[listed[i]] = UINT32_MAX;
  return n_listed;
}

static void count_patch(building *b, uint32_t patch) {
  const conic_patch_ways *ways = &b->ways[patch];
  conic_chy_header *h = &b->header;
  h->n_triangles += b->starts[patch + 1] - b->starts[patch];
  for (int i = 0; i < ways->triangles.n; i++)
    h->n_triangles += ways->triangles.levels[i].n;
  for (int i = 0; i < ways->n_surfels; i++)
    h->n_surfels += ways->surfels[i].n;
  h->n_levels += (uint64_t)(1 + ways->triangles.n + ways->n_surfels);
}

static void measure_box(const building *b, conic_chy_header *h) {
  for (int axis = 0; axis < 3; axis++) {
    h->low[axis] = HUGE_VALF;
    h->high[axis] = -HUGE_VALF;
  }
  for (size_t i = 0; i < b->starts[b->clusters.n_clusters]; i++)
    for (int corner = 0; corner < 3; corner++)
      for (int axis = 0; axis < 3; axis++) {
        float at = b->flat.position[axis][b->flat.corners[b->faces[i]][corner]];
        h->low[axis] = at < h->low[axis] ? at : h->low[axis];
        h->high[axis] = at > h->high[axis] ? at : h->high[axis];
      }
}

/* The list of vertices is as long as three times the triangles at first, and cut afterwards. */
static conic_status allocate_body(building *b) {
  conic_chy_header *h = &b->header;
  memcpy(h->origin, b->flat.origin, sizeof h->origin);
  h->version = CONIC_CHY_VERSION;
  h->cutoff = b->options->cutoff;
  h->n_vertices = b->flat.n_vertices;
  h->n_patches = b->clusters.n_clusters;
  h->n_nodes = conic_hybrid_count_nodes(b->clusters.n_clusters);
  h->n_materials = b->flat.n_materials;
  h->flags = (b->flat.normal[0] ? CONIC_CHY_NORMALS : 0u) | (b->flat.color[0] ? CONIC_CHY_COLORS : 0u) |
             (b->flat.texture_coordinate[0] ? CONIC_CHY_TEXTURE_COORDINATES : 0u) |
             (b->flat.material && b->flat.n_materials ? CONIC_CHY_MATERIALS : 0u);
  for (size_t i = 0; i < b->flat.n_materials; i++) {
    const conic_texture *texture = b->flat.materials[i].texture;
    if (texture)
      h->n_texels += (uint64_t)texture->levels[0].width * (uint64_t)texture->levels[0].height;
  }
  for (uint32_t i = 0; i < b->clusters.n_clusters; i++)
    count_patch(b, i);
  if (h->n_triangles > UINT32_MAX / 4 || h->n_surfels > UINT32_MAX / 4 || h->n_texels > UINT32_MAX / 4)
    return conic_fail(b->context, CONIC_ERROR_ARGUMENT, "the model's triangles, surfels or textures are too many");
  measure_box(b, h);
  return CONIC_OK;
}

/* --- the body --- */

static void *array_at(building *b, int i) {
  return b->bytes + b->layout.arrays[i].offset;
}

typedef struct cursor {
  size_t level, triangle, listed, surfel;
} cursor;

static void put_triangles(building *b, cursor *at, const uint32_t (*corners)[3], const uint32_t *faces, size_t n,
                          double error) {
  conic_hybrid_level *levels = array_at(b, CONIC_CHY_LEVELS);
  uint32_t(*local)[3] = array_at(b, CONIC_CHY_CORNERS), *listed = array_at(b, CONIC_CHY_LISTED);
  uint32_t *material = array_at(b, CONIC_CHY_MATERIAL_OF);
  conic_hybrid_level *level = &levels[at->level++];
  memset(level, 0, sizeof *level);
  level->kind = CONIC_HYBRID_TRIANGLES;
  level->first = (uint32_t)at->triangle;
  level->count = (uint32_t)n;
  level->first_vertex = (uint32_t)at->listed;
  level->n_vertices = (uint32_t)list_vertices(b, corners, n, listed + at->listed, local + at->triangle);
  level->error = (float)(error * (1.0 + 1e-6));
  for (size_t i = 0; i < n && b->header.flags & CONIC_CHY_MATERIALS; i++)
    material[at->triangle + i] = b->flat.material[faces[i]];
  at->triangle += n;
  at->listed += level->n_vertices;
}

static void put_surfels(building *b, cursor *at, const conic_surfels *surfels) {
  conic_hybrid_level *levels = array_at(b, CONIC_CHY_LEVELS);
  conic_hybrid_level *level = &levels[at->level++];
  memset(level, 0, sizeof *level);
  level->kind = CONIC_HYBRID_SURFELS;
  level->first = (uint32_t)at->surfel;
  level->count = (uint32_t)surfels->n;
  level->error = (float)(surfels->error * (1.0 + 1e-6));
  level->reach = (float)(surfels->reach * (1.0 + 1e-6));
  for (int k = 0; k < 12; k++) {
    float *values = array_at(b, CONIC_CHY_SURFELS + k);
    for (size_t i = 0; i < surfels->n; i++) {
      const conic_surfel *s = &surfels->items[i];
      const float *part = k < 3 ? s->position : k < 6 ? s->tangent_u : k < 9 ? s->tangent_v : s->color;
      values[at->surfel + i] = part[k % 3];
    }
  }
  at->surfel += surfels->n;
}

/* The first level of triangles is the patch's faces themselves. */
static void put_patch(building *b, cursor *at, uint32_t i, uint32_t (*corners)[3]) {
  conic_hybrid_patch *patches = array_at(b, CONIC_CHY_PATCHES);
  const conic_patch_ways *ways = &b->ways[i];
  size_t n = b->starts[i + 1] - b->starts[i];
  patches[i] = (conic_hybrid_patch){.bound = conic_patch_bound(&b->mesh, i),
                                    .area = (float)ways->area,
                                    .first_level = (uint32_t)at->level,
                                    .n_levels = (uint32_t)(1 + ways->triangles.n + ways->n_surfels)};
  patches[i].built = b->clusters.is_gathered[i] && ways->n_surfels ? (uint32_t)(1 + ways->triangles.n) : 0;
  for (size_t k = 0; k < n; k++)
    memcpy(corners[k], b->flat.corners[b->faces[b->starts[i] + k]], sizeof *corners);
  put_triangles(b, at, (const uint32_t(*)[3])corners, b->faces + b->starts[i], n, 0.0);
  for (int k = 0; k < ways->triangles.n; k++) {
    const conic_patch_level *level = &ways->triangles.levels[k];
    put_triangles(b, at, (const uint32_t(*)[3])level->corners, level->face, level->n, level->error);
  }
  for (int k = 0; k < ways->n_surfels; k++) {
    put_surfels(b, at, &ways->surfels[k]);
    float reach = (float)(ways->surfels[k].reach * (1.0 + 1e-6));
    b->reach[i] = reach > b->reach[i] ? reach : b->reach[i];
  }
}

static void put_vertices(building *b) {
  size_t n_bytes = b->flat.n_vertices * sizeof(float);
  for (int axis = 0; axis < 3; axis++) {
    memcpy(array_at(b, CONIC_CHY_POSITION + axis), b->flat.position[axis], n_bytes);
    if (b->flat.normal[0])
      memcpy(array_at(b, CONIC_CHY_NORMAL + axis), b->flat.normal[axis], n_bytes);
    if (b->flat.color[0])
      memcpy(array_at(b, CONIC_CHY_COLOR + axis), b->flat.color[axis], n_bytes);
  }
  for (int k = 0; k < 2 && b->flat.texture_coordinate[0]; k++)
    memcpy(array_at(b, CONIC_CHY_TEXTURE + k), b->flat.texture_coordinate[k], n_bytes);
}

static void put_materials(building *b) {
  conic_chy_material *list = array_at(b, CONIC_CHY_MATERIAL_LIST);
  unsigned char *codes = array_at(b, CONIC_CHY_TEXELS);
  float thresholds[255];
  uint64_t n_texels = 0;
  conic_srgb_thresholds(thresholds);
  for (size_t i = 0; i < b->flat.n_materials; i++) {
    const conic_material *from = &b->flat.materials[i];
    memset(&list[i], 0, sizeof list[i]);
    memcpy(list[i].color, from->color, sizeof from->color);
    list[i].first_texel = n_texels;
    if (!from->texture)
      continue;
    const conic_texture_level *level = &from->texture->levels[0];
    list[i].width = (uint32_t)level->width;
    list[i].height = (uint32_t)level->height;
    list[i].wrap = (uint32_t)from->texture->wrap;
    for (size_t k = 0; k < (size_t)level->width * (size_t)level->height; k++, n_texels++)
      for (size_t channel = 0; channel < 3; channel++)
        codes[3 * n_texels + channel] = conic_srgb_code(thresholds, level->texels[4 * k + channel]);
  }
}

/* The surfels as built, for the scale of the automatic ε. */
static conic_status measure_surfels(building *b) {
  const conic_hybrid_patch *patches = array_at(b, CONIC_CHY_PATCHES);
  const conic_hybrid_level *levels = array_at(b, CONIC_CHY_LEVELS);
  conic_splats built;
  size_t n = 0, at = 0;
  for (size_t i = 0; i < b->header.n_patches; i++)
    n += patches[i].built ? levels[patches[i].first_level + patches[i].built].count : 0;
  conic_status status = conic_splats_allocate(b->context, n, CONIC_SPLATS_TANGENTS, &built);
  for (size_t i = 0; i < b->header.n_patches && status == CONIC_OK; i++) {
    const conic_hybrid_level *level = &levels[patches[i].first_level + patches[i].built];
    if (!patches[i].built)
      continue;
    for (int axis = 0; axis < 3; axis++) {
      const float *p = array_at(b, CONIC_CHY_SURFELS + axis), *u = array_at(b, CONIC_CHY_SURFELS + 3 + axis);
      const float *v = array_at(b, CONIC_CHY_SURFELS + 6 + axis);
      memcpy(built.position[axis] + at, p + level->first, level->count * sizeof(float));
      memcpy(built.tangent_u[axis] + at, u + level->first, level->count * sizeof(float));
      memcpy(built.tangent_v[axis] + at, v + level->first, level->count * sizeof(float));
    }
    at += level->count;
  }
  if (status == CONIC_OK)
    status = conic_splats_length(b->context, &built, &b->header.splat_length);
  conic_splats_release(b->context, &built);
  return status;
}

static conic_status fill_body(building *b) {
  cursor at = {0};
  size_t most = 0;
  for (size_t i = 0; i < b->clusters.n_clusters; i++)
    most = b->starts[i + 1] - b->starts[i] > most ? b->starts[i + 1] - b->starts[i] : most;
  uint32_t(*corners)[3] = conic_memory_allocate(b->context, most, sizeof *corners);
  if (!corners)
    return CONIC_ERROR_MEMORY;
  for (uint32_t i = 0; i < b->clusters.n_clusters; i++)
    put_patch(b, &at, i, corners);
  conic_memory_release(b->context, corners);
  put_vertices(b);
  put_materials(b);
  conic_hybrid_fill_nodes(array_at(b, CONIC_CHY_PATCHES), b->reach, b->clusters.n_clusters,
                          array_at(b, CONIC_CHY_NODES));
  return measure_surfels(b);
}

/* How long the list of vertices is shows only when it is made; so it is counted first. */
static conic_status count_listed(building *b) {
  size_t most = 0;
  for (size_t i = 0; i < b->clusters.n_clusters; i++)
    most = b->starts[i + 1] - b->starts[i] > most ? b->starts[i + 1] - b->starts[i] : most;
  uint32_t(*corners)[3] = conic_memory_allocate(b->context, most, sizeof *corners);
  uint32_t(*local)[3] = conic_memory_allocate(b->context, most, sizeof *local);
  uint32_t *listed = conic_memory_allocate(b->context, most, 3 * sizeof *listed);
  conic_status status = corners && local && listed ? CONIC_OK : CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < b->clusters.n_clusters && status == CONIC_OK; i++) {
    const conic_patch_levels *simpler = &b->ways[i].triangles;
    size_t n = b->starts[i + 1] - b->starts[i];
    for (size_t k = 0; k < n; k++)
      memcpy(corners[k], b->flat.corners[b->faces[b->starts[i] + k]], sizeof *corners);
    b->header.n_listed += list_vertices(b, (const uint32_t(*)[3])corners, n, listed, local);
    for (int k = 0; k < simpler->n; k++)
      b->header.n_listed +=
          list_vertices(b, (const uint32_t(*)[3])simpler->levels[k].corners, simpler->levels[k].n, listed, local);
  }
  conic_memory_release(b->context, listed);
  conic_memory_release(b->context, local);
  conic_memory_release(b->context, corners);
  return status;
}

static conic_status make_hybrid(building *b, conic_hybrid **hybrid) {
  conic_status status = allocate_body(b);
  if (status == CONIC_OK)
    status = count_listed(b);
  if (status != CONIC_OK)
    return status;
  b->layout = conic_chy_lay_out(&b->header);
  b->bytes = conic_memory_allocate_zeroed(b->context, b->layout.n_bytes, 1);
  conic_hybrid *made = conic_memory_allocate_zeroed(b->context, 1, sizeof *made);
  *hybrid = made;
  if (!b->bytes || !made) {
    conic_memory_release(b->context, b->bytes);
    return CONIC_ERROR_MEMORY;
  }
  made->context = b->context;
  made->owned = b->bytes;
  status = fill_body(b);
  conic_chy_attach(&b->header, b->bytes, made);
  return status == CONIC_OK ? conic_chy_make_materials(made) : status;
}

/* --- */

static void report_oddities(building *b, const conic_triangles *mesh) {
  const conic_mesh_oddities *o = &b->adjacency.oddities;
  conic_hybrid_report *r = b->report;
  r->n_faces = mesh->count;
  r->nan = o->nan;
  r->zero = o->zero;
  r->welded = o->welded;
  r->open = o->open;
  r->crowded = o->crowded;
  r->twisted = o->twisted;
  r->turned = o->turned;
  r->n_pieces = o->n_pieces;
  r->n_first = b->clusters.n_first;
}

static conic_status check_options(conic_context *context, const conic_hybrid_options *o) {
  int is_good = o->phase1 - o->phase1 == 0.0 && o->phase2 - o->phase2 == 0.0 && o->most_area >= 0.0 &&
                o->density > 0.0 && o->density <= 1024.0 && o->cutoff >= 0.25f && o->cutoff <= 5.0f &&
                (o->sampling == CONIC_SAMPLING_BLUE || o->sampling == CONIC_SAMPLING_BOX);
  return is_good ? CONIC_OK
                 : conic_fail(context, CONIC_ERROR_ARGUMENT, "an option of the hybrid model is out of range");
}

static conic_status build(building *b, conic_triangles *mesh, conic_hybrid **hybrid) {
  double start = seconds_now();
  conic_status status = conic_flat_mesh(b->context, mesh, &b->flat);
  if (status != CONIC_OK)
    return status;
  b->flat.n_materials = mesh->n_materials;
  b->flat.materials = mesh->materials;
  status = find_clusters(b);
  if (status == CONIC_OK)
    status = make_patches(b);
  if (status != CONIC_OK)
    return status;
  report_oddities(b, mesh);
  b->report->cluster_seconds = seconds_now() - start;
  conic_ways_job ways = {.context = b->context, .mesh = &b->mesh, .options = b->options, .ways = b->ways};
  status = conic_find_ways(&ways);
  b->report->sample_seconds = ways.sample_seconds;
  b->report->simplify_seconds = ways.simplify_seconds;
  return status == CONIC_OK ? make_hybrid(b, hybrid) : status;
}

conic_status conic_hybrid_build(conic_context *context, conic_triangles *mesh, const conic_hybrid_options *options,
                                conic_hybrid **hybrid, conic_hybrid_report *report) {
  conic_hybrid_report ignored;
  building b = {.context = context, .options = options, .report = report ? report : &ignored};
  *hybrid = NULL;
  memset(b.report, 0, sizeof *b.report);
  conic_status status = check_options(context, options);
  if (status == CONIC_OK)
    status = conic_triangles_check(context, mesh, "the mesh");
  if (status == CONIC_OK)
    status = build(&b, mesh, hybrid);
  release(&b);
  conic_triangles_release(context, mesh);
  if (status != CONIC_OK) {
    conic_hybrid_destroy(*hybrid);
    *hybrid = NULL;
  }
  return status;
}
