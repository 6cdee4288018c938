#include "lod/hybrid/hybrid_pack.h"

#include <math.h>
#include <string.h>

#include "core/base/color.h"
#include "core/base/memory.h"
#include "core/base/message.h"
#include "core/image/texture_levels.h"
#include "lod/hybrid/hybrid_layout.h"

typedef struct packing {
  const conic_ways_job *job;
  const conic_clustered_mesh *mesh; /* the job's */
  const conic_triangles *flat;      /* the same mesh */
  size_t n_clusters;
  uint32_t *local; /* of each vertex: its number in the level that is being listed, else none */
  conic_chy_header header;
  conic_file_layout layout;
  unsigned char *bytes;
} packing;

/* --- sizes --- */

/* How many vertices so many triangles have. */
static size_t list_vertices(packing *p, const uint32_t (*corners)[3], size_t n, uint32_t *listed,
                            uint32_t (*local_corners)[3]) {
  size_t n_listed = 0;
  for (size_t i = 0; i < n; i++)
    for (int corner = 0; corner < 3; corner++) {
      uint32_t vertex = corners[i][corner];
      if (p->local[vertex] == UINT32_MAX) {
        listed[n_listed] = vertex;
        p->local[vertex] = (uint32_t)n_listed++;
      }
      local_corners[i][corner] = p->local[vertex];
    }
  for (size_t i = 0; i < n_listed; i++)
    p->local[listed[i]] = UINT32_MAX;
  return n_listed;
}

/* The faces of the largest cluster, or of the finest level of the root. */
static size_t most_faces(const packing *p) {
  size_t most = 0;
  for (size_t i = 0; i < p->n_clusters; i++)
    most = p->mesh->starts[i + 1] - p->mesh->starts[i] > most ? p->mesh->starts[i + 1] - p->mesh->starts[i] : most;
  return p->job->whole.n > 0 && p->job->whole.levels[0].n > most ? p->job->whole.levels[0].n : most;
}

static void count_cluster(packing *p, uint32_t cluster) {
  const conic_cluster_ways *ways = &p->job->ways[cluster];
  int has_faces = !conic_cluster_is_kept(p->mesh, cluster);
  conic_chy_header *h = &p->header;
  h->n_triangles += has_faces ? p->mesh->starts[cluster + 1] - p->mesh->starts[cluster] : 0;
  for (int i = 0; i < ways->triangles.n; i++) {
    h->n_triangles += ways->triangles.levels[i].n;
    h->n_borders += ways->triangles.levels[i].n_borders;
  }
  for (int i = 0; i < ways->n_surfels; i++)
    h->n_surfels += ways->surfels[i].n;
  h->n_levels += (uint64_t)(has_faces + ways->triangles.n + ways->n_surfels);
}

static void count_whole(packing *p) {
  const conic_cluster_levels *whole = &p->job->whole;
  for (int i = 0; i < whole->n; i++)
    p->header.n_triangles += whole->levels[i].n;
  p->header.n_levels += (uint64_t)whole->n;
}

static void count_node(packing *p, size_t node) {
  const conic_node_ways *ways = &p->job->node_ways[node];
  for (int i = 0; i < ways->n_surfels; i++)
    p->header.n_surfels += ways->surfels[i].n;
  p->header.n_levels += (uint64_t)ways->n_surfels;
}

static void add_vertex_to_box(conic_chy_header *h, float *const position[3], size_t i) {
  for (int axis = 0; axis < 3; axis++) {
    float at = position[axis][i];
    h->low[axis] = at < h->low[axis] ? at : h->low[axis];
    h->high[axis] = at > h->high[axis] ? at : h->high[axis];
  }
}

static void measure_box(const packing *p, conic_chy_header *h) {
  for (int axis = 0; axis < 3; axis++) {
    h->low[axis] = HUGE_VALF;
    h->high[axis] = -HUGE_VALF;
  }
  for (size_t i = 0; i < p->flat->count; i++)
    for (int corner = 0; corner < 3 && p->mesh->clusters->of_face[i] != CONIC_NO_CLUSTER; corner++)
      if (!p->mesh->kept || i < p->mesh->kept->n_surface)
        add_vertex_to_box(h, (float *const *)p->flat->position, p->flat->corners[i][corner]);
  for (size_t i = 0; p->mesh->kept && i < p->mesh->kept->n; i++) {
    const float *at = p->mesh->kept->items[i].position;
    float *const place[3] = {(float *)at, (float *)at + 1, (float *)at + 2};
    add_vertex_to_box(h, place, 0);
  }
}

