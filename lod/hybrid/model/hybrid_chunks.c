#include "lod/hybrid/model/hybrid_chunks.h"

#include "core/base/byte_order.h"
#include "core/base/radix.h"
#include "lod/hybrid/model/hybrid_store.h"

/* --- places --- */

static uint64_t whole_units(uint64_t n_bytes) {
  return (n_bytes + CONIC_HYBRID_UNIT - 1) / CONIC_HYBRID_UNIT * CONIC_HYBRID_UNIT;
}

static uint64_t vertex_bytes(uint32_t flags) {
  return 4 * (uint64_t)(3 + (flags & CONIC_CHY_NORMALS ? 3 : 0) + (flags & CONIC_CHY_COLORS ? 3 : 0) +
                        (flags & CONIC_CHY_TEXTURE_COORDINATES ? 2 : 0));
}

static uint64_t hybrid_level_bytes(uint32_t flags, const conic_hybrid_level *level) {
  uint64_t corner = level->n_vertices <= CONIC_HYBRID_NARROW ? 2 : 4;
  uint64_t triangle = 3 * corner + (flags & CONIC_CHY_MATERIALS ? 4 : 0);
  return whole_units(CONIC_HYBRID_SUM_BYTES +
                     (level->kind == CONIC_HYBRID_SURFELS
                          ? 48 * (uint64_t)level->count
                          : vertex_bytes(flags) * level->n_vertices + triangle * level->count));
}

uint64_t conic_hybrid_frame_bytes(const conic_hybrid_cluster *cluster) {
  uint64_t n_bytes = 4 * (uint64_t)cluster->n_slots + sizeof(conic_cluster_border) * (uint64_t)cluster->n_borders;
  return n_bytes ? whole_units(CONIC_HYBRID_SUM_BYTES + n_bytes) : 0;
}

static uint64_t hybrid_ends_bytes(uint32_t flags, const conic_hybrid_cluster *cluster) {
  return cluster->n_slots ? whole_units(CONIC_HYBRID_SUM_BYTES + vertex_bytes(flags) * cluster->n_slots) : 0;
}

size_t conic_hybrid_count_chunks(const conic_hybrid *h) {
  return h->n_levels + 2 * h->n_clusters;
}

uint32_t conic_hybrid_frame_chunk(const conic_hybrid *h, uint32_t cluster) {
  return (uint32_t)h->n_levels + cluster;
}

uint32_t conic_hybrid_ends_chunk(const conic_hybrid *h, uint32_t cluster) {
  return (uint32_t)(h->n_levels + h->n_clusters) + cluster;
}

conic_hybrid_place conic_hybrid_chunk_place(const conic_hybrid *h, uint32_t chunk) {
  if (chunk < h->n_levels)
    return (conic_hybrid_place){(uint64_t)h->levels[chunk].at * CONIC_HYBRID_UNIT,
                                hybrid_level_bytes(h->flags, &h->levels[chunk])};
  size_t i = chunk - h->n_levels;
  if (i < h->n_clusters)
    return (conic_hybrid_place){(uint64_t)h->clusters[i].frame_at * CONIC_HYBRID_UNIT,
                                conic_hybrid_frame_bytes(&h->clusters[i])};
  i -= h->n_clusters;
  return (conic_hybrid_place){(uint64_t)h->clusters[i].ends_at * CONIC_HYBRID_UNIT,
                              hybrid_ends_bytes(h->flags, &h->clusters[i])};
}

/* --- order --- */

/* How many levels of its kind are coarser than each. */
static void rank_levels(const conic_hybrid *h, const conic_hybrid_cluster *cluster, conic_radix_item *items) {
  uint32_t n[2] = {0, 0};
  for (uint32_t k = cluster->first_level + cluster->n_levels; k-- > cluster->first_level;) {
    uint32_t kind = h->levels[k].kind;
    items[k].key = 3 + 2 * (uint64_t)n[kind]++ + (kind == CONIC_HYBRID_TRIANGLES);
  }
}

