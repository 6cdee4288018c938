/* From a hierarchy's nodes to the entries that drawing knows, and reading its pages. */
#include "core/base/real.h"
#include "lod/layers/draw/layers_octree.h"

/* A place of the index that is being made. */
typedef struct octree_place {
  uint64_t key;
  uint32_t node; /* or CONIC_NO_NODE */
  uint8_t level, has_children;
} octree_place;

typedef struct octree_places {
  octree_place *list; /* by level, then by key */
  size_t n, room;
} octree_places;

CONIC_DEFINE_ORDER_BY_TWO(compare_octree_places, octree_place, level, key)

static octree_place *find_octree_place(const octree_places *places, uint64_t key, uint8_t level) {
  const octree_place wanted = {.key = key, .level = level};
  return bsearch(&wanted, places->list, places->n, sizeof *places->list, compare_octree_places);
}

static uint64_t parent_key(uint64_t key, uint8_t level) {
  int shift = 3 * (CONIC_HIERARCHY_LEVELS + 1 - level);
  return key >> shift << shift;
}

/* Finds every node's parent. Says what is wrong, or null. */
static const char *join_octree_places(const conic_hierarchy *h, octree_places *places, size_t *n_inner) {
  *n_inner = 0;
  if (places->n == 0 || places->list[0].level != 0)
    return "its hierarchy has no root";
  for (size_t i = 1; i < places->n; i++) {
    const octree_place *place = &places->list[i];
    if (compare_octree_places(place - 1, place) == 0)
      return "its hierarchy has a node twice";
    octree_place *parent = find_octree_place(places, parent_key(place->key, place->level), (uint8_t)(place->level - 1));
    if (!parent || h->nodes[parent->node].is_page)
      return "its hierarchy has a node without a parent";
    *n_inner += !parent->has_children;
    parent->has_children = 1;
  }
  return NULL;
}

/* The octants of inner nodes that have no node. */
static void add_octants(octree_places *places) {
  size_t n = places->n;
  for (size_t i = 0; i < n; i++)
    for (uint64_t octant = 0; octant < 8 && places->list[i].has_children; octant++) {
      uint8_t level = (uint8_t)(places->list[i].level + 1);
      uint64_t key = places->list[i].key | octant << 3 * (CONIC_HIERARCHY_LEVELS - level);
      const octree_places nodes = {.list = places->list, .n = n};
      if (!find_octree_place(&nodes, key, level))
        places->list[places->n++] = (octree_place){key, CONIC_NO_NODE, level, 0};
    }
  qsort(places->list, places->n, sizeof *places->list, compare_octree_places);
}

static conic_status make_places(const conic_layers *layers, octree_places *places) {
  const conic_hierarchy *h = layers->octree->hierarchy;
  size_t n_inner;
  places->n = 0;
  places->list = conic_memory_allocate(layers->context, h->n_nodes, sizeof *places->list);
  if (!places->list)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < h->n_nodes; i++)
    if (h->nodes[i].is_page != CONIC_OCTREE_PAGE_DONE)
      places->list[places->n++] = (octree_place){h->nodes[i].key, (uint32_t)i, h->nodes[i].level, 0};
  qsort(places->list, places->n, sizeof *places->list, compare_octree_places);
  const char *wrong = join_octree_places(h, places, &n_inner);
  if (wrong)
    return conic_hierarchy_wrong(h, wrong);
  if (conic_memory_grow(layers->context, &places->list, places->n, places->n + 8 * n_inner, sizeof *places->list) !=
      CONIC_OK)
    return CONIC_ERROR_MEMORY;
  add_octants(places);
  return CONIC_OK;
}

/* The distance of the samples that are drawn down to a level: as the file says, or, where the root's are farther apart,
 * as those show. */
static double spacing_of_level(const conic_layers *layers, int level) {
  double said = layers->octree->hierarchy->spacing, seen = (double)layers->octree->root_spacing;
  return (said > seen ? said : seen) / (double)(1 << level);
}

/* No sample has a larger outline where this level is the finest. */
static float outline_of_level(const conic_layers *layers, int level) {
  return (float)(level == 0 ? 6.0 * spacing_of_level(layers, 0) : 1.5 * spacing_of_level(layers, level - 1));
}

