#include "lod/layers/draw/layers_cut.h"

#include "lod/planner/plan.h"

/* What is drawn of a node: nothing, its stand-ins, its samples as they are fine enough, or as they cannot be finer; or
 * what is below it. */
typedef enum node_choice { UNSEEN, STANDING, FINE, STUCK, OPENED } node_choice;

/* Each level adds one node at most, of an octree seven. */
enum {
  MOST_BELOW = 7 * CONIC_HIERARCHY_LEVELS + 2,
  MOST_OPEN = MOST_BELOW > CONIC_LAYERS_MOST_LEVELS + 2 ? MOST_BELOW : CONIC_LAYERS_MOST_LEVELS + 2
};

typedef struct cut_walk {
  const conic_layers *layers;
  const conic_layers_view *view;
  conic_layers_wish wish;
  double *px;             /* a cloud or stand-ins: the error on the screen; below 0: out of sight; NaN: not known yet */
  unsigned char *choices; /* a node */
} cut_walk;

static conic_status begin_walk(const conic_layers *layers, const conic_layers_view *view, const conic_layers_wish *wish,
                               cut_walk *w) {
  size_t n = conic_layers_all(layers);
  *w = (cut_walk){.layers = layers, .view = view, .wish = *wish};
  conic_status status = conic_memory_allocate_these(layers->context, CONIC_ROOM(w->px, n), CONIC_ROOM(w->choices, n));
  for (size_t i = 0; i < n && status == CONIC_OK; i++)
    w->px[i] = NAN;
  return status;
}

static void end_walk(const cut_walk *w) {
  conic_memory_release_these(w->layers->context, w->px, w->choices);
}

static double error_px(const cut_walk *w, uint32_t cloud) {
  conic_layers_sight sight;
  if (isnan(w->px[cloud]))
    w->px[cloud] = conic_layers_look(w->view, &w->layers->entries[cloud], &sight) ? sight.error_px : -1.0;
  return w->px[cloud];
}

static int is_stuck(const cut_walk *w, const conic_layers_entry *entry) {
  const unsigned char *is_in = w->wish.is_in;
  if (w->wish.most_levels && entry->level + 1 >= w->wish.most_levels)
    return 1;
  for (uint32_t i = 0; is_in && i < conic_layers_children(w->layers); i++)
    if (!is_in[entry->child + i])
      return 1;
  return 0;
}

/* Whether the node's samples are hardly finer than its leaves' stand-ins are: these look better, being filtered. */
static int is_as_coarse(const conic_layers_entry *entry) {
  return (uint64_t)entry->n_drawn * entry->n_drawn <= 2 * entry->n_place * entry->n_stand_ins;
}

static uint64_t choose_node(const cut_walk *w, uint32_t node, uint64_t enough);

/* Opens the node, unless its samples are fine enough and no more than what that takes. */
static uint64_t choose_below(const cut_walk *w, uint32_t node, int is_fine, uint64_t enough) {
  const conic_layers_entry *entry = &w->layers->entries[node];
  uint64_t n = 0;
  enough = is_fine && entry->n_drawn < enough ? entry->n_drawn : enough;
  for (uint32_t i = 0; i < conic_layers_children(w->layers) && n < enough; i++)
    n += choose_node(w, entry->child + i, enough - n);
  int is_better = is_fine && n >= entry->n_drawn;
  w->choices[node] = is_better ? FINE : OPENED;
  return is_better ? entry->n_drawn : n;
}

/* Chooses how the node is drawn. Returns how many splats that takes; or, where there are at least `enough`, some number
 * no less than that. */
static uint64_t choose_node(const cut_walk *w, uint32_t node, uint64_t enough) {
  const conic_layers_entry *entry = &w->layers->entries[node];
  double px = error_px(w, node);
  int may_stand_in = w->wish.may_stand_in && entry->n_stand_ins, is_fine = px <= w->wish.error_px;
  w->choices[node] = UNSEEN;
  if (px < 0.0)
    return 0;
  w->choices[node] = STANDING;
  if (may_stand_in &&
      (error_px(w, w->layers->header.n_clouds + node) <= w->wish.error_px || (entry->child && is_stuck(w, entry))))
    return entry->n_stand_ins;
  w->choices[node] = FINE;
  if (entry->child == 0 || (is_fine && !may_stand_in))
    return entry->n_drawn;
  w->choices[node] = STUCK;
  if (is_stuck(w, entry))
    return entry->n_drawn;
  is_fine = is_fine && !(w->wish.prefers_stand_ins && is_as_coarse(entry));
  return choose_below(w, node, is_fine, enough);
}

