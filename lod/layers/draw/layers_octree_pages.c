/* Reading the pages of a hierarchy that a picture comes to. */

#include "lod/layers/draw/layers_octree.h"

typedef struct page_reading {
  conic_layers *layers;
  conic_layers_expansion *expansion;
  size_t n_asked;
} page_reading;

static conic_status ask_for_page(page_reading *r, uint32_t node) {
  const conic_hierarchy *h = r->layers->octree->hierarchy;
  conic_range range = {.priority = node, .id = node};
  h->kind->locate(h, &h->nodes[node], &range);
  if (!conic_ranges_holds(h->pages, &range))
    return CONIC_ERROR_INPUT;
  range.id = node;
  return conic_ranges_request(h->pages, &range);
}

/* What a page told of must lie in its own place, one node in that itself. */
static const char *check_page(const conic_hierarchy *h, const conic_hierarchy_node *page, size_t first) {
  int has_own = 0;
  for (size_t i = first; i < h->n_nodes; i++) {
    const conic_hierarchy_node *node = &h->nodes[i];
    if (node->level < page->level || (node->key ^ page->key) >> 3 * (CONIC_HIERARCHY_LEVELS - page->level))
      return "its page of the hierarchy tells of nodes that are not below it";
    if (node->level == page->level && node->is_page)
      return "its page of the hierarchy leads to itself";
    has_own |= node->level == page->level;
  }
  return has_own ? NULL : "its page of the hierarchy does not tell of itself";
}

static const char *take_page_bytes(conic_layers *layers, uint32_t node, const unsigned char *bytes, size_t n_bytes) {
  conic_hierarchy *h = layers->octree->hierarchy;
  const conic_hierarchy_node page = h->nodes[node];
  size_t first = h->n_nodes;
  const char *wrong = h->kind->take_page(h, &page, bytes, n_bytes);
  if (!wrong)
    wrong = check_page(h, &page, first);
  if (wrong)
    h->n_nodes = first;
  else
    h->nodes[node].is_page = CONIC_OCTREE_PAGE_DONE;
  return wrong;
}

static conic_status miss_page(page_reading *r, uint32_t node, conic_status status, const char *reason) {
  conic_layers *layers = r->layers;
  const conic_hierarchy_node *page = &layers->octree->hierarchy->nodes[node];
  conic_layers_expansion *e = r->expansion;
  uint32_t cell[3];
  conic_hierarchy_cell(page, cell);
  layers->octree->is_lost[node] = 1;
  e->n_missing++;
  e->n_damaged += status == CONIC_ERROR_INPUT;
  if (status == CONIC_ERROR_INPUT ? !e->tolerates_damage : !e->may_miss)
    return conic_fail(layers->context, status, "%s: cannot read node %u-%u-%u-%u: %s", layers->name, page->level,
                      cell[0], cell[1], cell[2], reason);
  if (status == CONIC_ERROR_INPUT && e->n_damaged == 1)
    conic_log(layers->context, CONIC_LOG_WARNING, "%s: node %u-%u-%u-%u: %s; what is damaged is drawn coarser",
              layers->name, page->level, cell[0], cell[1], cell[2], reason);
  return CONIC_OK;
}

/* What is wrong is asked for once again. */
static conic_status take_page_answer(page_reading *r, const conic_range_answer *answer) {
  conic_layers_octree *o = r->layers->octree;
  if (answer->status != CONIC_OK)
    return miss_page(r, answer->id, answer->status, answer->reason);
  const char *wrong = take_page_bytes(r->layers, answer->id, answer->bytes, answer->n_bytes);
  if (wrong && r->layers->is_remote && r->layers->access.n_retries > 0 && o->is_lost[answer->id] == 0) {
    o->is_lost[answer->id] = 2;
    return ask_for_page(r, answer->id);
  }
  return wrong ? miss_page(r, answer->id, CONIC_ERROR_INPUT, wrong) : CONIC_OK;
}

static conic_status wait_for_pages(page_reading *r) {
  conic_layers *layers = r->layers;
  conic_ranges *pages = layers->octree->hierarchy->pages;
  conic_status status = CONIC_OK;
  while (conic_ranges_pending(pages) > 0 && status == CONIC_OK) {
    conic_range_answer answer;
    double left = r->expansion->until_s - conic_seconds_now();
    if (!(left > 0.0))
      break;
    if (conic_ranges_next(pages, left < 0.1 ? left : 0.1, &answer)) {
      status = take_page_answer(r, &answer);
      if (answer.status == CONIC_OK)
        conic_ranges_release(pages, &answer);
    }
    if (status == CONIC_OK && layers->is_remote)
      status = conic_progress(layers->context, "fetch", 0.0);
  }
  return status;
}

conic_status conic_layers_octree_read_pages(conic_layers *layers, const uint32_t *entries, size_t n,
                                            conic_layers_expansion *expansion) {
  page_reading r = {.layers = layers, .expansion = expansion};
  conic_layers_octree *o = layers->octree;
  conic_ranges *pages = o->hierarchy->pages;
  conic_status status = CONIC_OK;
  for (size_t i = 0; i < n && status == CONIC_OK; i++) {
    status = ask_for_page(&r, o->node_of[entries[i]]);
    if (status == CONIC_ERROR_INPUT)
      status = miss_page(&r, o->node_of[entries[i]], status, "its page of the hierarchy lies outside the file");
  }
  if (status == CONIC_OK)
    status = wait_for_pages(&r);
  int is_late = conic_ranges_pending(pages) > 0;
  conic_ranges_cancel(pages);
  for (size_t i = 0; i < n && status == CONIC_OK && is_late; i++) {
    uint32_t node = o->node_of[entries[i]];
    if (o->hierarchy->nodes[node].is_page == 1 && o->is_lost[node] != 1)
      status = miss_page(&r, node, CONIC_ERROR_IO, "its page of the hierarchy did not come in time");
  }
  return status;
}

