/* Models that are put together of others. Their chunks lie in a file without a name until they are written. */
#include "lod/hybrid/model/hybrid_store.h"

#include "core/files/disk.h"
#include "lod/hybrid/model/hybrid_chunks.h"

/* Steps between black and white. */
static const float all_steps = 100.0f;

void conic_hybrid_pile_release(conic_context *context, conic_hybrid_pile *pile) {
  if (!pile)
    return;
  if (pile->map)
    conic_disk_unmap(pile->map, pile->map_bytes);
  conic_pile_end(&pile->file);
  conic_memory_release_these(context, pile->levels, pile->joined, pile->clusters, pile->nodes, pile);
}

void conic_hybrid_pile_rest(const conic_hybrid_pile *pile) {
  conic_disk_give_back(pile->map, pile->map_bytes);
}

/* Appends a chunk; *at becomes where it lies. The clusters across borders get the numbers that they have in all. */
static conic_status append_chunk(conic_context *context, conic_hybrid_pile *pile, const conic_hybrid *part,
                                 uint32_t chunk, uint32_t *at) {
  size_t n_bytes = (size_t)conic_hybrid_chunk_place(part, chunk).n_bytes, cluster = chunk - part->n_levels;
  const unsigned char *bytes = conic_hybrid_chunk(part, chunk);
  unsigned char *turned = NULL;
  uint64_t offset;
  *at = 0;
  if (n_bytes == 0)
    return CONIC_OK;
  if (chunk >= part->n_levels && cluster < part->n_clusters) {
    turned = conic_memory_copy(context, bytes, n_bytes);
    if (!turned)
      return CONIC_ERROR_MEMORY;
    conic_cluster_border *borders =
        (conic_cluster_border *)(void *)(turned + CONIC_HYBRID_SUM_BYTES + 4 * (size_t)part->clusters[cluster].n_slots);
    for (size_t i = 0; i < part->clusters[cluster].n_borders; i++)
      borders[i].across += (uint32_t)pile->n_clusters;
    bytes = turned;
  }
  conic_status status = conic_pile_append(&pile->file, bytes, n_bytes, &offset);
  conic_memory_release(context, turned);
  *at = (uint32_t)(offset / CONIC_HYBRID_UNIT);
  if (status == CONIC_OK && offset / CONIC_HYBRID_UNIT > UINT32_MAX)
    status = conic_fail(context, CONIC_ERROR_ARGUMENT, "the model is too much for a file");
  return status;
}

static conic_status make_pile_room(conic_context *context, conic_hybrid_pile *p, const conic_hybrid *part) {
  conic_status status = conic_memory_reserve(context, &p->levels, p->n_levels, p->n_levels + part->n_levels,
                                             &p->levels_room, sizeof *p->levels);
  if (status == CONIC_OK)
    status = conic_memory_reserve(context, &p->joined, p->n_joined, p->n_joined + part->n_levels, &p->joined_room,
                                  sizeof *p->joined);
  if (status == CONIC_OK)
    status = conic_memory_reserve(context, &p->clusters, p->n_clusters, p->n_clusters + part->n_clusters,
                                  &p->clusters_room, sizeof *p->clusters);
  if (status == CONIC_OK)
    status = conic_memory_reserve(context, &p->nodes, p->n_nodes, p->n_nodes + part->n_nodes, &p->nodes_room,
                                  sizeof *p->nodes);
  return status;
}

static void add_part_nodes(conic_hybrid_pile *p, const conic_hybrid *part, size_t n_of_clusters) {
  for (size_t i = 0; i < part->n_nodes; i++) {
    conic_hybrid_node node = part->nodes[i];
    node.begin += (uint32_t)p->n_clusters;
    node.end += (uint32_t)p->n_clusters;
    node.next += (uint32_t)p->n_nodes;
    node.first_level = (uint32_t)(node.first_level - n_of_clusters + p->n_joined);
    p->nodes[p->n_nodes + i] = node;
  }
}

conic_status conic_hybrid_pile_add(conic_context *context, conic_hybrid_pile *p, const conic_hybrid *part) {
  const conic_hybrid_cluster *last = &part->clusters[part->n_clusters - 1];
  size_t n_of_clusters = (size_t)last->first_level + last->n_levels;
  conic_status status = make_pile_room(context, p, part);
  for (uint32_t i = 0; i < part->n_levels && status == CONIC_OK; i++) {
    conic_hybrid_level *level =
        i < n_of_clusters ? &p->levels[p->n_levels + i] : &p->joined[p->n_joined + i - n_of_clusters];
    *level = part->levels[i];
    status = append_chunk(context, p, part, i, &level->at);
  }
  for (uint32_t i = 0; i < part->n_clusters && status == CONIC_OK; i++) {
    conic_hybrid_cluster *cluster = &p->clusters[p->n_clusters + i];
    *cluster = part->clusters[i];
    cluster->first_level += (uint32_t)p->n_levels;
    status = append_chunk(context, p, part, conic_hybrid_frame_chunk(part, i), &cluster->frame_at);
    if (status == CONIC_OK)
      status = append_chunk(context, p, part, conic_hybrid_ends_chunk(part, i), &cluster->ends_at);
  }
  add_part_nodes(p, part, n_of_clusters);
  p->n_levels += n_of_clusters;
  p->n_joined += part->n_levels - n_of_clusters;
  p->n_clusters += part->n_clusters;
  p->n_nodes += part->n_nodes;
  return status;
}