static conic_status append_place(const cut_walk *w, uint32_t node, conic_layers_cut *cut) {
  const conic_layers *layers = w->layers;
  const conic_layers_entry *entry = &layers->entries[node];
  int is_standing = w->choices[node] == STANDING;
  conic_layers_place place;
  memset(&place, 0, sizeof place);
  place.node = node;
  place.stand_ins = is_standing ? layers->header.n_clouds + node : 0;
  place.n_splats = is_standing ? entry->n_stand_ins : entry->n_drawn;
  conic_layers_look(w->view, conic_layers_place_entry(layers, &place), &place.sight);
  cut->n_splats += place.n_splats;
  if (w->choices[node] == STUCK) {
    cut->n_coarser++;
    cut->coarser_px = place.sight.error_px > cut->coarser_px ? place.sight.error_px : cut->coarser_px;
  }
  return conic_memory_append(layers->context, &cut->places, &cut->n, &cut->room, &place, sizeof place);
}

static conic_status find_turned(const conic_layers *layers, const conic_layers_view *view, conic_layers_cut *cut) {
  if (!view->cull_back || !layers->facings)
    return CONIC_OK;
  if (conic_memory_reserve(layers->context, &cut->turned, 0, cut->n, &cut->turned_room, sizeof *cut->turned) !=
      CONIC_OK)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < cut->n; i++)
    conic_layers_find_turned(layers->facings, view, conic_layers_place_entry(layers, &cut->places[i]), &cut->turned[i]);
  return CONIC_OK;
}

conic_status conic_layers_find_cut(const conic_layers *layers, const conic_layers_view *view,
                                   const conic_layers_wish *wish, conic_layers_cut *cut) {
  uint32_t open[MOST_OPEN] = {0};
  int n_open = 1;
  cut_walk w;
  cut->n = 0;
  cut->n_splats = cut->n_coarser = 0;
  cut->coarser_px = 0.0;
  cut->n_root = wish->n_root;
  conic_status status = begin_walk(layers, view, wish, &w);
  if (status == CONIC_OK)
    choose_node(&w, 0, UINT64_MAX);
  while (n_open > 0 && status == CONIC_OK) {
    uint32_t node = open[--n_open];
    if (w.choices[node] == OPENED)
      for (uint32_t i = conic_layers_children(layers); i-- > 0;)
        open[n_open++] = layers->entries[node].child + i;
    else if (w.choices[node] != UNSEEN)
      status = append_place(&w, node, cut);
  }
  end_walk(&w);
  return status == CONIC_OK ? find_turned(layers, view, cut) : status;
}

void conic_layers_cut_release(conic_context *context, conic_layers_cut *cut) {
  conic_memory_release_these(context, cut->places, cut->turned);
  memset(cut, 0, sizeof *cut);
}

/* NOLINTNEXTLINE(readability-non-const-parameter): other walks reach an error */
static uint64_t count_splats(void *data, double error_px, double *reached_px) {
  cut_walk *w = data;
  (void)reached_px;
  w->wish.error_px = error_px;
  return choose_node(w, 0, UINT64_MAX);
}

conic_status conic_layers_fit_budget(const conic_layers *layers, const conic_layers_view *view,
                                     const conic_layers_wish *wish, uint64_t budget, double *error_px,
                                     uint64_t *n_root) {
  double reached_px;
  cut_walk w;
  conic_status status = begin_walk(layers, view, wish, &w);
  *error_px = 0.0;
  *n_root = 0;
  if (status == CONIC_OK && count_splats(&w, 0.0, &reached_px) > budget &&
      !conic_plan_fit(count_splats, &w, budget, 0.0, error_px)) {
    *error_px = HUGE_VAL;
    *n_root = budget;
  }
  end_walk(&w);
  return status;
}

size_t conic_layers_mark_needed(const conic_layers *layers, const conic_layers_place *place, unsigned char *needed) {
  size_t n = 0;
  if (place->stand_ins) {
    n = !needed[place->stand_ins];
    needed[place->stand_ins] = 1;
    return n;
  }
  for (uint32_t node = place->node; !needed[node]; node = layers->entries[node].parent, n++)
    needed[node] = 1;
  return n;
}

size_t conic_layers_needed(const conic_layers *layers, const conic_layers_cut *cut, conic_place_state last,
                           unsigned char *needed) {
  size_t n = 0;
  memset(needed, 0, conic_layers_all(layers));
  for (size_t i = 0; i < cut->n; i++)
    if (cut->places[i].state <= last)
      n += conic_layers_mark_needed(layers, &cut->places[i], needed);
  return n;
}