static void bound_place(const conic_layers *layers, const octree_place *place, conic_layers_entry *entry) {
  const conic_hierarchy *h = layers->octree->hierarchy;
  const conic_hierarchy_node cell_node = {.key = place->key, .level = place->level};
  double diagonal2 = 0.0;
  uint32_t cell[3];
  conic_hierarchy_cell(&cell_node, cell);
  for (int axis = 0; axis < 3; axis++) {
    double edge = h->edge[axis] / (double)(1 << place->level);
    entry->center[axis] = (float)(((double)cell[axis] + 0.5) * edge);
    diagonal2 += edge * edge;
  }
  entry->radius = outline_of_level(layers, place->level);
  entry->growth = 1.0f;
  entry->sphere = (float)((0.5 + CONIC_OCTREE_SLACK) * sqrt(diagonal2)) + entry->radius;
  entry->spacing = entry->covering = (float)(h->spacing / (double)(1 << place->level));
  entry->error = entry->spacing;
  entry->axis[2] = 1.0f;
  entry->cone = -1.0f;
}

static void describe_place(const conic_layers *layers, const octree_place *place, conic_layers_entry *entry) {
  memset(entry, 0, sizeof *entry);
  entry->key = place->key;
  entry->level = place->level;
  entry->depth = (uint16_t)(3 * place->level);
  bound_place(layers, place, entry);
  if (place->node == CONIC_NO_NODE)
    return;
  const conic_hierarchy_node *node = &layers->octree->hierarchy->nodes[place->node];
  if (node->is_page)
    return;
  entry->n_samples = node->n_points;
  entry->offset = node->offset;
  entry->n_bytes = (uint32_t)node->n_bytes;
}

/* A number for each sample that does not depend on what else is known: by where the bytes are; where they are a file,
 * by the node's key. */
static uint64_t first_number_of(const conic_layers_entry *entry) {
  uint64_t mixed = (entry->key + entry->level) * UINT64_C(0x9e3779b97f4a7c15);
  return entry->n_bytes ? entry->offset : (mixed ^ mixed >> 31) >> 20;
}

/* What is drawn in each place is its own and its share of what lies above: as much as each of its siblings has. */
static void count_drawn(conic_layers_entry *entries, const octree_places *places) {
  for (size_t i = 0; i < places->n; i++) {
    uint32_t n_nodes = 0, child = entries[i].child;
    if (i == 0)
      entries[i].n_drawn = entries[i].n_samples > 0 ? entries[i].n_samples : 1;
    for (uint32_t k = child; child && k < child + 8; k++)
      n_nodes += places->list[k].node != CONIC_NO_NODE;
    for (uint32_t k = child; child && k < child + 8; k++) {
      int is_node = places->list[k].node != CONIC_NO_NODE;
      uint32_t share = is_node ? entries[i].n_drawn / n_nodes + 1 : 1;
      entries[k].n_drawn = share < UINT32_MAX - entries[k].n_samples ? share + entries[k].n_samples : UINT32_MAX;
    }
  }
  for (size_t i = places->n; i-- > 0;) {
    entries[i].n_place += entries[i].n_samples;
    if (i > 0)
      entries[entries[i].parent].n_place += entries[i].n_place;
  }
}

/* Children follow each other in the order of their parents. */
static void fill_entries(const conic_layers *layers, const octree_places *places, conic_layers_entry *entries) {
  size_t next = 1;
  for (size_t i = 0; i < places->n; i++)
    describe_place(layers, &places->list[i], &entries[i]);
  for (size_t i = 0; i < places->n; i++) {
    if (!places->list[i].has_children)
      continue;
    entries[i].child = (uint32_t)next;
    for (int k = 0; k < 8; k++)
      entries[next++].parent = (uint32_t)i;
  }
  count_drawn(entries, places);
}

