#include "lod/hybrid_plan.h"

#include <math.h>
#include <string.h>

#include "core/memory.h"

/* Rounds in which each patch is thought over; and how much less a picture of both kinds must promise to be preferred to
 * one of a single kind. */
enum { ROUNDS = 4 };
static const double margin = 0.97;

/* A patch in sight. Infinite costs are of a kind that is not good enough. */
typedef struct candidate {
  conic_hybrid_offer offers[2]; /* by kind */
  uint32_t first_link, n_links;
  uint8_t kind;
} candidate;

/* Two patches side by side: what triangles of the one take more if the other is drawn as surfels, for then their border
 * has all of its vertices. Kept with both: with the one in `own_ns`, with the other in `other_ns`. */
typedef struct link {
  uint32_t candidate;
  double own_ns, other_ns;
} link;

typedef struct planning {
  const conic_hybrid *hybrid;
  size_t n;
  const uint32_t *patches;
  candidate *candidates;
  uint32_t *of_patch; /* of each of the model's patches, where it is in sight: its candidate, else n */
  size_t n_links;
  link *links;
  uint8_t *kinds; /* what was found before */
  double both_ns; /* what a picture of both kinds takes more than its parts */
} planning;

static const conic_hybrid_level *triangles_of(const planning *p, size_t i) {
  const conic_hybrid_patch *patch = &p->hybrid->patches[p->patches[i]];
  return &p->hybrid->levels[patch->first_level + p->candidates[i].offers[CONIC_HYBRID_TRIANGLES].level];
}

static void ask(planning *p, const conic_hybrid_camera *view, double error_px) {
  for (size_t i = 0; i < p->n; i++) {
    const conic_hybrid_patch *patch = &p->hybrid->patches[p->patches[i]];
    candidate *c = &p->candidates[i];
    conic_hybrid_offers(p->hybrid, view, patch, error_px, c->offers);
    c->kind = c->offers[CONIC_HYBRID_SURFELS].cost_ns < c->offers[CONIC_HYBRID_TRIANGLES].cost_ns;
  }
}

/* The links of one candidate, one for each neighbour: `last` has for each candidate the link that names it. */
static void add_links(planning *p, uint32_t i, uint32_t *last) {
  const conic_hybrid_level *level = triangles_of(p, i);
  candidate *c = &p->candidates[i];
  c->first_link = (uint32_t)p->n_links;
  for (size_t k = 0; k < level->n_borders; k++) {
    const conic_hybrid_border *border = &p->hybrid->borders[level->first_border + k];
    uint32_t other = p->of_patch[border->across];
    uint32_t n = border->from < border->to ? border->to - border->from : border->from - border->to;
    if (other == p->n)
      continue;
    if (last[other] < c->first_link || last[other] >= p->n_links) {
      last[other] = (uint32_t)p->n_links;
      p->links[p->n_links++] = (link){.candidate = other};
    }
    p->links[last[other]].own_ns += CONIC_HYBRID_STITCH_NS * ((double)n - 1.0);
  }
  c->n_links = (uint32_t)p->n_links - c->first_link;
}

/* What the other one's triangles take more, as far as it has a link too. */
static void match_links(planning *p) {
  for (uint32_t i = 0; i < p->n; i++)
    for (size_t k = p->candidates[i].first_link; k < p->candidates[i].first_link + p->candidates[i].n_links; k++) {
      const candidate *other = &p->candidates[p->links[k].candidate];
      for (size_t m = other->first_link; m < other->first_link + other->n_links; m++)
        if (p->links[m].candidate == i)
          p->links[k].other_ns = p->links[m].own_ns;
    }
}

static conic_status find_links(planning *p) {
  size_t n_borders = 0;
  for (size_t i = 0; i < p->hybrid->n_patches; i++)
    p->of_patch[i] = (uint32_t)p->n;
  for (size_t i = 0; i < p->n; i++) {
    p->of_patch[p->patches[i]] = (uint32_t)i;
    n_borders += triangles_of(p, i)->n_borders;
  }
  uint32_t *last = conic_memory_allocate_zeroed(p->hybrid->context, p->n, sizeof *last);
  p->links = conic_memory_allocate(p->hybrid->context, n_borders, sizeof *p->links);
  if (last && p->links) {
    for (uint32_t i = 0; i < p->n; i++)
      add_links(p, i, last);
    match_links(p);
  }
  conic_memory_release(p->hybrid->context, last);
  return last && p->links ? CONIC_OK : CONIC_ERROR_MEMORY;
}