/* The list of vertices is as long as three times the triangles at first, and cut afterwards. */
static conic_status allocate_body(packing *p) {
  conic_chy_header *h = &p->header;
  memcpy(h->origin, p->flat->origin, sizeof h->origin);
  h->version = CONIC_CHY_VERSION;
  h->cutoff = p->job->options->cutoff;
  h->n_vertices = p->flat->n_vertices - (p->mesh->kept ? 4 * p->mesh->kept->n : 0);
  h->n_clusters = p->n_clusters;
  h->n_nodes = p->job->n_nodes;
  h->n_slots = p->job->chains.n_slots;
  h->n_materials = p->flat->n_materials;
  h->flags = (p->flat->normal[0] ? CONIC_CHY_NORMALS : 0u) | (p->flat->color[0] ? CONIC_CHY_COLORS : 0u) |
             (p->flat->texture_coordinate[0] ? CONIC_CHY_TEXTURE_COORDINATES : 0u) |
             (p->flat->material && p->flat->n_materials ? CONIC_CHY_MATERIALS : 0u);
  for (size_t i = 0; i < p->flat->n_materials; i++) {
    const conic_texture *texture = p->flat->materials[i].texture;
    if (texture)
      h->n_texels += (uint64_t)texture->levels[0].width * (uint64_t)texture->levels[0].height;
  }
  for (uint32_t i = 0; i < p->n_clusters; i++)
    count_cluster(p, i);
  count_whole(p);
  for (size_t i = 0; i < p->job->n_nodes && p->job->node_ways; i++)
    count_node(p, i);
  if (h->n_triangles > UINT32_MAX / 4 || h->n_surfels > UINT32_MAX / 4 || h->n_texels > UINT32_MAX / 4)
    return conic_fail(p->job->context, CONIC_ERROR_ARGUMENT, "the model's triangles, surfels or textures are too many");
  measure_box(p, h);
  return CONIC_OK;
}

/* --- the body --- */

static void *array_at(packing *p, int i) {
  return p->bytes + p->layout.arrays[i].offset;
}

typedef struct cursor {
  size_t level, triangle, listed, surfel, border;
} cursor;

static void put_change(conic_hybrid_level *level, const conic_seen_change *change) {
  level->change = conic_seen_float(change->steps);
  level->smear = conic_seen_float(change->smear);
}

static void put_triangles(packing *p, cursor *at, const conic_cluster_level *from) {
  conic_hybrid_level *levels = array_at(p, CONIC_CHY_LEVELS);
  uint32_t(*local)[3] = array_at(p, CONIC_CHY_CORNERS), *listed = array_at(p, CONIC_CHY_LISTED);
  uint32_t *material = array_at(p, CONIC_CHY_MATERIAL_OF);
  conic_hybrid_level *level = &levels[at->level++];
  memset(level, 0, sizeof *level);
  level->kind = CONIC_HYBRID_TRIANGLES;
  level->first = (uint32_t)at->triangle;
  level->count = (uint32_t)from->n;
  level->first_vertex = (uint32_t)at->listed;
  level->n_vertices = (uint32_t)list_vertices(p, (const uint32_t(*)[3])from->corners, from->n, listed + at->listed,
                                              local + at->triangle);
  level->error = (float)(from->error * (1.0 + 1e-6));
  put_change(level, &from->change);
  level->stage = from->stage;
  level->first_border = (uint32_t)at->border;
  level->n_borders = (uint32_t)from->n_borders;
  for (size_t i = 0; i < from->n && p->header.flags & CONIC_CHY_MATERIALS; i++)
    material[at->triangle + i] = p->flat->material[from->face[i]];
  if (from->n_borders > 0)
    memcpy((conic_cluster_border *)array_at(p, CONIC_CHY_BORDERS) + at->border, from->borders,
           from->n_borders * sizeof *from->borders);
  at->triangle += from->n;
  at->listed += level->n_vertices;
  at->border += from->n_borders;
}

