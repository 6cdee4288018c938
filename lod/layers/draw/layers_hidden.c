/* Occlusion culling: which places of a cut are hidden by others. No bit of the picture changes by it. */
#include "core/base/real.h"
#include "lod/layers/draw/layers_gather.h"

#include "lod/layers/draw/layers_horizon.h"

/* A share of the places is drawn before the rest is looked at again: the first so small a part of all splats, each
 * further one so much larger. */
enum { FIRST_SHARE = 32, NEXT_SHARE = 16 };

/* What finding out how deep a splat hides takes, as a share of drawing it. */
#define WORTHWHILE 0.7

typedef struct hiding {
  conic_layers *layers;
  conic_renderer *renderer;
  const conic_layers_view *view;
  const conic_camera *camera;
  const conic_render_options *render;
  conic_layers_cut *cut;
  conic_layers_set *set;
  conic_horizon horizon;
  uint32_t *by_depth, *chosen;
  double until_s;
} hiding;

double conic_layers_depth_complexity(const conic_layers *layers, const conic_layers_view *view,
                                     const conic_layers_cut *cut) {
  enum { COLUMNS = 64 };
  unsigned char is_met[COLUMNS * COLUMNS] = {0};
  double area_px = 0.0, met_px = 0.0;
  double spacing = layers->header.spacing, cell_px = (double)view->width * (double)view->height / sizeof is_met;
  for (size_t i = 0; i < cut->n; i++) {
    const conic_layers_sight *sight = &cut->places[i].sight;
    const conic_layers_entry *entry = conic_layers_place_entry(layers, &cut->places[i]);
    double distance = sight->distance + (double)entry->sphere, scale = view->greatest_focal / distance;
    if (!(distance > 0.0))
      continue;
    area_px += 0.5 * (double)entry->n_place * spacing * spacing * scale * scale;
    int x = (int)((double)(sight->pixels.x_begin + sight->pixels.x_end) / 2.0 / view->width * COLUMNS);
    int y = (int)((double)(sight->pixels.y_begin + sight->pixels.y_end) / 2.0 / view->height * COLUMNS);
    is_met[(y < COLUMNS ? y : COLUMNS - 1) * COLUMNS + (x < COLUMNS ? x : COLUMNS - 1)] = 1;
  }
  for (size_t i = 0; i < sizeof is_met; i++)
    met_px += is_met[i] ? cell_px : 0.0;
  return met_px > 0.0 ? area_px / met_px : 0.0;
}

/* What is seen of a place behind what was drawn so far. */
static void judge_place(const hiding *h, conic_layers_place *place) {
  const conic_layers_entry *entry = conic_layers_place_entry(h->layers, place);
  const conic_layers_sight *s = &place->sight;
  double hides = (double)conic_horizon_least(&h->horizon, &s->pixels);
  double offset = conic_layers_hidden_offset(h->view, entry, s, hides);
  place->state = CONIC_PLACE_SHOWN;
  if (offset == HUGE_VAL)
    return;
  place->offset = offset;
  int is_hidden = offset == 0.0 || conic_layers_least_offset(h->view, entry) > offset;
  place->state = is_hidden ? CONIC_PLACE_HIDDEN : CONIC_PLACE_GRAZING;
}

static int is_nearer(const conic_layers_place *a, const conic_layers_place *b) {
  return a->sight.near_iz > b->sight.near_iz;
}

/* Front to back; a merge sort, since equals keep their order and nothing else may decide. `other` has room for n. */
static void sort_by_depth(const conic_layers_place *places, uint32_t *order, uint32_t *other, size_t n) {
  if (n < 2)
    return;
  size_t half = n / 2, a = 0, b = half;
  sort_by_depth(places, order, other, half);
  sort_by_depth(places, order + half, other, n - half);
  for (size_t i = 0; i < n; i++)
    other[i] = b == n || (a < half && !is_nearer(&places[order[b]], &places[order[a]])) ? order[a++] : order[b++];
  memcpy(order, other, n * sizeof *order);
}

CONIC_DEFINE_ORDER_OF(compare_place_numbers, uint32_t)