conic_status conic_hybrid_order_chunks(const conic_hybrid *h, uint32_t **order) {
  size_t n = conic_hybrid_count_chunks(h);
  conic_radix_item *items;
  conic_status status = conic_memory_allocate_these(h->context, CONIC_ROOM(items, n), CONIC_ROOM(*order, n));
  for (uint32_t i = 0; i < n && status == CONIC_OK; i++) {
    uint32_t key = i < h->n_levels ? 2 : i < h->n_levels + h->n_clusters ? 0 : 1;
    items[i] = (conic_radix_item){key, i};
  }
  for (size_t i = 0; i < h->n_clusters && status == CONIC_OK; i++)
    rank_levels(h, &h->clusters[i], items);
  if (status == CONIC_OK)
    status = conic_radix_sort(h->context, items, n, 34);
  for (size_t i = 0; i < n && status == CONIC_OK; i++)
    (*order)[i] = items[i].value;
  conic_memory_release(h->context, items);
  return status;
}

static uint32_t *chunk_offset(const conic_hybrid *h, conic_hybrid_level *levels, conic_hybrid_cluster *clusters,
                              uint32_t chunk) {
  if (chunk < h->n_levels)
    return &levels[chunk].at;
  size_t i = chunk - h->n_levels;
  return i < h->n_clusters ? &clusters[i].frame_at : &clusters[i - h->n_clusters].ends_at;
}

conic_status conic_hybrid_place_chunks(conic_hybrid *h, conic_hybrid_level *levels, conic_hybrid_cluster *clusters) {
  uint32_t *order;
  conic_status status = conic_hybrid_order_chunks(h, &order);
  h->n_data = 0;
  for (size_t i = 0; i < conic_hybrid_count_chunks(h) && status == CONIC_OK; i++) {
    *chunk_offset(h, levels, clusters, order[i]) = (uint32_t)(h->n_data / CONIC_HYBRID_UNIT);
    h->n_data += conic_hybrid_chunk_place(h, order[i]).n_bytes;
  }
  conic_memory_release(h->context, order);
  return status;
}

conic_status conic_hybrid_check_order(const conic_hybrid *h, const char **wrong) {
  uint32_t *order;
  uint64_t at = 0;
  conic_status status = conic_hybrid_order_chunks(h, &order);
  *wrong = NULL;
  for (size_t i = 0; i < conic_hybrid_count_chunks(h) && status == CONIC_OK && !*wrong; i++) {
    conic_hybrid_place place = conic_hybrid_chunk_place(h, order[i]);
    *wrong = place.at == at && place.n_bytes <= h->n_data - at ? NULL : "chunks out of order";
    at += place.n_bytes;
  }
  if (status == CONIC_OK && !*wrong && at != h->n_data)
    *wrong = "bytes of no chunk";
  conic_memory_release(h->context, order);
  return status;
}

/* --- contents --- */

/* Returns what follows the vertices. */
static const unsigned char *find_vertices(uint32_t flags, size_t n, const unsigned char *chunk,
                                          conic_hybrid_vertices *v) {
  const float *next = (const float *)(const void *)(chunk + CONIC_HYBRID_SUM_BYTES);
  *v = (conic_hybrid_vertices){.position = {NULL}};
  for (int axis = 0; axis < 3; axis++, next += n)
    v->position[axis] = next;
  for (int axis = 0; axis < 3 && flags & CONIC_CHY_NORMALS; axis++, next += n)
    v->normal[axis] = next;
  for (int channel = 0; channel < 3 && flags & CONIC_CHY_COLORS; channel++, next += n)
    v->color[channel] = next;
  for (int k = 0; k < 2 && flags & CONIC_CHY_TEXTURE_COORDINATES; k++, next += n)
    v->texture_coordinate[k] = next;
  return (const unsigned char *)next;
}