/* Lists the entries that are but pages and not given up: of a cut, or all. */
static size_t list_pages(const conic_layers *layers, const conic_layers_cut *cut, uint32_t *list) {
  size_t n = 0, most = cut ? cut->n : layers->header.n_clouds;
  for (size_t i = 0; i < most; i++) {
    uint32_t entry = cut ? cut->places[i].node : (uint32_t)i;
    if (conic_layers_octree_is_page(layers, entry) && layers->octree->is_lost[layers->octree->node_of[entry]] != 1)
      list[n++] = entry;
  }
  return n;
}

static conic_status find_pages(conic_layers *layers, const conic_layers_view *view, const conic_layers_expansion *e,
                               conic_layers_cut *cut) {
  conic_layers_wish wish = {.error_px = e->error_px, .most_levels = e->most_levels};
  conic_status status = CONIC_OK;
  if (e->budget)
    status = conic_layers_fit_budget(layers, view, &wish, e->budget, &wish.error_px, &wish.n_root);
  return status == CONIC_OK ? conic_layers_find_cut(layers, view, &wish, cut) : status;
}

conic_status conic_layers_octree_expand(conic_layers *layers, const conic_layers_view *view,
                                        conic_layers_expansion *expansion) {
  conic_layers_cut cut = {0};
  conic_status status = CONIC_OK;
  expansion->n_missing = expansion->n_damaged = 0;
  memset(layers->octree->is_lost, 0, layers->octree->hierarchy->n_nodes);
  while (status == CONIC_OK) {
    size_t n = 0;
    uint32_t *list = conic_memory_allocate(layers->context, layers->header.n_clouds, sizeof *list);
    status = !list ? CONIC_ERROR_MEMORY : view ? find_pages(layers, view, expansion, &cut) : CONIC_OK;
    if (status == CONIC_OK)
      n = list_pages(layers, view ? &cut : NULL, list);
    if (n > 0)
      status = conic_layers_octree_read_pages(layers, list, n, expansion);
    if (status == CONIC_OK && n > 0)
      status = conic_layers_octree_index(layers);
    conic_memory_release(layers->context, list);
    if (n == 0)
      break;
  }
  conic_layers_cut_release(layers->context, &cut);
  return status;
}

/* --- all of it, node by node --- */

typedef conic_status cloud_function(conic_layers *layers, uint32_t cloud, void *data);

/* Loads cloud after cloud; `visit` may be null. */
static conic_status visit_clouds(conic_layers *layers, int tolerates, cloud_function *visit, void *data,
                                 uint64_t *n_damaged) {
  conic_layers_expansion all = {.until_s = HUGE_VAL, .tolerates_damage = tolerates};
  conic_status status = conic_layers_octree_expand(layers, NULL, &all);
  *n_damaged = all.n_damaged;
  for (uint32_t i = 0; i < layers->header.n_clouds && status == CONIC_OK; i++) {
    conic_layers_loading loading = {
        .clouds = &i, .n = 1, .until_s = HUGE_VAL, .may_miss = tolerates, .tolerates_damage = tolerates};
    if (layers->entries[i].n_samples == 0)
      continue;
    status = conic_layers_store_load(layers, &loading);
    *n_damaged += loading.n_damaged;
    if (status == CONIC_OK && visit && layers->store.slots[i].cloud)
      status = visit(layers, i, data);
    if (status == CONIC_OK)
      conic_layers_store_unpin(layers, &loading);
    if (status == CONIC_OK)
      status = conic_progress(layers->context, "read", (double)i / (double)layers->header.n_clouds);
  }
  return status;
}

typedef struct stream_target {
  conic_batch_receiver *receive;
  void *cookie;
} stream_target;

static conic_status stream_cloud(conic_layers *layers, uint32_t cloud, void *data) {
  const stream_target *target = data;
  const conic_layers_cloud *from = layers->store.slots[cloud].cloud;
  conic_splats batch;
  memset(&batch, 0, sizeof batch);
  batch.count = from->count;
  memcpy(batch.origin, layers->header.origin, sizeof batch.origin);
  for (int axis = 0; axis < 3; axis++) {
    batch.position[axis] = from->position[axis];
    batch.color[axis] = from->color[axis];
  }
  return target->receive(target->cookie, &batch);
}

conic_status conic_layers_stream(conic_layers *layers, conic_batch_receiver *receive, void *cookie) {
  stream_target target = {receive, cookie};
  uint64_t n_damaged;
  if (!layers->octree)
    return conic_fail(layers->context, CONIC_ERROR_UNSUPPORTED, "%s: its samples are no raw points", layers->name);
  return visit_clouds(layers, 0, stream_cloud, &target, &n_damaged);
}

conic_status conic_layers_count_damaged(conic_layers *layers, uint64_t *n_damaged) {
  *n_damaged = 0;
  return layers->octree ? visit_clouds(layers, 1, NULL, NULL, n_damaged) : CONIC_OK;
}