static conic_status draw_chosen(hiding *h, size_t n_chosen) {
  conic_layers_gathering gathering = {
      .cut = h->cut, .chosen = h->chosen, .n_chosen = n_chosen, .view = h->view, .until_s = h->until_s};
  gathering.cutoff = h->render->kernel.cutoff;
  gathering.camera = h->camera;
  qsort(h->chosen, n_chosen, sizeof *h->chosen, compare_place_numbers); /* as they are in the cut */
  conic_status status = conic_layers_gather(h->layers, &gathering, h->set);
  if (status == CONIC_OK)
    status = conic_render_hiding(h->renderer, &h->set->splats, h->camera, h->render, h->horizon.pixels);
  if (status == CONIC_OK)
    conic_horizon_update(h->layers->context, &h->horizon);
  return status;
}

static uint64_t splats_of(const hiding *h, size_t i) {
  const conic_layers_place *place = &h->cut->places[h->by_depth[i]];
  return place->state == CONIC_PLACE_SHOWN ? place->n_splats : 0;
}

/* Looks at the places from `begin` on again. Returns how many splats of them are shown. */
static uint64_t judge_rest(hiding *h, size_t begin) {
  uint64_t n_splats = 0;
  for (size_t i = begin; i < h->cut->n; i++) {
    judge_place(h, &h->cut->places[h->by_depth[i]]);
    n_splats += splats_of(h, i);
  }
  return n_splats;
}

/* Chooses the next places that are shown, up to so many splats. Returns where those that were not looked at begin. */
static size_t choose_next(hiding *h, size_t begin, uint64_t most, size_t *n_chosen, uint64_t *n_splats) {
  *n_splats = 0;
  *n_chosen = 0;
  for (; begin < h->cut->n && *n_splats < most; begin++) {
    uint64_t n = splats_of(h, begin);
    if (n > 0)
      h->chosen[(*n_chosen)++] = h->by_depth[begin];
    *n_splats += n;
  }
  return begin;
}

/* Draws shares as long as they hide more than they cost. One of the last two must. */
static conic_status draw_shares(hiding *h) {
  conic_status status = CONIC_OK;
  uint64_t room = conic_layers_drawing_bytes(h->layers) / CONIC_LAYERS_SPLAT_BYTES + 1;
  uint64_t rest = judge_rest(h, 0), n_splats;
  size_t begin = 0, n_chosen;
  int n_useless = 0;
  for (int i = 0; rest > 0 && n_useless < 2 && status == CONIC_OK; i++) {
    uint64_t most = h->cut->n_splats / (i ? NEXT_SHARE : FIRST_SHARE) + 1;
    begin = choose_next(h, begin, most < room ? most : room, &n_chosen, &n_splats);
    status = draw_chosen(h, n_chosen);
    uint64_t left = status == CONIC_OK ? judge_rest(h, begin) : 0, hidden = rest - n_splats - left;
    n_useless = (double)hidden < WORTHWHILE * (double)n_splats ? n_useless + 1 : 0;
    rest = left;
  }
  return status;
}

static conic_status hide(hiding *h, uint32_t *spare) {
  for (size_t i = 0; i < h->cut->n; i++)
    h->by_depth[i] = (uint32_t)i;
  sort_by_depth(h->cut->places, h->by_depth, spare, h->cut->n);
  conic_status status = draw_shares(h);
  for (size_t i = 0; i < h->cut->n && status == CONIC_OK; i++)
    judge_place(h, &h->cut->places[i]);
  return status;
}

conic_status conic_layers_hide(conic_layers *layers, conic_renderer *renderer, const conic_layers_view *view,
                               const conic_camera *camera, const conic_render_options *render, double until_s,
                               conic_layers_cut *cut, conic_layers_set *set) {
  conic_context *context = layers->context;
  hiding h = {.layers = layers,
              .renderer = renderer,
              .view = view,
              .camera = camera,
              .render = render,
              .cut = cut,
              .set = set,
              .until_s = until_s};
  conic_status status = CONIC_OK;
  if (!conic_renderer_has_parts(renderer)) {
    status = layers->hider ? CONIC_OK : conic_renderer_create(context, &layers->hider);
    h.renderer = layers->hider;
  }
  if (status == CONIC_OK)
    status = conic_horizon_open(context, camera->width, camera->height, &h.horizon);
  uint32_t *order = conic_memory_allocate(context, 3 * cut->n, sizeof *order);
  if (status == CONIC_OK && order) {
    h.by_depth = order;
    h.chosen = order + cut->n;
    status = hide(&h, order + 2 * cut->n);
  } else
    status = CONIC_ERROR_MEMORY;
  conic_memory_release(context, order);
  conic_horizon_close(context, &h.horizon);
  return status;
}