static conic_hybrid_piece hybrid_piece_in(uint32_t flags, const conic_hybrid_level *level, const unsigned char *chunk) {
  conic_hybrid_piece piece = {.material = NULL};
  if (level->kind == CONIC_HYBRID_SURFELS) {
    for (size_t k = 0; k < 12; k++)
      piece.surfels[k] = (const float *)(const void *)(chunk + CONIC_HYBRID_SUM_BYTES) + k * level->count;
    return piece;
  }
  const unsigned char *next = find_vertices(flags, level->n_vertices, chunk, &piece.vertices);
  if (flags & CONIC_CHY_MATERIALS) {
    piece.material = (const uint32_t *)(const void *)next;
    next += 4 * (size_t)level->count;
  }
  if (level->n_vertices <= CONIC_HYBRID_NARROW)
    piece.narrow = (const uint16_t(*)[3])(const void *)next;
  else
    piece.wide = (const uint32_t(*)[3])(const void *)next;
  return piece;
}

/* The parts of a chunk in memory, laid out by the level or the cluster. */
static conic_hybrid_vertices hybrid_ends_in(uint32_t flags, const conic_hybrid_cluster *cluster,
                                            const unsigned char *chunk) {
  conic_hybrid_vertices v;
  find_vertices(flags, cluster->n_slots, chunk, &v);
  return v;
}

static conic_hybrid_frame frame_in(const conic_hybrid_cluster *cluster, const unsigned char *chunk) {
  const uint32_t *stages = (const uint32_t *)(const void *)(chunk + CONIC_HYBRID_SUM_BYTES);
  return (conic_hybrid_frame){stages, (const conic_cluster_border *)(const void *)(stages + cluster->n_slots)};
}

const unsigned char *conic_hybrid_chunk(const conic_hybrid *h, uint32_t chunk) {
  return h->data ? h->data + conic_hybrid_chunk_place(h, chunk).at : conic_hybrid_store_bytes(h->store, chunk);
}

conic_hybrid_piece conic_hybrid_piece_of(const conic_hybrid *h, uint32_t level) {
  return hybrid_piece_in(h->flags, &h->levels[level], conic_hybrid_chunk(h, level));
}

conic_hybrid_frame conic_hybrid_frame_of(const conic_hybrid *h, uint32_t cluster) {
  return frame_in(&h->clusters[cluster], conic_hybrid_chunk(h, conic_hybrid_frame_chunk(h, cluster)));
}

conic_hybrid_vertices conic_hybrid_ends_of(const conic_hybrid *h, uint32_t cluster) {
  return hybrid_ends_in(h->flags, &h->clusters[cluster], conic_hybrid_chunk(h, conic_hybrid_ends_chunk(h, cluster)));
}

/* --- as in a file --- */

void conic_hybrid_turn_chunk(const conic_hybrid *h, uint32_t chunk, unsigned char *bytes) {
  size_t n_bytes = (size_t)conic_hybrid_chunk_place(h, chunk).n_bytes, n_words = n_bytes / 4;
  if (chunk < h->n_levels && h->levels[chunk].kind == CONIC_HYBRID_TRIANGLES) {
    conic_hybrid_piece piece = hybrid_piece_in(h->flags, &h->levels[chunk], bytes);
    if (piece.narrow) {
      size_t before = (size_t)((const unsigned char *)piece.narrow - bytes);
      conic_turn_words(bytes + before, (n_bytes - before) / 2, 2);
      n_words = before / 4;
    }
  }
  conic_turn_words(bytes + CONIC_HYBRID_SUM_BYTES, n_words - CONIC_HYBRID_SUM_BYTES / 4, 4);
}

static uint64_t chunk_sum(const unsigned char *bytes, size_t n_bytes) {
  return conic_checksum(bytes + CONIC_HYBRID_SUM_BYTES, n_bytes - CONIC_HYBRID_SUM_BYTES);
}

void conic_hybrid_seal_chunk(unsigned char *bytes, size_t n_bytes) {
  conic_store_64(bytes, chunk_sum(bytes, n_bytes));
}

static const char *level_fault(const conic_hybrid *h, const conic_hybrid_level *level, const unsigned char *bytes) {
  if (level->kind == CONIC_HYBRID_SURFELS)
    return NULL;
  conic_hybrid_piece piece = hybrid_piece_in(h->flags, level, bytes);
  for (size_t i = 0; i < level->count; i++) {
    for (int corner = 0; corner < 3; corner++)
      if (conic_hybrid_corner(&piece, i, corner) >= level->n_vertices)
        return "a corner out of range";
    if (piece.material && piece.material[i] >= h->n_materials)
      return "a material out of range";
  }
  return NULL;
}