/* Room for what is kept of every node. */
static conic_status reserve_nodes(conic_layers *layers) {
  conic_layers_octree *o = layers->octree;
  size_t n = o->hierarchy->n_nodes, had[3];
  memcpy(had, o->nodes_room, sizeof had);
  conic_status status =
      conic_memory_reserve(layers->context, &o->measured, had[0], n, &o->nodes_room[0], sizeof *o->measured);
  for (size_t i = had[0]; i < o->nodes_room[0]; i++)
    o->measured[i] = 0.0f;
  if (status == CONIC_OK)
    status = conic_memory_reserve(layers->context, &o->guides, had[1], n, &o->nodes_room[1], sizeof(void *));
  for (size_t i = had[1]; i < o->nodes_room[1]; i++)
    o->guides[i] = NULL;
  if (status == CONIC_OK)
    status = conic_memory_reserve(layers->context, &o->is_lost, had[2], n, &o->nodes_room[2], sizeof *o->is_lost);
  for (size_t i = had[2]; i < o->nodes_room[2]; i++)
    o->is_lost[i] = 0;
  return status;
}

/* Which number each of the old entries that have a cloud gets. */
static conic_status renumber_store(conic_layers *layers, const uint32_t *node_of, size_t n) {
  conic_layers_octree *o = layers->octree;
  uint32_t *entry_of = conic_memory_allocate_zeroed(layers->context, o->hierarchy->n_nodes, sizeof *entry_of);
  uint32_t *becomes = conic_memory_allocate_zeroed(layers->context, layers->header.n_clouds, sizeof *becomes);
  conic_layers_slot *slots = conic_memory_allocate_zeroed(layers->context, n, sizeof *slots);
  int is_good = entry_of && becomes && slots;
  for (size_t i = 0; i < n && is_good; i++)
    if (node_of[i] != CONIC_NO_NODE)
      entry_of[node_of[i]] = (uint32_t)i;
  for (size_t i = 0; i < layers->header.n_clouds && is_good; i++)
    if (o->node_of[i] != CONIC_NO_NODE)
      becomes[i] = entry_of[o->node_of[i]];
  if (is_good)
    conic_layers_store_renumber(layers, becomes, slots);
  else
    conic_memory_release(layers->context, slots);
  conic_memory_release_these(layers->context, entry_of, becomes);
  return is_good ? CONIC_OK : CONIC_ERROR_MEMORY;
}

/* Takes over an index that is whole. */
static void take_entries(conic_layers *layers, conic_layers_entry *entries, uint32_t *node_of, uint64_t *first,
                         size_t n) {
  conic_layers_header *header = &layers->header;
  conic_memory_release_these(layers->context, layers->entries, layers->first_sample, layers->octree->node_of);
  layers->entries = entries;
  layers->first_sample = first;
  layers->octree->node_of = node_of;
  header->n_clouds = (uint32_t)n;
  header->n_levels = entries[n - 1].level + 1u;
  header->most_samples = header->most_bytes = 0;
  for (size_t i = 0; i < n; i++) {
    header->most_samples = entries[i].n_samples > header->most_samples ? entries[i].n_samples : header->most_samples;
    if (conic_layers_octree_is_page(layers, (uint32_t)i))
      header->n_levels = CONIC_HIERARCHY_LEVELS + 1; /* for all that is known */
  }
}

static conic_status make_index(conic_layers *layers, const octree_places *places) {
  conic_context *context = layers->context;
  conic_layers_entry *entries = conic_memory_allocate(context, places->n, sizeof *entries);
  uint32_t *node_of = conic_memory_allocate(context, places->n, sizeof *node_of);
  uint64_t *first = conic_memory_allocate(context, places->n, sizeof *first);
  conic_status status = entries && node_of && first ? reserve_nodes(layers) : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK) {
    fill_entries(layers, places, entries);
    for (size_t i = 0; i < places->n; i++) {
      node_of[i] = places->list[i].node;
      first[i] = first_number_of(&entries[i]);
    }
    if (layers->store.slots)
      status = renumber_store(layers, node_of, places->n);
  }
  if (status == CONIC_OK) {
    take_entries(layers, entries, node_of, first, places->n);
    return CONIC_OK;
  }
  conic_memory_release_these(context, entries, node_of, first);
  return status;
}

conic_status conic_layers_octree_index(conic_layers *layers) {
  octree_places places = {NULL, 0, 0};
  conic_status status = make_places(layers, &places);
  if (status == CONIC_OK)
    status = make_index(layers, &places);
  conic_memory_release(layers->context, places.list);
  return status;
}
