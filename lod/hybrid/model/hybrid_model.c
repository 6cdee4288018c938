#include "lod/hybrid/model/hybrid_model.h"

#include "core/splats/near.h"
#include "lod/hybrid/model/hybrid_layout.h"
#include "lod/hybrid/model/hybrid_store.h"

void conic_hybrid_destroy(conic_hybrid *hybrid) {
  if (!hybrid)
    return;
  for (size_t i = 0; hybrid->materials && i < hybrid->n_materials; i++)
    conic_texture_destroy(hybrid->materials[i].texture);
  conic_hybrid_store_close(hybrid->store);
  conic_hybrid_pile_release(hybrid->context, hybrid->pile);
  conic_memory_release_these(hybrid->context, hybrid->materials, hybrid->owned);
  conic_mapping_close(hybrid->context, &hybrid->mapping);
  conic_memory_release(hybrid->context, hybrid);
}

conic_status conic_hybrid_describe(const conic_hybrid *hybrid, conic_hybrid_info *info) {
  memset(info, 0, sizeof *info);
  info->n_clusters = hybrid->n_clusters;
  info->n_all_triangles = hybrid->n_triangles;
  info->n_all_surfels = hybrid->n_surfels;
  info->n_vertices = hybrid->n_vertices;
  info->n_nodes = hybrid->n_nodes;
  info->cutoff = hybrid->cutoff;
  info->splat_length = hybrid->splat_length;
  info->n_bytes = conic_hybrid_file_bytes(hybrid);
  for (size_t i = 0; i < hybrid->n_clusters; i++) {
    const conic_hybrid_cluster *cluster = &hybrid->clusters[i];
    const conic_hybrid_level *built = &hybrid->levels[cluster->first_level + cluster->built];
    int is_surfels = built->kind == CONIC_HYBRID_SURFELS;
    info->n_levels += cluster->n_levels;
    info->n_surfel_clusters += (size_t)is_surfels;
    *(is_surfels ? &info->n_surfels : &info->n_triangles) += built->count;
  }
  info->has_colors = hybrid->flags & CONIC_CHY_COLORS || hybrid->n_materials > 0;
  info->n_node_levels = hybrid->n_levels - info->n_levels;
  for (size_t i = 0; i < hybrid->n_materials; i++)
    info->n_textures += hybrid->material_list[i].width > 0;
  for (int axis = 0; axis < 3; axis++) {
    info->minimum[axis] = hybrid->origin[axis] + (double)hybrid->low[axis];
    info->maximum[axis] = hybrid->origin[axis] + (double)hybrid->high[axis];
  }
  info->near_z = conic_near_of_box(info->minimum, info->maximum);
  return CONIC_OK;
}

double conic_hybrid_reach(const conic_hybrid *hybrid, const conic_hybrid_cluster *cluster) {
  float reach = 0.0f;
  for (uint32_t k = 0; k < cluster->n_levels; k++) {
    float own = hybrid->levels[cluster->first_level + k].reach;
    reach = own > reach ? own : reach;
  }
  return (double)reach;
}

/* --- structure --- */

static int is_length(float value) {
  return value >= 0.0f && value < HUGE_VALF;
}

static const char *wrong_level(const conic_hybrid_level *level) {
  if (level->kind > CONIC_HYBRID_SURFELS)
    return "a level of no known kind";
  if (level->count < 1 || level->count > UINT32_MAX / 4)
    return "a level without its triangles or surfels";
  if (level->kind == CONIC_HYBRID_SURFELS ? level->n_vertices > 0 : level->n_vertices < 1)
    return "a level without its vertices";
  if (level->n_borders > 0 && level->kind != CONIC_HYBRID_TRIANGLES)
    return "a level without its borders";
  if (!is_length(level->error) || !is_length(level->reach) || !is_length(level->cover) || !is_length(level->spread) ||
      !is_length(level->change) || !is_length(level->smear))
    return "a level's error, reach or extent out of range";
  return NULL;
}

/* What a cluster's levels left out follows each other, too. */
static const char *wrong_levels(const conic_hybrid *h, const conic_hybrid_cluster *cluster) {
  uint64_t n_borders = 0;
  for (uint32_t k = 0; k < cluster->n_levels; k++) {
    const conic_hybrid_level *level = &h->levels[cluster->first_level + k];
    const char *wrong = wrong_level(level);
    if (wrong)
      return wrong;
    if (level->first_border != (level->kind == CONIC_HYBRID_TRIANGLES ? n_borders : 0))
      return "a level without its borders";
    n_borders += level->n_borders;
  }
  return n_borders == cluster->n_borders ? NULL : "borders of no level";
}

