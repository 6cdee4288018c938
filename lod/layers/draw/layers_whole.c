/* All of a layered point cloud as splats, for what needs every one of them: at once, or place by place. */

#include "lod/layers/draw/layers_gather.h"
#include "lod/layers/draw/layers_octree.h"

CONIC_DEFINE_OPTIONS(conic_layers_region, .low = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL},
                     .high = {HUGE_VAL, HUGE_VAL, HUGE_VAL})

/* Places of a part, and their numbers. */
typedef struct finest {
  conic_layers_cut cut;
  uint32_t *chosen;
  size_t room;
} finest;

/* Whether a node's sphere, wider by a share of its outlines, reaches into the part's box. */
static int meets_part(const conic_layers *layers, const conic_layers_entry *entry, const conic_layers_region *part,
                      double share) {
  double distance2 = 0.0, reach = (double)entry->sphere + share * (double)entry->radius;
  for (int axis = 0; axis < 3; axis++) {
    double at = layers->header.origin[axis] + (double)entry->center[axis];
    double beyond = at < part->low[axis] ? part->low[axis] - at : at > part->high[axis] ? at - part->high[axis] : 0.0;
    distance2 += beyond * beyond;
  }
  return distance2 <= reach * reach;
}

/* One more place, and its number. */
static conic_status list_place(const conic_layers *layers, uint32_t node, finest *list) {
  size_t n = list->cut.n;
  if (n == list->room) {
    size_t room = list->room;
    conic_status status =
        conic_memory_reserve(layers->context, &list->cut.places, n, n + 1, &room, sizeof *list->cut.places);
    if (status == CONIC_OK)
      status = conic_memory_grow(layers->context, &list->chosen, n, room, sizeof *list->chosen);
    if (status != CONIC_OK)
      return status;
    list->room = room;
  }
  memset(&list->cut.places[n], 0, sizeof *list->cut.places);
  list->cut.places[n].node = node;
  list->cut.places[n].n_splats = layers->entries[node].n_drawn;
  list->chosen[n] = (uint32_t)n;
  list->cut.n++;
  return CONIC_OK;
}

/* Finds how large the samples of an octree's places are. */
static conic_status measure_cut(conic_layers *layers, const conic_layers_cut *cut) {
  if (!layers->octree)
    return CONIC_OK;
  unsigned char *needed = conic_memory_allocate(layers->context, layers->header.n_clouds, 1);
  if (!needed)
    return CONIC_ERROR_MEMORY;
  conic_layers_needed(layers, cut, CONIC_PLACE_SHOWN, needed);
  conic_status status = conic_layers_octree_measure(layers, needed);
  conic_memory_release(layers->context, needed);
  return status;
}

/* The part's leaves, or what is fine enough above them, in the order of their keys. */
static conic_status list_finest(conic_layers *layers, const conic_layers_region *part, double share, finest *list) {
  uint32_t open[CONIC_LAYERS_MOST_LEVELS + 7 * CONIC_HIERARCHY_LEVELS] = {0};
  int n_open = 1;
  conic_status status = CONIC_OK;
  while (n_open > 0 && status == CONIC_OK) {
    const uint32_t node = open[--n_open];
    const conic_layers_entry *entry = &layers->entries[node];
    uint32_t child = (double)entry->error <= part->error ? 0 : entry->child;
    if (!meets_part(layers, entry, part, share))
      continue;
    if (child) {
      for (uint32_t i = conic_layers_children(layers); i-- > 0;)
        open[n_open++] = child + i;
      continue;
    }
    status = list_place(layers, node, list);
  }
  return status == CONIC_OK ? measure_cut(layers, &list->cut) : status;
}

static void release_finest(const conic_layers *layers, finest *list) {
  conic_memory_release(layers->context, list->chosen);
  conic_layers_cut_release(layers->context, &list->cut);
}

/* Reads all pages of an octree. */
static conic_status expand_all(conic_layers *layers) {
  conic_layers_expansion all = {.until_s = HUGE_VAL};
  return layers->octree ? conic_layers_octree_expand(layers, NULL, &all) : CONIC_OK;
}

conic_status conic_layers_splats(conic_layers *layers, float cutoff, conic_splats *splats) {
  conic_context *context = layers->context;
  finest list = {.room = 0};
  conic_layers_set set = {0};
  conic_layers_region all;
  conic_layers_region_init(&all);
  memset(splats, 0, sizeof *splats);
  conic_status status = expand_all(layers);
  if (status == CONIC_OK)
    status = list_finest(layers, &all, 0.0, &list);
  conic_layers_gathering gathering = {
      .cut = &list.cut, .chosen = list.chosen, .n_chosen = list.cut.n, .cutoff = cutoff, .until_s = HUGE_VAL};
  if (status == CONIC_OK)
    status = conic_layers_gather(layers, &gathering, &set);
  memcpy(splats->origin, set.splats.origin, sizeof splats->origin);
  if (status == CONIC_OK)
    status = conic_splats_append(context, splats, &set.splats);
  release_finest(layers, &list);
  conic_layers_set_release(context, &set);
  return status;
}