/* The borders of a level run over each slot once at most, so that there is never more to put in than there are slots.
 */
static const char *borders_fault(const conic_hybrid *h, uint32_t i_cluster, const conic_hybrid_level *level,
                                 const conic_cluster_border *borders) {
  const conic_hybrid_cluster *cluster = &h->clusters[i_cluster];
  uint64_t n = 0;
  for (size_t i = 0; i < level->n_borders; i++) {
    const conic_cluster_border *border = &borders[level->first_border + i];
    if ((i > 0 && border->edge <= border[-1].edge) || border->edge / 4 >= level->count || border->edge % 4 > 2 ||
        border->from >= cluster->n_slots || border->to >= cluster->n_slots || border->across >= h->n_clusters ||
        border->across == i_cluster)
      return "a border out of range";
    n += border->from < border->to ? border->to - border->from : border->from - border->to;
  }
  return n > cluster->n_slots ? "borders that run over each other" : NULL;
}

static const char *frame_fault(const conic_hybrid *h, uint32_t i_cluster, const unsigned char *bytes) {
  const conic_hybrid_cluster *cluster = &h->clusters[i_cluster];
  conic_hybrid_frame frame = frame_in(cluster, bytes);
  const char *wrong = NULL;
  for (uint32_t k = 0; k < cluster->n_levels && !wrong; k++)
    wrong = borders_fault(h, i_cluster, &h->levels[cluster->first_level + k], frame.borders);
  return wrong;
}

const char *conic_hybrid_take_chunk(const conic_hybrid *h, uint32_t chunk, unsigned char *bytes) {
  size_t n_bytes = (size_t)conic_hybrid_chunk_place(h, chunk).n_bytes;
  if (n_bytes == 0)
    return NULL;
  if (conic_load_64(bytes) != chunk_sum(bytes, n_bytes))
    return "a chunk that is damaged";
  conic_hybrid_turn_chunk(h, chunk, bytes);
  if (chunk < h->n_levels)
    return level_fault(h, &h->levels[chunk], bytes);
  return chunk - h->n_levels < h->n_clusters ? frame_fault(h, chunk - (uint32_t)h->n_levels, bytes) : NULL;
}

/* Whether a slot lies where a corner of a triangle does. */
static int is_at_corner(const conic_hybrid_piece *piece, const conic_hybrid_vertices *ends, uint32_t triangle,
                        uint32_t corner, uint32_t slot) {
  uint32_t vertex = conic_hybrid_corner(piece, triangle, (int)(corner % 3));
  int is_there = 1;
  for (int axis = 0; axis < 3; axis++)
    is_there &= piece->vertices.position[axis][vertex] == ends->position[axis][slot];
  return is_there;
}

const char *conic_hybrid_cluster_fault(const conic_hybrid *h, uint32_t i_cluster) {
  const conic_hybrid_cluster *cluster = &h->clusters[i_cluster];
  if (cluster->n_borders == 0)
    return NULL;
  conic_hybrid_frame frame = conic_hybrid_frame_of(h, i_cluster);
  conic_hybrid_vertices ends = conic_hybrid_ends_of(h, i_cluster);
  for (uint32_t k = cluster->first_level; k < cluster->first_level + cluster->n_levels; k++) {
    const conic_hybrid_level *level = &h->levels[k];
    conic_hybrid_piece piece = conic_hybrid_piece_of(h, k);
    for (size_t i = 0; i < level->n_borders; i++) {
      const conic_cluster_border *b = &frame.borders[level->first_border + i];
      if (!is_at_corner(&piece, &ends, b->edge / 4, b->edge % 4, b->from) ||
          !is_at_corner(&piece, &ends, b->edge / 4, b->edge % 4 + 1, b->to))
        return "a border that is not its triangle's";
    }
  }
  return NULL;
}