static int is_bound(const conic_hybrid_bound *b) {
  for (int axis = 0; axis < 3; axis++)
    if (!(b->center[axis] - b->center[axis] == 0.0f) || !(b->axis[axis] >= -1.001f && b->axis[axis] <= 1.001f))
      return 0;
  return is_length(b->radius) && b->cone >= -1.0f && b->cone <= 1.0f;
}

/* Every level belongs to just one cluster, in their order. */
static const char *wrong_clusters(const conic_hybrid *h) {
  size_t next = 0;
  for (size_t i = 0; i < h->n_clusters; i++) {
    const conic_hybrid_cluster *cluster = &h->clusters[i];
    if (cluster->first_level != next || cluster->n_levels < 1 || cluster->n_levels > h->n_levels - next ||
        cluster->built >= cluster->n_levels)
      return "a patch without its levels";
    if (!is_bound(&cluster->bound) || !is_length(cluster->area))
      return "a patch's bounds out of range";
    const char *wrong = wrong_levels(h, cluster);
    if (wrong)
      return wrong;
    next += cluster->n_levels;
  }
  return NULL;
}

/* The nodes' levels come after those of the clusters, in their order. */
static const char *wrong_node_levels(const conic_hybrid *h) {
  const conic_hybrid_cluster *last = &h->clusters[h->n_clusters - 1];
  size_t next = (size_t)last->first_level + last->n_levels;
  for (size_t i = 0; i < h->n_nodes; i++) {
    const conic_hybrid_node *node = &h->nodes[i];
    const conic_hybrid_point *point = &node->point;
    if (node->first_level != next || node->n_levels > h->n_levels - next)
      return "a node without its levels";
    for (size_t k = 0; k < node->n_levels; k++) {
      if (h->levels[next + k].n_borders > 0 || h->levels[next + k].first_border > 0)
        return "a node's level with borders";
      const char *wrong = wrong_level(&h->levels[next + k]);
      if (wrong)
        return wrong;
    }
    if (!is_length(point->radius) || !is_length(point->error) || !is_length(point->change) || !is_length(point->smear))
      return "a node's point out of range";
    next += node->n_levels;
  }
  return next == h->n_levels ? NULL : "levels of no patch or node";
}

/* A walk goes from a node to the one after it, or past its subtree; and what is left of the clusters is always what the
 * walk has not come by. */
static const char *wrong_nodes(const conic_hybrid *h) {
  size_t next_cluster = 0;
  for (size_t i = 0; i < h->n_nodes; i++) {
    const conic_hybrid_node *node = &h->nodes[i];
    if (node->next <= i || node->next > h->n_nodes || node->begin >= node->end || node->end > h->n_clusters ||
        !is_bound(&node->bound))
      return "a node that is none";
    if (node->begin != next_cluster)
      return "nodes out of order";
    if (node->next == i + 1)
      next_cluster = node->end;
    else if (h->nodes[i + 1].begin != node->begin || h->nodes[node->next - 1].end != node->end)
      return "nodes that are not within each other";
  }
  return h->n_nodes > 0 && next_cluster == h->n_clusters && h->nodes[0].next == h->n_nodes &&
                 h->nodes[0].end == h->n_clusters
             ? NULL
             : "patches of no node";
}

/* Every subtree is made of those of its node's children. The first that is not ends the search: so none is passed
 * twice. */
static const char *wrong_children(const conic_hybrid *h) {
  for (size_t i = 0; i < h->n_nodes; i++) {
    size_t child = i + 1;
    while (child < h->nodes[i].next)
      child = h->nodes[child].next;
    if (child != h->nodes[i].next)
      return "nodes that are not within each other";
  }
  return NULL;
}

static const char *wrong_counts(const conic_hybrid *h) {
  uint64_t counts[2] = {0, 0};
  for (size_t i = 0; i < h->n_levels; i++)
    counts[h->levels[i].kind] += h->levels[i].count;
  return counts[CONIC_HYBRID_TRIANGLES] == h->n_triangles && counts[CONIC_HYBRID_SURFELS] == h->n_surfels
             ? NULL
             : "other numbers of triangles or surfels than its levels";
}

const char *conic_hybrid_structure(const conic_hybrid *h) {
  const char *wrong = wrong_clusters(h);
  if (!wrong)
    wrong = wrong_nodes(h);
  if (!wrong)
    wrong = wrong_children(h);
  if (!wrong)
    wrong = wrong_node_levels(h);
  if (!wrong)
    wrong = wrong_counts(h);
  for (size_t i = 0; i < h->n_materials && !wrong; i++) {
    const conic_chy_material *m = &h->material_list[i];
    uint64_t n = (uint64_t)m->width * m->height;
    if (m->width > 65535 || m->height > 65535 || (m->width == 0) != (m->height == 0) || m->wrap > 1 ||
        n > h->n_texels || m->first_texel > h->n_texels - n)
      wrong = "a texture without its texels";
  }
  return wrong;
}