/* The half axes of the outlines at the cutoff: what a picture of the level may take is found from these sums. */
static void sum_extents(const conic_surfels *surfels, double cutoff, conic_hybrid_level *level) {
  double cover = 0.0, spread = 0.0;
  for (size_t i = 0; i < surfels->n; i++) {
    double squares[2] = {0.0, 0.0};
    for (int axis = 0; axis < 3; axis++) {
      squares[0] += (double)surfels->items[i].tangent_u[axis] * (double)surfels->items[i].tangent_u[axis];
      squares[1] += (double)surfels->items[i].tangent_v[axis] * (double)surfels->items[i].tangent_v[axis];
    }
    cover += sqrt(squares[0] * squares[1]);
    spread += squares[0] + squares[1];
  }
  level->cover = (float)(cutoff * cutoff * cover);
  level->spread = (float)(cutoff * cutoff * spread);
}

static void put_surfels(packing *p, cursor *at, const conic_surfels *surfels) {
  conic_hybrid_level *levels = array_at(p, CONIC_CHY_LEVELS);
  conic_hybrid_level *level = &levels[at->level++];
  memset(level, 0, sizeof *level);
  level->kind = CONIC_HYBRID_SURFELS;
  level->first = (uint32_t)at->surfel;
  level->count = (uint32_t)surfels->n;
  level->error = (float)(surfels->error * (1.0 + 1e-6));
  put_change(level, &surfels->change);
  level->stage = (uint32_t)surfels->are_dots;
  level->reach = (float)(surfels->reach * (1.0 + 1e-6));
  sum_extents(surfels, (double)p->job->options->cutoff, level);
  for (int k = 0; k < 12; k++) {
    float *values = array_at(p, CONIC_CHY_SURFELS + k);
    for (size_t i = 0; i < surfels->n; i++) {
      const conic_surfel *s = &surfels->items[i];
      const float *part = k < 3 ? s->position : k < 6 ? s->tangent_u : k < 9 ? s->tangent_v : s->color;
      values[at->surfel + i] = part[k % 3];
    }
  }
  at->surfel += surfels->n;
}

/* The first level of triangles is the cluster's faces themselves. */
static void put_cluster(packing *p, cursor *at, uint32_t i, conic_cluster_level *mesh) {
  conic_hybrid_cluster *clusters = array_at(p, CONIC_CHY_CLUSTERS);
  const conic_cluster_ways *ways = &p->job->ways[i];
  double error = 0.0;
  int has_faces = !conic_cluster_is_kept(p->mesh, i);
  clusters[i] = (conic_hybrid_cluster){.bound = ways->bound,
                                       .area = (float)ways->area,
                                       .first_level = (uint32_t)at->level,
                                       .n_levels = (uint32_t)(has_faces + ways->triangles.n + ways->n_surfels)};
  clusters[i].built = ways->is_surfels ? (uint32_t)(has_faces + ways->triangles.n) : 0;
  mesh->n = 0;
  for (size_t k = p->mesh->starts[i]; k < p->mesh->starts[i + 1] && has_faces; k++, mesh->n++) {
    mesh->face[mesh->n] = p->mesh->faces[k];
    memcpy(mesh->corners[mesh->n], p->flat->corners[p->mesh->faces[k]], sizeof *mesh->corners);
  }
  if (has_faces)
    put_triangles(p, at, mesh);
  for (int k = 0; k < ways->triangles.n; k++) {
    conic_cluster_level level = ways->triangles.levels[k];
    level.error = error = level.error > error ? level.error : error; /* no less than that of what it is simpler than */
    put_triangles(p, at, &level);
  }
  for (int k = 0; k < ways->n_surfels; k++)
    put_surfels(p, at, &ways->surfels[k]);
}