/* What a candidate takes as one kind and as the other, its neighbours being what they are. */
static void weigh(const planning *p, const candidate *c, double costs[2]) {
  costs[0] = c->offers[0].cost_ns;
  costs[1] = c->offers[1].cost_ns;
  for (size_t k = 0; k < c->n_links; k++) {
    const link *l = &p->links[c->first_link + k];
    if (p->candidates[l->candidate].kind == CONIC_HYBRID_SURFELS)
      costs[CONIC_HYBRID_TRIANGLES] += l->own_ns;
    else
      costs[CONIC_HYBRID_SURFELS] += l->other_ns;
  }
}

/* Each patch in turn becomes what is cheaper, until none does. */
static void improve(planning *p) {
  int is_changed = 1;
  for (int round = 0; round < ROUNDS && is_changed; round++) {
    is_changed = 0;
    for (size_t i = 0; i < p->n; i++) {
      candidate *c = &p->candidates[i];
      double costs[2];
      weigh(p, c, costs);
      if (costs[!c->kind] < costs[c->kind]) {
        c->kind = !c->kind;
        is_changed = 1;
      }
    }
  }
}

static int is_mixed(const planning *p) {
  for (size_t i = 1; i < p->n; i++)
    if (p->candidates[i].kind != p->candidates[0].kind)
      return 1;
  return 0;
}

static double total(const planning *p) {
  double sum = is_mixed(p) ? p->both_ns : 0.0;
  for (size_t i = 0; i < p->n; i++) {
    const candidate *c = &p->candidates[i];
    sum += c->offers[c->kind].cost_ns;
    for (size_t k = 0; k < c->n_links && c->kind == CONIC_HYBRID_TRIANGLES; k++)
      if (p->candidates[p->links[c->first_link + k].candidate].kind == CONIC_HYBRID_SURFELS)
        sum += p->links[c->first_link + k].own_ns;
  }
  return sum;
}

/* All of one kind, where that is good enough. */
static void take_kind(planning *p, uint8_t kind) {
  for (size_t i = 0; i < p->n; i++)
    p->candidates[i].kind = p->candidates[i].offers[kind].cost_ns < HUGE_VAL ? kind : !kind;
}

static void keep_if_less(planning *p, double sum, double *least) {
  if (!(sum < *least))
    return;
  *least = sum;
  for (size_t i = 0; i < p->n; i++)
    p->kinds[i] = p->candidates[i].kind;
}

/* From what each would be by itself; or triangles alone, or surfels wherever they are good enough. */
static void settle(planning *p) {
  double least = HUGE_VAL;
  improve(p);
  keep_if_less(p, total(p) / margin, &least);
  for (uint8_t kind = 0; kind < 2; kind++) {
    take_kind(p, kind);
    keep_if_less(p, total(p), &least);
  }
  for (size_t i = 0; i < p->n; i++)
    p->candidates[i].kind = p->kinds[i];
}

/* Whether all of one kind takes no more than the cheaper of both for each patch, with what a picture of both kinds
 * takes more: then no better one has to be looked for. */
static int is_settled(planning *p) {
  double sums[2] = {0.0, 0.0}, least = p->both_ns;
  for (size_t i = 0; i < p->n; i++) {
    const candidate *c = &p->candidates[i];
    least += c->offers[c->kind].cost_ns;
    for (int kind = 0; kind < 2; kind++)
      sums[kind] += c->offers[kind].cost_ns;
  }
  uint8_t kind = sums[CONIC_HYBRID_SURFELS] < sums[CONIC_HYBRID_TRIANGLES];
  if (is_mixed(p) && !(sums[kind] <= least / margin))
    return 0;
  take_kind(p, kind);
  return 1;
}

conic_status conic_hybrid_plan(const conic_hybrid *hybrid, const conic_hybrid_camera *view, double error_px,
                               const uint32_t *patches, size_t n, uint32_t *levels) {
  conic_context *context = hybrid->context;
  planning p = {.hybrid = hybrid, .n = n, .patches = patches, .both_ns = view->n_pixels * CONIC_HYBRID_BOTH_NS};
  p.candidates = conic_memory_allocate_zeroed(context, n, sizeof *p.candidates);
  p.of_patch = conic_memory_allocate(context, hybrid->n_patches, sizeof *p.of_patch);
  p.kinds = conic_memory_allocate(context, n, sizeof *p.kinds);
  conic_status status = p.candidates && p.of_patch && p.kinds ? CONIC_OK : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK) {
    ask(&p, view, error_px);
    if (!is_settled(&p)) {
      status = find_links(&p);
      if (status == CONIC_OK)
        settle(&p);
    }
  }
  for (size_t i = 0; i < n && status == CONIC_OK; i++)
    levels[i] = p.candidates[i].offers[p.candidates[i].kind].level;
  conic_memory_release(context, p.links);
  conic_memory_release(context, p.kinds);
  conic_memory_release(context, p.of_patch);
  conic_memory_release(context, p.candidates);
  return status;
}
