/* From the ways to draw each cluster to a model, all in one piece of memory. */
#include "lod/hybrid/build/hybrid_build.h"

#include "core/base/color.h"
#include "core/base/vectors.h"
#include "core/image/texture_levels.h"
#include "lod/hybrid/model/hybrid_chunks.h"
#include "lod/hybrid/model/hybrid_layout.h"

typedef struct packing {
  const conic_ways_job *job;
  const conic_clustered_mesh *mesh; /* the job's */
  const conic_triangles *flat;      /* the same mesh */
  size_t n_clusters;
  uint32_t *local;                      /* of each vertex: its number in the level that is being listed, else none */
  uint32_t *listed, (*corners)[3];      /* of the level that is being listed: its vertices, and corners among these */
  conic_cluster_level faces;            /* of the cluster's faces themselves */
  uint32_t (*first_slots)[2], *of_slot; /* of each chain: its first slot in both clusters; of each slot its chain */
  uint32_t *chain_starts, *chains_by;   /* by cluster */
  conic_file_layout layout;
  unsigned char *bytes;
  conic_hybrid *made; /* over these */
  size_t level;       /* the next */
} packing;

/* --- sizes --- */

/* Lists the vertices of so many triangles, and returns how many they are. */
static size_t list_vertices(packing *p, const uint32_t (*corners)[3], size_t n) {
  uint32_t *listed = p->listed;
  size_t n_listed = 0;
  for (size_t i = 0; i < n; i++)
    for (int corner = 0; corner < 3; corner++) {
      uint32_t vertex = corners[i][corner];
      if (p->local[vertex] == UINT32_MAX) {
        listed[n_listed] = vertex;
        p->local[vertex] = (uint32_t)n_listed++;
      }
      p->corners[i][corner] = p->local[vertex];
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

static void count_levels(packing *p) {
  conic_hybrid *h = p->made;
  h->n_levels = (uint64_t)p->job->whole.n;
  for (size_t i = 0; i < p->n_clusters; i++)
    h->n_levels += (uint64_t)(!conic_cluster_is_kept(p->mesh, (uint32_t)i) + p->job->ways[i].triangles.n +
                              p->job->ways[i].n_surfels);
  for (size_t i = 0; i < p->job->n_nodes && p->job->node_ways; i++)
    h->n_levels += (uint64_t)p->job->node_ways[i].n_surfels;
  for (size_t i = 0; i < p->flat->n_materials; i++) {
    const conic_texture *texture = p->flat->materials[i].texture;
    if (texture)
      h->n_texels += (uint64_t)texture->levels[0].width * (uint64_t)texture->levels[0].height;
  }
}

static void add_vertex_to_box(conic_hybrid *h, float *const position[3], size_t i) {
  for (int axis = 0; axis < 3; axis++) {
    float at = position[axis][i];
    CONIC_WIDEN(h->low[axis], h->high[axis], at, at);
  }
}

static void measure_box(const packing *p, conic_hybrid *h) {
  for (int axis = 0; axis < 3; axis++) {
    h->low[axis] = HUGE_VALF;
    h->high[axis] = -HUGE_VALF;
  }
  for (size_t i = 0; i < p->mesh->starts[p->n_clusters]; i++)
    for (int corner = 0; corner < 3; corner++)
      if (!p->mesh->kept || p->mesh->faces[i] < p->mesh->kept->n_surface)
        add_vertex_to_box(h, (float *const *)p->flat->position, p->flat->corners[p->mesh->faces[i]][corner]);
  for (size_t i = 0; p->mesh->kept && i < p->mesh->kept->n; i++) {
    const float *at = p->mesh->kept->items[i].position;
    float *const place[3] = {(float *)at, (float *)at + 1, (float *)at + 2};
    add_vertex_to_box(h, place, 0);
  }
}

/* Of a part of a mesh, those of its own faces. */
static size_t count_vertices(packing *p) {
  size_t n = 0;
  if (p->n_clusters == p->mesh->clusters->n_clusters)
    return p->flat->n_vertices + p->job->whole.n_moved;
  for (size_t i = 0; i < 3 * p->mesh->starts[p->n_clusters]; i++) {
    uint32_t *seen = &p->local[p->flat->corners[p->mesh->faces[i / 3]][i % 3]];
    n += *seen == UINT32_MAX;
    *seen = 0;
  }
  memset(p->local, 0xFF, p->flat->n_vertices * sizeof *p->local);
  return n;
}

static void begin_header(packing *p) {
  conic_hybrid *h = p->made;
  memcpy(h->origin, p->flat->origin, sizeof h->origin);
  h->cutoff = p->job->options->cutoff;
  h->n_vertices = count_vertices(p) - (p->mesh->kept ? 4 * p->mesh->kept->n : 0);
  h->n_clusters = p->n_clusters;
  h->n_nodes = p->job->n_nodes;
  h->n_materials = p->flat->n_materials;
  h->flags = (p->flat->normal[0] ? CONIC_CHY_NORMALS : 0u) | (p->flat->color[0] ? CONIC_CHY_COLORS : 0u) |
             (p->flat->texture_coordinate[0] ? CONIC_CHY_TEXTURE_COORDINATES : 0u) |
             (p->flat->material && p->flat->n_materials ? CONIC_CHY_MATERIALS : 0u);
  count_levels(p);
  measure_box(p, h);
}

/* --- slots --- */

/* The chains of each cluster, in their order, and where each begins among the cluster's slots. */
static conic_status sort_chains(packing *p) {
  conic_context *context = p->job->context;
  const conic_cluster_chains *c = &p->job->chains;
  if (conic_memory_allocate_these(context, CONIC_ROOM(p->first_slots, c->n_chains), CONIC_ROOM(p->of_slot, c->n_slots),
                                  CONIC_ZEROED(p->chain_starts, p->n_clusters + 2),
                                  CONIC_ROOM(p->chains_by, 2 * c->n_chains)) != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < 2 * c->n_chains; i++)
    p->chain_starts[c->chains[i / 2].clusters[i % 2] + 2]++;
  for (size_t i = 0; i < p->n_clusters; i++)
    p->chain_starts[i + 2] += p->chain_starts[i + 1];
  for (uint32_t i = 0; i < 2 * c->n_chains; i++)
    p->chains_by[p->chain_starts[c->chains[i / 2].clusters[i % 2] + 1]++] = i / 2;
  for (uint32_t i = 0; i < c->n_chains; i++)
    for (uint32_t k = 0; k < c->chains[i].n; k++)
      p->of_slot[c->chains[i].first + k] = i;
  return CONIC_OK;
}

static uint32_t count_slots(packing *p, uint32_t cluster) {
  uint32_t n = 0;
  for (uint32_t k = p->chain_starts[cluster]; k < p->chain_starts[cluster + 1]; k++) {
    const conic_chain *chain = &p->job->chains.chains[p->chains_by[k]];
    p->first_slots[p->chains_by[k]][chain->clusters[1] == cluster] = n;
    n += chain->n;
  }
  return n;
}

/* --- the arrays --- */

static void *array_at(packing *p, int i) {
  return p->bytes + p->layout.arrays[i].offset;
}

static conic_hybrid_level *next_level(packing *p, conic_hybrid_kind kind, size_t n) {
  conic_hybrid_level *level = (conic_hybrid_level *)array_at(p, CONIC_CHY_LEVELS) + p->level++;
  *level = (conic_hybrid_level){.kind = kind, .count = (uint32_t)n};
  *(kind == CONIC_HYBRID_TRIANGLES ? &p->made->n_triangles : &p->made->n_surfels) += n;
  return level;
}

static void put_change(conic_hybrid_level *level, const conic_seen_change *change) {
  level->change = conic_seen_float(change->steps);
  level->smear = conic_seen_float(change->smear);
}

static void put_triangles(packing *p, const conic_cluster_level *from, uint32_t *n_borders) {
  conic_hybrid_level *level = next_level(p, CONIC_HYBRID_TRIANGLES, from->n);
  level->n_vertices = (uint32_t)list_vertices(p, (const uint32_t(*)[3])from->corners, from->n);
  level->error = (float)(from->error * (1.0 + 1e-6));
  put_change(level, &from->change);
  level->stage = from->stage;
  level->first_border = *n_borders;
  level->n_borders = (uint32_t)from->n_borders;
  *n_borders += level->n_borders;
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

static void put_surfels(packing *p, const conic_surfels *surfels) {
  conic_hybrid_level *level = next_level(p, CONIC_HYBRID_SURFELS, surfels->n);
  level->error = (float)(surfels->error * (1.0 + 1e-6));
  put_change(level, &surfels->change);
  level->stage = (uint32_t)surfels->are_dots;
  level->reach = (float)(surfels->reach * (1.0 + 1e-6));
  sum_extents(surfels, (double)p->job->options->cutoff, level);
}

/* The first level of triangles: the cluster's faces themselves. */
static const conic_cluster_level *take_faces(packing *p, uint32_t cluster) {
  conic_cluster_level *faces = &p->faces;
  faces->n = 0;
  for (size_t k = p->mesh->starts[cluster]; k < p->mesh->starts[cluster + 1]; k++, faces->n++) {
    faces->face[faces->n] = p->mesh->faces[k];
    memcpy(faces->corners[faces->n], p->flat->corners[p->mesh->faces[k]], sizeof *faces->corners);
  }
  return faces;
}

static void put_cluster(packing *p, uint32_t i) {
  conic_hybrid_cluster *cluster = (conic_hybrid_cluster *)array_at(p, CONIC_CHY_CLUSTERS) + i;
  const conic_cluster_ways *ways = &p->job->ways[i];
  double error = 0.0;
  int has_faces = !conic_cluster_is_kept(p->mesh, i);
  *cluster = (conic_hybrid_cluster){.bound = ways->bound,
                                    .area = (float)ways->area,
                                    .first_level = (uint32_t)p->level,
                                    .n_levels = (uint32_t)(has_faces + ways->triangles.n + ways->n_surfels),
                                    .n_slots = count_slots(p, i)};
  cluster->built = ways->is_surfels ? (uint32_t)(has_faces + ways->triangles.n) : 0;
  if (has_faces)
    put_triangles(p, take_faces(p, i), &cluster->n_borders);
  for (int k = 0; k < ways->triangles.n; k++) {
    conic_cluster_level level = ways->triangles.levels[k];
    level.error = error = level.error > error ? level.error : error; /* no less than that of what it is simpler than */
    put_triangles(p, &level, &cluster->n_borders);
  }
  for (int k = 0; k < ways->n_surfels; k++)
    put_surfels(p, &ways->surfels[k]);
}

static void put_node(packing *p, size_t i) {
  conic_hybrid_node *node = (conic_hybrid_node *)array_at(p, CONIC_CHY_NODES) + i;
  const conic_node_ways *ways = p->job->node_ways ? &p->job->node_ways[i] : NULL;
  uint32_t n_borders = 0; /* there are none */
  *node = p->job->nodes[i];
  node->first_level = (uint32_t)p->level;
  for (int k = 0; i == 0 && k < p->job->whole.n; k++)
    put_triangles(p, &p->job->whole.levels[k], &n_borders);
  for (int k = 0; ways && k < ways->n_surfels; k++)
    put_surfels(p, &ways->surfels[k]);
  node->n_levels = (uint32_t)p->level - node->first_level;
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

/* --- chunks --- */

/* Where the next values of a chunk go. */
static unsigned char *begin_chunk(const packing *p, uint32_t chunk) {
  return p->bytes + p->layout.n_bytes + conic_hybrid_chunk_place(p->made, chunk).at + CONIC_HYBRID_SUM_BYTES;
}

static void end_chunk(const packing *p, uint32_t chunk) {
  conic_hybrid_place place = conic_hybrid_chunk_place(p->made, chunk);
  if (place.n_bytes)
    conic_hybrid_seal_chunk(p->bytes + p->layout.n_bytes + place.at, (size_t)place.n_bytes);
}

/* Which of a vertex's values simplifying may have moved: positions from 0 on, normals from 3 on. */
enum { POSITION = 0, NORMAL = 3, UNMOVED = 6 };

/* What simplifying moved comes after the mesh's own vertices. */
static float value_of_vertex(const packing *p, const float *values, uint32_t vertex, int which) {
  if (vertex < p->flat->n_vertices)
    return values[vertex];
  const conic_moved_vertex *moved = &p->job->whole.moved[vertex - p->flat->n_vertices];
  return which < NORMAL ? moved->at[which] : which < UNMOVED ? moved->normal[which - NORMAL] : values[moved->original];
}

static unsigned char *put_values(const packing *p, unsigned char *to, const float *values, int which,
                                 const uint32_t *listed, size_t n) {
  float *floats = (float *)(void *)to;
  for (size_t i = 0; i < n && values; i++)
    floats[i] = value_of_vertex(p, values, listed[i], which);
  return values ? (unsigned char *)(floats + n) : to;
}

static unsigned char *put_vertices(const packing *p, unsigned char *to, const uint32_t *listed, size_t n) {
  for (int axis = 0; axis < 3; axis++)
    to = put_values(p, to, p->flat->position[axis], POSITION + axis, listed, n);
  for (int axis = 0; axis < 3; axis++)
    to = put_values(p, to, p->flat->normal[axis], NORMAL + axis, listed, n);
  for (int channel = 0; channel < 3; channel++)
    to = put_values(p, to, p->flat->color[channel], UNMOVED, listed, n);
  for (int k = 0; k < 2; k++)
    to = put_values(p, to, p->flat->texture_coordinate[k], UNMOVED, listed, n);
  return to;
}

static void fill_triangles(packing *p, const conic_cluster_level *from) {
  uint32_t chunk = (uint32_t)p->level++;
  size_t n = list_vertices(p, (const uint32_t(*)[3])from->corners, from->n);
  unsigned char *to = put_vertices(p, begin_chunk(p, chunk), p->listed, n);
  if (p->made->flags & CONIC_CHY_MATERIALS)
    for (size_t i = 0; i < from->n; i++, to += sizeof(uint32_t))
      memcpy(to, &p->flat->material[from->face[i]], sizeof(uint32_t));
  for (size_t i = 0; i < 3 * from->n; i++) {
    uint32_t corner = p->corners[i / 3][i % 3];
    uint16_t narrow = (uint16_t)corner;
    size_t n_bytes = n <= CONIC_HYBRID_NARROW ? sizeof narrow : sizeof corner;
    memcpy(to, n <= CONIC_HYBRID_NARROW ? (const void *)&narrow : &corner, n_bytes);
    to += n_bytes;
  }
  end_chunk(p, chunk);
}

static void fill_surfels(packing *p, const conic_surfels *surfels) {
  uint32_t chunk = (uint32_t)p->level++;
  float *values = (float *)(void *)begin_chunk(p, chunk);
  for (size_t k = 0; k < 12; k++)
    for (size_t i = 0; i < surfels->n; i++) {
      const conic_surfel *s = &surfels->items[i];
      const float *part = k < 3 ? s->position : k < 6 ? s->tangent_u : k < 9 ? s->tangent_v : s->color;
      values[k * surfels->n + i] = part[k % 3];
    }
  end_chunk(p, chunk);
}

/* A slot of the chain between two clusters becomes one of the cluster's own. */
static uint32_t own_slot(const packing *p, uint32_t cluster, uint32_t slot) {
  uint32_t i = p->of_slot[slot];
  const conic_chain *chain = &p->job->chains.chains[i];
  return p->first_slots[i][chain->clusters[1] == cluster] + slot - chain->first;
}

static void fill_frame(packing *p, uint32_t cluster) {
  const conic_cluster_chains *c = &p->job->chains;
  const conic_cluster_levels *simpler = &p->job->ways[cluster].triangles;
  uint32_t frame = conic_hybrid_frame_chunk(p->made, cluster), ends = conic_hybrid_ends_chunk(p->made, cluster), n = 0;
  unsigned char *to = begin_chunk(p, frame);
  for (uint32_t k = p->chain_starts[cluster]; k < p->chain_starts[cluster + 1]; k++) {
    const conic_chain *chain = &c->chains[p->chains_by[k]];
    for (uint32_t m = chain->first; m < chain->first + chain->n; m++, to += sizeof(uint32_t)) {
      memcpy(to, &c->slots[m].stage, sizeof(uint32_t));
      p->listed[n++] = c->slots[m].vertices[chain->clusters[1] == cluster];
    }
  }
  for (int k = 0; k < simpler->n; k++)
    for (size_t i = 0; i < simpler->levels[k].n_borders; i++, to += sizeof(conic_cluster_border)) {
      conic_cluster_border border = simpler->levels[k].borders[i];
      border.from = own_slot(p, cluster, border.from);
      border.to = own_slot(p, cluster, border.to);
      memcpy(to, &border, sizeof border);
    }
  if (n > 0)
    put_vertices(p, begin_chunk(p, ends), p->listed, n);
  end_chunk(p, frame);
  end_chunk(p, ends);
}

static void fill_chunks(packing *p) {
  p->level = 0;
  for (uint32_t i = 0; i < p->n_clusters; i++) {
    const conic_cluster_ways *ways = &p->job->ways[i];
    fill_frame(p, i);
    if (!conic_cluster_is_kept(p->mesh, i))
      fill_triangles(p, take_faces(p, i));
    for (int k = 0; k < ways->triangles.n; k++)
      fill_triangles(p, &ways->triangles.levels[k]);
    for (int k = 0; k < ways->n_surfels; k++)
      fill_surfels(p, &ways->surfels[k]);
  }
  for (size_t i = 0; i < p->job->n_nodes; i++) {
    const conic_node_ways *ways = p->job->node_ways ? &p->job->node_ways[i] : NULL;
    for (int k = 0; i == 0 && k < p->job->whole.n; k++)
      fill_triangles(p, &p->job->whole.levels[k]);
    for (int k = 0; ways && k < ways->n_surfels; k++)
      fill_surfels(p, &ways->surfels[k]);
  }
}

/* --- all --- */

static int is_built_of_surfels(const conic_hybrid *h, uint32_t cluster) {
  return h->levels[h->clusters[cluster].first_level + h->clusters[cluster].built].kind == CONIC_HYBRID_SURFELS;
}

/* The surfels as built, for the scale of the automatic ε. */
static conic_status measure_surfels(packing *p) {
  const conic_hybrid *h = p->made;
  conic_splats built;
  size_t n = 0, at = 0;
  for (uint32_t i = 0; i < h->n_clusters; i++)
    n += is_built_of_surfels(h, i) ? h->levels[h->clusters[i].first_level + h->clusters[i].built].count : 0;
  conic_status status = conic_splats_allocate(p->job->context, n, CONIC_SPLATS_TANGENTS, &built);
  for (uint32_t i = 0; i < h->n_clusters && status == CONIC_OK; i++) {
    uint32_t level = h->clusters[i].first_level + h->clusters[i].built;
    if (!is_built_of_surfels(h, i))
      continue;
    conic_hybrid_piece piece = conic_hybrid_piece_of(h, level);
    for (int axis = 0; axis < 3; axis++) {
      memcpy(built.position[axis] + at, piece.surfels[axis], h->levels[level].count * sizeof(float));
      memcpy(built.tangent_u[axis] + at, piece.surfels[3 + axis], h->levels[level].count * sizeof(float));
      memcpy(built.tangent_v[axis] + at, piece.surfels[6 + axis], h->levels[level].count * sizeof(float));
    }
    at += h->levels[level].count;
  }
  if (status == CONIC_OK)
    status = conic_splats_length(p->job->context, &built, &p->made->splat_length);
  conic_splats_release(p->job->context, &built);
  return status;
}

/* The arrays, and from these where the chunks go. */
static conic_status pack_arrays(packing *p) {
  begin_header(p);
  p->layout = conic_chy_lay_out(p->made);
  p->made->owned = p->bytes = conic_memory_allocate_zeroed(p->job->context, p->layout.n_bytes, 1);
  if (!p->bytes)
    return CONIC_ERROR_MEMORY;
  for (uint32_t i = 0; i < p->n_clusters; i++)
    put_cluster(p, i);
  for (size_t i = 0; i < p->job->n_nodes; i++)
    put_node(p, i);
  put_materials(p);
  if (p->made->n_triangles > UINT32_MAX / 4 || p->made->n_surfels > UINT32_MAX / 4 ||
      p->made->n_texels > UINT32_MAX / 4)
    return conic_fail(p->job->context, CONIC_ERROR_ARGUMENT, "the model's triangles, surfels or textures are too many");
  conic_chy_attach(p->bytes, p->made);
  return conic_hybrid_place_chunks(p->made, array_at(p, CONIC_CHY_LEVELS), array_at(p, CONIC_CHY_CLUSTERS));
}

/* The arrays, and behind them the chunks. */
static conic_status pack_chunks(packing *p) {
  size_t n_bytes = p->layout.n_bytes, n_data = (size_t)p->made->n_data;
  unsigned char *all = conic_memory_allocate_zeroed(p->job->context, n_bytes + n_data, 1);
  if (!all)
    return CONIC_ERROR_MEMORY;
  memcpy(all, p->bytes, n_bytes);
  conic_memory_release(p->job->context, p->bytes);
  p->made->owned = p->bytes = all;
  conic_chy_attach(p->bytes, p->made);
  p->made->data = p->bytes + n_bytes;
  fill_chunks(p);
  conic_status status = measure_surfels(p);
  return status == CONIC_OK ? conic_chy_make_materials(p->made) : status;
}

static conic_status pack(packing *p) {
  conic_context *context = p->job->context;
  size_t most = most_faces(p), n_chains = p->job->chains.n_slots;
  if (conic_memory_allocate_these(context, CONIC_ROOM(p->corners, most), CONIC_ROOM(p->listed, 3 * most + n_chains),
                                  CONIC_ROOM(p->faces.corners, most), CONIC_ROOM(p->faces.face, most)) != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  conic_status status = sort_chains(p);
  if (status == CONIC_OK)
    status = pack_arrays(p);
  return status == CONIC_OK ? pack_chunks(p) : status;
}

conic_status conic_hybrid_pack(const conic_ways_job *ways, conic_hybrid **hybrid) {
  const conic_triangles *flat = ways->mesh->triangles;
  conic_context *context = ways->context;
  size_t n_vertices = flat->n_vertices + ways->whole.n_moved;
  packing p = {.job = ways,
               .mesh = ways->mesh,
               .flat = flat,
               .n_clusters = ways->n_clusters,
               .local = conic_memory_allocate(context, n_vertices, sizeof *p.local),
               .made = conic_memory_allocate_zeroed(context, 1, sizeof *p.made)};
  conic_status status = p.local && p.made ? CONIC_OK : CONIC_ERROR_MEMORY;
  *hybrid = p.made;
  if (status == CONIC_OK) {
    p.made->context = context;
    memset(p.local, 0xFF, n_vertices * sizeof *p.local);
    status = pack(&p);
  }
  void *const parts[] = {p.local,       p.listed,  p.corners,      p.faces.corners, p.faces.face,
                         p.first_slots, p.of_slot, p.chain_starts, p.chains_by};
  conic_memory_release_all(context, parts, sizeof parts / sizeof *parts);
  return status;
}