static void put_node(packing *p, cursor *at, size_t i) {
  conic_hybrid_node *node = (conic_hybrid_node *)array_at(p, CONIC_CHY_NODES) + i;
  const conic_node_ways *ways = p->job->node_ways ? &p->job->node_ways[i] : NULL;
  *node = p->job->nodes[i];
  node->first_level = (uint32_t)at->level;
  for (int k = 0; i == 0 && k < p->job->whole.n; k++)
    put_triangles(p, at, &p->job->whole.levels[k]);
  for (int k = 0; ways && k < ways->n_surfels; k++)
    put_surfels(p, at, &ways->surfels[k]);
  node->n_levels = (uint32_t)at->level - node->first_level;
}

static void put_vertices(packing *p) {
  size_t n_bytes = p->header.n_vertices * sizeof(float);
  for (int axis = 0; axis < 3; axis++) {
    memcpy(array_at(p, CONIC_CHY_POSITION + axis), p->flat->position[axis], n_bytes);
    if (p->flat->normal[0])
      memcpy(array_at(p, CONIC_CHY_NORMAL + axis), p->flat->normal[axis], n_bytes);
    if (p->flat->color[0])
      memcpy(array_at(p, CONIC_CHY_COLOR + axis), p->flat->color[axis], n_bytes);
  }
  for (int k = 0; k < 2 && p->flat->texture_coordinate[0]; k++)
    memcpy(array_at(p, CONIC_CHY_TEXTURE + k), p->flat->texture_coordinate[k], n_bytes);
}

