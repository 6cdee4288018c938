#include "lod/layers/draw/layers_cut.h"

#include "lod/planner/plan.h"

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

typedef struct layers_opening {
  const conic_layers *layers;
  const conic_layers_view *view;
  int most_levels;
} layers_opening;

/* A node that is yet to be looked at, and what is above it. */
typedef struct budget_place {
  uint32_t node;
  double px;        /* the least of the errors above */
  size_t i_opening; /* of the node above; SIZE_MAX: none */
} budget_place;

static size_t open_places(const void *data, double low_px, conic_plan_opening *openings, uint64_t *n_first) {
  const layers_opening *o = data;
  const conic_layers *layers = o->layers;
  const conic_layers_wish wish = {.error_px = low_px, .most_levels = o->most_levels};
  const tree_walk w = {.layers = layers, .view = o->view, .wish = &wish};
  budget_place open[sizeof w.open / sizeof *w.open] = {{0, HUGE_VAL, SIZE_MAX}};
  size_t n = 0;
  *n_first = 0;
  for (int n_open = 1; n_open > 0;) {
    const budget_place place = open[--n_open];
    const conic_layers_entry *entry = &layers->entries[place.node];
    conic_layers_sight sight;
    if (!conic_layers_look(o->view, entry, &sight))
      continue;
    if (place.i_opening == SIZE_MAX)
      *n_first = entry->n_drawn;
    else
      openings[place.i_opening].change += entry->n_drawn;
    if (judge_node(&w, entry, &sight) != VERDICT_REFINE)
      continue;
    double px = sight.error_px < place.px ? sight.error_px : place.px;
    for (uint32_t i = conic_layers_children(layers); i-- > 0;)
      open[n_open++] = (budget_place){entry->child + i, px, n};
    openings[n++] = (conic_plan_opening){px, -(int64_t)entry->n_drawn};
  }
  return n;
}

conic_status conic_layers_fit_budget(const conic_layers *layers, const conic_layers_view *view, int most_levels,
                                     uint64_t budget, double *error_px, uint64_t *n_root) {
  const layers_opening opening = {layers, view, most_levels};
  const conic_plan_tree tree = {&opening, layers->header.n_clouds, open_places};
  conic_status status = conic_plan_fit_tree(layers->context, &tree, budget, error_px);
  *n_root = status == CONIC_OK && !(*error_px < HUGE_VAL) && layers->entries[0].n_drawn > budget ? budget : 0;
  return status;
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