/* So many leaves' samples are handed over together. */
enum { LEAVES_A_BATCH = 16 };

static conic_status read_cut(conic_layers *layers, float cutoff, const conic_layers_cut *cut, const uint32_t *chosen,
                             conic_batch_receiver *receive, void *cookie) {
  conic_layers_set set = {0};
  conic_status status = CONIC_OK;
  for (size_t first = 0; first < cut->n && status == CONIC_OK; first += LEAVES_A_BATCH) {
    size_t left = cut->n - first;
    conic_layers_gathering gathering = {.cut = cut,
                                        .chosen = chosen + first,
                                        .n_chosen = left < LEAVES_A_BATCH ? left : LEAVES_A_BATCH,
                                        .cutoff = cutoff,
                                        .until_s = HUGE_VAL};
    status = conic_layers_gather(layers, &gathering, &set);
    if (status == CONIC_OK && set.splats.count > 0)
      status = receive(cookie, &set.splats);
    if (status == CONIC_OK)
      status = conic_progress(layers->context, "read", (double)first / (double)cut->n);
  }
  conic_layers_set_release(layers->context, &set);
  return status;
}

conic_status conic_layers_read_samples(conic_layers *layers, float cutoff, const conic_layers_region *given,
                                       conic_batch_receiver *receive, void *cookie) {
  finest list = {.room = 0};
  conic_layers_region part;
  conic_layers_region_init(&part);
  if (given && (!conic_options_take(&part, given) || !(part.error >= 0.0)))
    return conic_fail(layers->context, CONIC_ERROR_ARGUMENT, "%s: a part of it that has no meaning", layers->name);
  conic_status status = expand_all(layers);
  if (status == CONIC_OK)
    status = conic_layers_keep(layers, part.keep);
  if (status != CONIC_OK)
    return status;
  status = list_finest(layers, &part, 0.0, &list);
  if (status == CONIC_OK)
    status = read_cut(layers, cutoff, &list.cut, list.chosen, receive, cookie);
  release_finest(layers, &list);
  return status;
}

conic_status conic_layers_gather_part(conic_layers *layers, float cutoff, const conic_layers_region *part, size_t most,
                                      conic_layers_set **set) {
  const double share = 0.5; /* filters widen what is drawn */
  finest list = {.room = 0};
  conic_status status = expand_all(layers);
  if (!layers->set)
    layers->set = conic_memory_allocate_zeroed(layers->context, 1, sizeof *layers->set);
  *set = layers->set;
  if (status == CONIC_OK)
    status = layers->set ? list_finest(layers, part, share, &list) : CONIC_ERROR_MEMORY;
  conic_layers_gathering gathering = {.cut = &list.cut,
                                      .chosen = list.chosen,
                                      .n_chosen = list.cut.n,
                                      .cutoff = cutoff,
                                      .until_s = HUGE_VAL,
                                      .most = most};
  if (status == CONIC_OK)
    status = conic_layers_gather(layers, &gathering, layers->set);
  release_finest(layers, &list);
  return status;
}

void conic_layers_continue(const conic_layers *layers, conic_layers_options *options) {
  const conic_layers_header *header = &layers->header;
  options->cloud_size = header->cloud_size;
  options->quantum = header->quantum;
  options->quantum_in_spacings = 0;
  options->has_corner = 1;
  memcpy(options->corner, header->origin, sizeof options->corner);
  for (int axis = 0; axis < 3; axis++)
    options->up[axis] = (double)header->up[axis];
  options->epsg = header->epsg;
  options->is_unoriented |= (header->flags & CONIC_LAYERS_UNORIENTED) != 0;
  options->keeps_all |= conic_layers_schema_find(&header->schema, CONIC_LAYERS_AXES) >= 0;
}

conic_status conic_layers_find_georeference(const conic_layers *layers, conic_georeference *reference) {
  memset(reference, 0, sizeof *reference);
  const unsigned epsg = layers->header.epsg;
  return layers->octree ? conic_georeference_copy(layers->context, &layers->octree->hierarchy->reference, reference)
         : epsg         ? conic_georeference_of_epsg(layers->context, epsg, reference)
                        : CONIC_OK;
}
