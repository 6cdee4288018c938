#include "lod/layers/draw/layers_cut.h"

#include "core/base/base.h"

/* A walk down the tree: what is yet to be looked at. Each level adds one node at most, of an octree seven. */
enum { MOST_OPEN = 7 * CONIC_HIERARCHY_LEVELS + 2 };
typedef struct tree_walk {
  const conic_layers *layers;
  const conic_layers_view *view;
  const conic_layers_wish *wish;
  uint32_t open[MOST_OPEN > CONIC_LAYERS_MOST_LEVELS + 2 ? MOST_OPEN : CONIC_LAYERS_MOST_LEVELS + 2];
  int n_open;
} tree_walk;

/* Why a node is not refined. */
typedef enum verdict { VERDICT_REFINE, VERDICT_FINE, VERDICT_STUCK } verdict;

static verdict judge_node(const tree_walk *w, const conic_layers_entry *entry, const conic_layers_sight *sight) {
  const unsigned char *is_in = w->wish->is_in;
  if (entry->child == 0 || sight->error_px <= w->wish->error_px)
    return VERDICT_FINE;
  if (w->wish->most_levels && entry->level + 1 >= w->wish->most_levels)
    return VERDICT_STUCK;
  for (uint32_t i = 0; is_in && i < conic_layers_children(w->layers); i++)
    if (!is_in[entry->child + i])
      return VERDICT_STUCK;
  return VERDICT_REFINE;
}

static void begin_walk(tree_walk *w) {
  w->open[0] = 0;
  w->n_open = 1;
}

/* The next node of the cut: 1, or 0 at the end. */
static int next_place(tree_walk *w, uint32_t *node, conic_layers_sight *sight, verdict *why) {
  while (w->n_open > 0) {
    *node = w->open[--w->n_open];
    const conic_layers_entry *entry = &w->layers->entries[*node];
    if (!conic_layers_look(w->view, entry, sight))
      continue;
    *why = judge_node(w, entry, sight);
    if (*why != VERDICT_REFINE)
      return 1;
    for (uint32_t i = conic_layers_children(w->layers); i-- > 0;)
      w->open[w->n_open++] = entry->child + i;
  }
  return 0;
}

static conic_status find_turned(const conic_layers *layers, const conic_layers_view *view, conic_layers_cut *cut) {
  if (!view->cull_back || !layers->facings)
    return CONIC_OK;
  if (conic_memory_reserve(layers->context, &cut->turned, 0, cut->n, &cut->turned_room, sizeof *cut->turned) !=
      CONIC_OK)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < cut->n; i++)
    conic_layers_find_turned(layers->facings, view, &layers->entries[cut->places[i].node], &cut->turned[i]);
  return CONIC_OK;
}

conic_status conic_layers_find_cut(const conic_layers *layers, const conic_layers_view *view,
                                   const conic_layers_wish *wish, conic_layers_cut *cut) {
  tree_walk w = {.layers = layers, .view = view, .wish = wish};
  conic_layers_place place;
  verdict why;
  cut->n = 0;
  cut->n_splats = cut->n_coarser = 0;
  cut->coarser_px = 0.0;
  cut->n_root = wish->n_root;
  memset(&place, 0, sizeof place);
  begin_walk(&w);
  while (next_place(&w, &place.node, &place.sight, &why)) {
    conic_status status = conic_memory_append(layers->context, &cut->places, &cut->n, &cut->room, &place, sizeof place);
    if (status != CONIC_OK)
      return status;
    cut->n_splats += layers->entries[place.node].n_drawn;
    if (why != VERDICT_STUCK)
      continue;
    cut->n_coarser++;
    cut->coarser_px = place.sight.error_px > cut->coarser_px ? place.sight.error_px : cut->coarser_px;
  }
  return find_turned(layers, view, cut);
}

void conic_layers_cut_release(conic_context *context, conic_layers_cut *cut) {
  conic_memory_release(context, cut->places);
  conic_memory_release(context, cut->turned);
  memset(cut, 0, sizeof *cut);
}

/* Splats of the cut for an error, counted up to a little over `most`. */
static uint64_t count_cut(const conic_layers *layers, const conic_layers_view *view, const conic_layers_wish *wish,
                          uint64_t most) {
  tree_walk w = {.layers = layers, .view = view, .wish = wish};
  conic_layers_sight sight;
  uint64_t n = 0;
  uint32_t node;
  verdict why;
  begin_walk(&w);
  while (n <= most && next_place(&w, &node, &sight, &why))
    n += layers->entries[node].n_drawn;
  return n;
}

/* Doubles that are not negative order like their bits. */
uint64_t conic_layers_fit_budget(const conic_layers *layers, const conic_layers_view *view, int most_levels,
                                 uint64_t budget, double *error_px) {
  conic_layers_wish wish = {.error_px = 0.0, .most_levels = most_levels};
  uint64_t low = 0, high = conic_bits_of_double(HUGE_VAL);
  *error_px = 0.0;
  if (count_cut(layers, view, &wish, budget) <= budget)
    return 0;
  wish.error_px = *error_px = HUGE_VAL;
  if (count_cut(layers, view, &wish, budget) > budget)
    return budget;
  while (high - low > 1) {
    uint64_t middle = low + (high - low) / 2;
    wish.error_px = conic_double_of_bits(middle);
    if (count_cut(layers, view, &wish, budget) <= budget)
      high = middle;
    else
      low = middle;
  }
  *error_px = conic_double_of_bits(high);
  return 0;
}

size_t conic_layers_mark_needed(const conic_layers *layers, const conic_layers_place *place, unsigned char *needed) {
  size_t n = 0;
  for (uint32_t node = place->node; !needed[node]; node = layers->entries[node].parent, n++)
    needed[node] = 1;
  return n;
}

size_t conic_layers_needed(const conic_layers *layers, const conic_layers_cut *cut, conic_place_state last,
                           unsigned char *needed) {
  size_t n = 0;
  memset(needed, 0, layers->header.n_clouds);
  for (size_t i = 0; i < cut->n; i++)
    if (cut->places[i].state <= last)
      n += conic_layers_mark_needed(layers, &cut->places[i], needed);
  return n;
}