static void put_materials(packing *p) {
  conic_chy_material *list = array_at(p, CONIC_CHY_MATERIAL_LIST);
  unsigned char *codes = array_at(p, CONIC_CHY_TEXELS);
  float thresholds[255];
  uint64_t n_texels = 0;
  conic_srgb_thresholds(thresholds);
  for (size_t i = 0; i < p->flat->n_materials; i++) {
    const conic_material *from = &p->flat->materials[i];
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

static int is_built_of_surfels(const conic_hybrid_cluster *cluster, const conic_hybrid_level *levels) {
  return levels[cluster->first_level + cluster->built].kind == CONIC_HYBRID_SURFELS;
}

/* The surfels as built, for the scale of the automatic ε. */
static conic_status measure_surfels(packing *p) {
  const conic_hybrid_cluster *clusters = array_at(p, CONIC_CHY_CLUSTERS);
  const conic_hybrid_level *levels = array_at(p, CONIC_CHY_LEVELS);
  conic_splats built;
  size_t n = 0, at = 0;
  for (size_t i = 0; i < p->header.n_clusters; i++)
    n += is_built_of_surfels(&clusters[i], levels) ? levels[clusters[i].first_level + clusters[i].built].count : 0;
  conic_status status = conic_splats_allocate(p->job->context, n, CONIC_SPLATS_TANGENTS, &built);
  for (size_t i = 0; i < p->header.n_clusters && status == CONIC_OK; i++) {
    const conic_hybrid_level *level = &levels[clusters[i].first_level + clusters[i].built];
    if (!is_built_of_surfels(&clusters[i], levels))
      continue;
    for (int axis = 0; axis < 3; axis++) {
      const float *x = array_at(p, CONIC_CHY_SURFELS + axis), *u = array_at(p, CONIC_CHY_SURFELS + 3 + axis);
      const float *v = array_at(p, CONIC_CHY_SURFELS + 6 + axis);
      memcpy(built.position[axis] + at, x + level->first, level->count * sizeof(float));
      memcpy(built.tangent_u[axis] + at, u + level->first, level->count * sizeof(float));
      memcpy(built.tangent_v[axis] + at, v + level->first, level->count * sizeof(float));
    }
    at += level->count;
  }
  if (status == CONIC_OK)
    status = conic_splats_length(p->job->context, &built, &p->header.splat_length);
  conic_splats_release(p->job->context, &built);
  return status;
}

static conic_status fill_body(packing *p) {
  cursor at = {0};
  size_t most = most_faces(p);
  conic_cluster_level mesh = {.corners = conic_memory_allocate(p->job->context, most, sizeof *mesh.corners),
                              .face = conic_memory_allocate(p->job->context, most, sizeof *mesh.face)};
  int is_there = mesh.corners && mesh.face;
  for (uint32_t i = 0; i < p->n_clusters && is_there; i++)
    put_cluster(p, &at, i, &mesh);
  for (size_t i = 0; i < p->job->n_nodes && is_there; i++)
    put_node(p, &at, i);
  conic_memory_release(p->job->context, mesh.corners);
  conic_memory_release(p->job->context, mesh.face);
  if (!is_there)
    return CONIC_ERROR_MEMORY;
  if (p->job->chains.n_slots > 0)
    memcpy(array_at(p, CONIC_CHY_SLOTS), p->job->chains.slots, p->job->chains.n_slots * sizeof *p->job->chains.slots);
  put_vertices(p);
  put_materials(p);
  return measure_surfels(p);
}

/* How long the list of vertices is shows only when it is made; so it is counted first. */
static conic_status count_listed(packing *p) {
  const conic_cluster_levels *whole = &p->job->whole;
  size_t most = most_faces(p);
  uint32_t(*corners)[3] = conic_memory_allocate(p->job->context, most, sizeof *corners);
  uint32_t(*local)[3] = conic_memory_allocate(p->job->context, most, sizeof *local);
  uint32_t *listed = conic_memory_allocate(p->job->context, most, 3 * sizeof *listed);
  conic_status status = corners && local && listed ? CONIC_OK : CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < p->n_clusters && status == CONIC_OK; i++) {
    const conic_cluster_levels *simpler = &p->job->ways[i].triangles;
    size_t n = conic_cluster_is_kept(p->mesh, (uint32_t)i) ? 0 : p->mesh->starts[i + 1] - p->mesh->starts[i];
    for (size_t k = 0; k < n; k++)
      memcpy(corners[k], p->flat->corners[p->mesh->faces[p->mesh->starts[i] + k]], sizeof *corners);
    p->header.n_listed += list_vertices(p, (const uint32_t(*)[3])corners, n, listed, local);
    for (int k = 0; k < simpler->n; k++)
      p->header.n_listed +=
          list_vertices(p, (const uint32_t(*)[3])simpler->levels[k].corners, simpler->levels[k].n, listed, local);
  }
  for (int k = 0; k < whole->n && status == CONIC_OK; k++)
    p->header.n_listed +=
        list_vertices(p, (const uint32_t(*)[3])whole->levels[k].corners, whole->levels[k].n, listed, local);
  conic_memory_release(p->job->context, listed);
  conic_memory_release(p->job->context, local);
  conic_memory_release(p->job->context, corners);
  return status;
}

static conic_status pack(packing *p, conic_hybrid **hybrid) {
  conic_status status = allocate_body(p);
  if (status == CONIC_OK)
    status = count_listed(p);
  if (status != CONIC_OK)
    return status;
  p->layout = conic_chy_lay_out(&p->header);
  p->bytes = conic_memory_allocate_zeroed(p->job->context, p->layout.n_bytes, 1);
  conic_hybrid *made = conic_memory_allocate_zeroed(p->job->context, 1, sizeof *made);
  *hybrid = made;
  if (!p->bytes || !made) {
    conic_memory_release(p->job->context, p->bytes);
    return CONIC_ERROR_MEMORY;
  }
  made->context = p->job->context;
  made->owned = p->bytes;
  status = fill_body(p);
  conic_chy_attach(&p->header, p->bytes, made);
  return status == CONIC_OK ? conic_chy_make_materials(made) : status;
}

conic_status conic_hybrid_pack(const conic_ways_job *ways, conic_hybrid **hybrid) {
  const conic_triangles *flat = ways->mesh->triangles;
  packing p = {.job = ways,
               .mesh = ways->mesh,
               .flat = flat,
               .n_clusters = ways->mesh->clusters->n_clusters,
               .local = conic_memory_allocate(ways->context, flat->n_vertices, sizeof *p.local)};
  *hybrid = NULL;
  if (!p.local)
    return CONIC_ERROR_MEMORY;
  memset(p.local, 0xFF, flat->n_vertices * sizeof *p.local);
  conic_status status = pack(&p, hybrid);
  conic_memory_release(ways->context, p.local);
  return status;
}