/* --- nodes over parts --- */

conic_status conic_hybrid_pile_begin_node(conic_context *context, conic_hybrid_pile *p, uint32_t *node) {
  const conic_hybrid_node empty = {.begin = 0};
  *node = (uint32_t)p->n_nodes;
  return conic_memory_append(context, &p->nodes, &p->n_nodes, &p->nodes_room, &empty, sizeof empty);
}

static double area_below(const conic_hybrid_pile *p, const conic_hybrid_node *node) {
  double area = 0.0;
  for (uint32_t i = node->begin; i < node->end; i++)
    area += (double)p->clusters[i].area;
  return area;
}

/* A disc that hides the whole sphere. How far its centre is from the mesh follows from what is said of its children's.
 * Colours may be anything. */
static void join_points(const conic_hybrid_pile *p, conic_hybrid_node *node, const conic_hybrid_node *children[2]) {
  double off = HUGE_VAL, areas[2], color[3] = {0.0, 0.0, 0.0};
  for (int k = 0; k < 2; k++) {
    const conic_hybrid_node *child = children[k];
    double way[3];
    areas[k] = area_below(p, child);
    for (int axis = 0; axis < 3; axis++) {
      way[axis] = (double)child->bound.center[axis] - (double)node->bound.center[axis];
      color[axis] += areas[k] * (double)child->point.color[axis];
    }
    double own = conic_length(way) + (double)child->point.error - (double)child->point.radius;
    off = own < off ? own : off;
  }
  double radius = (double)node->bound.radius * (1.0 + 1e-6), area = areas[0] + areas[1];
  if (!(children[0]->point.radius > 0.0f && children[1]->point.radius > 0.0f && area > 0.0))
    return;
  node->point = (conic_hybrid_point){.radius = (float)radius,
                                     .error = (float)((radius + off) * (1.0 + 1e-6)),
                                     .change = all_steps,
                                     .smear = all_steps * (float)radius};
  for (int channel = 0; channel < 3; channel++)
    node->point.color[channel] = (float)(color[channel] / area);
}

/* Closes the place of a node up. */
static void drop_node(conic_hybrid_pile *p, uint32_t node) {
  p->n_nodes--;
  for (size_t i = node; i < p->n_nodes; i++) {
    p->nodes[i] = p->nodes[i + 1];
    p->nodes[i].next--;
  }
}

void conic_hybrid_pile_end_node(conic_hybrid_pile *p, uint32_t i) {
  conic_hybrid_node *node = &p->nodes[i];
  if (i + 1 >= p->n_nodes || p->nodes[i + 1].next == p->n_nodes) {
    drop_node(p, i);
    return;
  }
  const conic_hybrid_node *children[2] = {&p->nodes[i + 1], &p->nodes[p->nodes[i + 1].next]};
  node->bound = conic_hybrid_join(&children[0]->bound, &children[1]->bound);
  node->begin = children[0]->begin;
  node->end = children[1]->end;
  node->next = (uint32_t)p->n_nodes;
  join_points(p, node, children);
}

/* --- all --- */

conic_status conic_hybrid_pile_finish(conic_hybrid_pile *p, conic_hybrid *h) {
  size_t n = p->n_levels + p->n_joined;
  if (p->n_clusters + p->n_nodes > UINT32_MAX || n + 2 * p->n_clusters > UINT32_MAX)
    return conic_fail(h->context, CONIC_ERROR_ARGUMENT, "the model is too much for a file");
  conic_status status =
      conic_memory_reserve(h->context, &p->levels, p->n_levels, n, &p->levels_room, sizeof *p->levels);
  if (status != CONIC_OK)
    return status;
  /* Levels of nodes follow those of clusters; those of a node that has none begin where the next one's do. */
  uint32_t next = (uint32_t)p->n_levels;
  for (size_t i = 0; i < p->n_nodes; i++) {
    p->nodes[i].first_level = next;
    next += p->nodes[i].n_levels;
  }
  if (p->n_joined > 0)
    memcpy(p->levels + p->n_levels, p->joined, p->n_joined * sizeof *p->joined);
  h->levels = p->levels;
  h->clusters = p->clusters;
  h->nodes = p->nodes;
  h->n_levels = n;
  h->n_clusters = p->n_clusters;
  h->n_nodes = p->n_nodes;
  for (size_t i = 0; i < n; i++)
    *(h->levels[i].kind == CONIC_HYBRID_TRIANGLES ? &h->n_triangles : &h->n_surfels) += h->levels[i].count;
  h->n_data = p->map_bytes = (size_t)p->file.n_bytes;
  h->data = p->map = conic_disk_map(p->file.file.descriptor, p->map_bytes);
  return p->map
             ? CONIC_OK
             : conic_fail(h->context, CONIC_ERROR_IO, "%s: cannot map a temporary file beside it", p->file.file.path);
}
