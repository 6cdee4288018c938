#include "lod/hybrid/draw/hybrid_choose.h"

#include "core/base/base.h"
#include "lod/hybrid/model/hybrid_chunks.h"

/* Rounds in which each cluster is thought over; and how much less a picture of both kinds must promise to be preferred
 * to one of a single kind. */
enum { ROUNDS = 4 };
static const double margin = 0.97;

/* Surfels that take less of what triangles do stay surfels whatever is beside them, and nothing is looked up for
 * them. */
static const double decided = 0.5;

/* A cluster in sight. Infinite costs are of a kind that is not good enough. */
typedef struct plan_candidate {
  conic_hybrid_offer offers[2]; /* by kind; of surfels its share of a node's that may stand for them */
  double alone_ns;              /* of its own surfels */
  uint32_t first_link, n_links;
  uint8_t kind;
} plan_candidate;

/* Two clusters side by side: what triangles of the one take more if the other is drawn as surfels, for then their
 * border has all of its vertices. Kept with both: with the one in `own_ns`, with the other in `other_ns`. */
typedef struct cluster_link {
  uint32_t candidate;
  double own_ns, other_ns;
} cluster_link;

typedef struct hybrid_planning {
  const conic_hybrid *hybrid;
  size_t n;
  const uint32_t *clusters;
  plan_candidate *candidates;
  uint32_t *of_cluster; /* of each of the model's clusters: its candidate, or n out of sight; n + 1: a node stands */
  size_t n_links;
  cluster_link *links;
  uint8_t *kinds; /* what was found before */
  const conic_hybrid_camera *view;
  double error_px;
  double *amounts, *below; /* of each cluster of the model, and of each node, for cutting */
  uint32_t *nodes;
  conic_hybrid_offer *node_offers; /* once they were asked for; before, of no amount */
  const uint32_t *seen;
  size_t n_seen, n_standing; /* nodes that may stand, and that do already */
} hybrid_planning;

static const conic_hybrid_level *triangles_of(const hybrid_planning *p, size_t i) {
  const conic_hybrid_cluster *cluster = &p->hybrid->clusters[p->clusters[i]];
  return &p->hybrid->levels[cluster->first_level + p->candidates[i].offers[CONIC_HYBRID_TRIANGLES].level];
}

static void ask(hybrid_planning *p) {
  for (size_t i = 0; i < p->n; i++) {
    plan_candidate *c = &p->candidates[i];
    conic_hybrid_offers(p->hybrid, p->view, &p->hybrid->clusters[p->clusters[i]], p->error_px, c->offers);
    c->alone_ns = c->offers[CONIC_HYBRID_SURFELS].amount;
  }
}

static conic_hybrid_offer ask_node(const void *data, const conic_hybrid_node *node) {
  const hybrid_planning *p = data;
  conic_hybrid_offer *offer = &p->node_offers[node - p->hybrid->nodes];
  if (!(offer->amount > 0.0))
    *offer = conic_hybrid_node_offer(p->hybrid, p->view, node, p->error_px);
  return *offer;
}

/* Lets nodes stand for clusters that are surfels now. Returns how much less these take by that. */
static double cut_nodes(const hybrid_planning *p) {
  const conic_hybrid_cutting cutting = {p->hybrid, p->amounts, ask_node, p, p->below};
  for (size_t i = 0; i < p->n; i++) {
    const plan_candidate *c = &p->candidates[i];
    int may_join = c->kind == CONIC_HYBRID_SURFELS && c->alone_ns < HUGE_VAL;
    p->amounts[p->clusters[i]] = may_join ? c->alone_ns : NAN;
  }
  return conic_hybrid_cut(&cutting, p->seen, p->n_seen, p->nodes);
}

/* The links of one candidate, one for each neighbour: `last` has for each candidate the link that names it. */
static void add_links(hybrid_planning *p, uint32_t i, uint32_t *last) {
  const conic_hybrid_level *level = triangles_of(p, i);
  plan_candidate *c = &p->candidates[i];
  c->first_link = (uint32_t)p->n_links;
  c->n_links = 0;
  if (level->n_borders == 0)
    return;
  conic_hybrid_frame frame = conic_hybrid_frame_of(p->hybrid, p->clusters[i]);
  for (size_t k = 0; k < level->n_borders; k++) {
    const conic_cluster_border *border = &frame.borders[level->first_border + k];
    uint32_t other = p->of_cluster[border->across];
    uint32_t n = border->from < border->to ? border->to - border->from : border->from - border->to;
    if (other > p->n)
      c->offers[CONIC_HYBRID_TRIANGLES].amount += CONIC_HYBRID_STITCH_NS * ((double)n - 1.0);
    if (other >= p->n)
      continue;
    if (last[other] < c->first_link || last[other] >= p->n_links) {
      last[other] = (uint32_t)p->n_links;
      p->links[p->n_links++] = (cluster_link){.candidate = other};
    }
    p->links[last[other]].own_ns += CONIC_HYBRID_STITCH_NS * ((double)n - 1.0);
  }
  c->n_links = (uint32_t)p->n_links - c->first_link;
}

/* What the other one's triangles take more, as far as it has a link too. */
static void match_links(hybrid_planning *p) {
  for (uint32_t i = 0; i < p->n; i++)
    for (size_t k = p->candidates[i].first_link; k < p->candidates[i].first_link + p->candidates[i].n_links; k++) {
      const plan_candidate *other = &p->candidates[p->links[k].candidate];
      for (size_t m = other->first_link; m < other->first_link + other->n_links; m++)
        if (p->links[m].candidate == i)
          p->links[k].other_ns = p->links[m].own_ns;
    }
}

static int is_decided(const plan_candidate *c) {
  return c->offers[CONIC_HYBRID_SURFELS].amount < decided * c->offers[CONIC_HYBRID_TRIANGLES].amount;
}

static conic_status find_links(hybrid_planning *p) {
  size_t n_borders = 0;
  for (size_t i = 0; i < p->n; i++)
    n_borders += is_decided(&p->candidates[i]) ? 0 : triangles_of(p, i)->n_borders;
  uint32_t *last = conic_memory_allocate_zeroed(p->hybrid->context, p->n, sizeof *last);
  p->links = conic_memory_allocate(p->hybrid->context, n_borders, sizeof *p->links);
  if (last && p->links) {
    for (uint32_t i = 0; i < p->n; i++)
      if (!is_decided(&p->candidates[i]))
        add_links(p, i, last);
    match_links(p);
  }
  conic_memory_release(p->hybrid->context, last);
  return last && p->links ? CONIC_OK : CONIC_ERROR_MEMORY;
}

/* What a candidate takes as one kind and as the other, its neighbours being what they are. */
static void weigh(const hybrid_planning *p, const plan_candidate *c, double costs[2]) {
  costs[0] = c->offers[0].amount;
  costs[1] = c->offers[1].amount;
  for (size_t k = 0; k < c->n_links; k++) {
    const cluster_link *l = &p->links[c->first_link + k];
    if (p->candidates[l->candidate].kind == CONIC_HYBRID_SURFELS)
      costs[CONIC_HYBRID_TRIANGLES] += l->own_ns;
    else
      costs[CONIC_HYBRID_SURFELS] += l->other_ns;
  }
}

/* Each cluster in turn becomes what is cheaper, until none does. */
static void improve(hybrid_planning *p) {
  int is_changed = 1;
  for (int round = 0; round < ROUNDS && is_changed; round++) {
    is_changed = 0;
    for (size_t i = 0; i < p->n; i++) {
      plan_candidate *c = &p->candidates[i];
      double costs[2];
      weigh(p, c, costs);
      if (costs[!c->kind] < costs[c->kind]) {
        c->kind = !c->kind;
        is_changed = 1;
      }
    }
  }
}

/* Nodes that stand are surfels. */
static int is_mixed(const hybrid_planning *p) {
  for (size_t i = 0; i < p->n; i++)
    if (p->candidates[i].kind != (p->n_standing ? CONIC_HYBRID_SURFELS : p->candidates[0].kind))
      return 1;
  return 0;
}

/* How much more a picture of both kinds takes than its parts. Clusters share tiles, and there are no more of these than
 * all. */
static double mixing(const hybrid_planning *p) {
  double n_pixels = 0.0;
  for (size_t i = 0; i < p->n; i++)
    if (p->candidates[i].kind == CONIC_HYBRID_TRIANGLES)
      n_pixels += conic_hybrid_tile_pixels(p->view, &p->hybrid->clusters[p->clusters[i]]);
  return conic_hybrid_mixing_ns(p->view, n_pixels < p->view->n_pixels ? n_pixels : p->view->n_pixels);
}

/* Of what may be either kind: the rest takes the same whatever is chosen, and may be most of it. */
static int can_be_either(const plan_candidate *c) {
  return c->offers[CONIC_HYBRID_SURFELS].amount < HUGE_VAL;
}

/* What all takes that may be either kind; with what a picture of both kinds must promise to be preferred. */
static double total(const hybrid_planning *p) {
  int is_both = is_mixed(p);
  double sum = is_both ? mixing(p) : 0.0;
  for (size_t i = 0; i < p->n; i++) {
    const plan_candidate *c = &p->candidates[i];
    double triangles_ns = can_be_either(c) ? c->offers[CONIC_HYBRID_TRIANGLES].amount : 0.0;
    sum += c->kind == CONIC_HYBRID_SURFELS ? c->alone_ns : triangles_ns;
    for (size_t k = 0; k < c->n_links && c->kind == CONIC_HYBRID_TRIANGLES; k++)
      if (p->candidates[p->links[c->first_link + k].candidate].kind == CONIC_HYBRID_SURFELS)
        sum += p->links[c->first_link + k].own_ns;
  }
  sum -= cut_nodes(p);
  return is_both ? sum / margin : sum;
}

/* All of one kind, where that is good enough. */
static void take_kind(hybrid_planning *p, uint8_t kind) {
  for (size_t i = 0; i < p->n; i++)
    p->candidates[i].kind = p->candidates[i].offers[kind].amount < HUGE_VAL ? kind : !kind;
}

/* What each cluster's surfels take if all are surfels and nodes stand for them; and what is cheaper then. */
static void share(hybrid_planning *p) {
  take_kind(p, CONIC_HYBRID_SURFELS);
  if (cut_nodes(p) > 0.0)
    for (size_t i = 0; i < p->hybrid->n_nodes; i++) {
      const conic_hybrid_node *node = &p->hybrid->nodes[i];
      double sum = 0.0;
      if (p->nodes[i] == CONIC_HYBRID_NO_NODE)
        continue;
      for (uint32_t k = node->begin; k < node->end; k++)
        sum += p->amounts[k];
      for (uint32_t k = node->begin; k < node->end; k++)
        if (p->amounts[k] > 0.0)
          p->candidates[p->of_cluster[k]].offers[CONIC_HYBRID_SURFELS].amount *= p->below[i] / sum;
    }
  for (size_t i = 0; i < p->n; i++) {
    plan_candidate *c = &p->candidates[i];
    c->kind = c->offers[CONIC_HYBRID_SURFELS].amount < c->offers[CONIC_HYBRID_TRIANGLES].amount;
  }
}

static void keep_if_less(hybrid_planning *p, double sum, double *least) {
  if (!(sum < *least))
    return;
  *least = sum;
  for (size_t i = 0; i < p->n; i++)
    p->kinds[i] = p->candidates[i].kind;
}

/* Begins with what each would be by itself; or with triangles alone, or surfels wherever they are good enough. */
static void settle(hybrid_planning *p) {
  double least = HUGE_VAL;
  improve(p);
  keep_if_less(p, total(p), &least);
  for (uint8_t kind = 0; kind < 2; kind++) {
    take_kind(p, kind);
    keep_if_less(p, total(p), &least);
  }
  for (size_t i = 0; i < p->n; i++)
    p->candidates[i].kind = p->kinds[i];
}

/* Whether all of one kind takes hardly more than the cheaper of both for each cluster: then no better one has to be
 * looked for. */
static int is_settled(hybrid_planning *p) {
  double sums[2] = {0.0, 0.0}, least = 0.0;
  int is_bound = 0;
  for (size_t i = 0; i < p->n; i++) {
    const plan_candidate *c = &p->candidates[i];
    is_bound |= !can_be_either(c);
    least += can_be_either(c) ? c->offers[c->kind].amount : 0.0;
    for (int kind = 0; kind < 2; kind++)
      sums[kind] += can_be_either(c) ? c->offers[kind].amount : 0.0;
  }
  uint8_t kind = !is_bound && sums[CONIC_HYBRID_SURFELS] < sums[CONIC_HYBRID_TRIANGLES];
  if (is_mixed(p) && !(sums[kind] <= least / margin))
    return 0;
  take_kind(p, kind);
  return 1;
}

/* The kind that is asked for; where it is good enough nowhere, its finest. */
static void obey(hybrid_planning *p, int only_kind) {
  for (size_t i = 0; i < p->n; i++) {
    const conic_hybrid_cluster *cluster = &p->hybrid->clusters[p->clusters[i]];
    conic_hybrid_offer *offer = &p->candidates[i].offers[only_kind];
    p->candidates[i].kind = (uint8_t)only_kind;
    if (!(offer->amount < HUGE_VAL))
      offer->level = conic_hybrid_finest(p->hybrid, cluster, only_kind);
  }
}

static conic_status plan_kinds(hybrid_planning *p) {
  share(p);
  if (is_settled(p))
    return CONIC_OK;
  conic_status status = find_links(p);
  if (status == CONIC_OK)
    settle(p);
  return status;
}

/* No node above it can stand any more. */
static void note_standing(hybrid_planning *p, size_t i) {
  const conic_hybrid_node *node = &p->hybrid->nodes[i];
  p->n_standing++;
  p->below[i] = NAN;
  for (uint32_t k = node->begin; k < node->end; k++)
    p->of_cluster[k] = (uint32_t)p->n + 1;
}

static conic_status begin_plan(hybrid_planning *p) {
  conic_context *context = p->hybrid->context;
  p->candidates = conic_memory_allocate_zeroed(context, p->n, sizeof *p->candidates);
  p->of_cluster = conic_memory_allocate(context, p->hybrid->n_clusters, sizeof *p->of_cluster);
  p->kinds = conic_memory_allocate(context, p->n, sizeof *p->kinds);
  p->amounts = conic_memory_allocate_zeroed(context, p->hybrid->n_clusters, sizeof *p->amounts);
  p->below = conic_memory_allocate_zeroed(context, p->hybrid->n_nodes, sizeof *p->below);
  p->node_offers = conic_memory_allocate_zeroed(context, p->hybrid->n_nodes, sizeof *p->node_offers);
  if (!p->candidates || !p->of_cluster || !p->kinds || !p->amounts || !p->below || !p->node_offers)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < p->hybrid->n_clusters; i++)
    p->of_cluster[i] = (uint32_t)p->n;
  for (size_t i = 0; i < p->n; i++)
    p->of_cluster[p->clusters[i]] = (uint32_t)i;
  for (size_t i = 0; i < p->hybrid->n_nodes; i++)
    if (p->nodes[i] != CONIC_HYBRID_NO_NODE)
      note_standing(p, i);
  return CONIC_OK;
}

conic_status conic_hybrid_choose_levels(const conic_hybrid_choosing *choosing, uint32_t *levels, uint32_t *nodes) {
  conic_context *context = choosing->hybrid->context;
  hybrid_planning p = {.hybrid = choosing->hybrid,
                       .n = choosing->n,
                       .clusters = choosing->clusters,
                       .view = choosing->view,
                       .error_px = choosing->error_px,
                       .nodes = nodes,
                       .seen = choosing->seen,
                       .n_seen = choosing->n_seen};
  conic_status status = begin_plan(&p);
  if (status == CONIC_OK) {
    ask(&p);
    if (choosing->only_kind < 0)
      status = plan_kinds(&p);
    else
      obey(&p, choosing->only_kind);
  }
  if (status == CONIC_OK)
    cut_nodes(&p);
  for (size_t i = 0; i < p.n && status == CONIC_OK; i++)
    levels[i] = p.candidates[i].offers[p.candidates[i].kind].level;
  void *const owned[] = {p.links, p.node_offers, p.below, p.amounts, p.kinds, p.of_cluster, p.candidates};
  conic_memory_release_all(context, owned, sizeof owned / sizeof *owned);
  return status;
}

/* --- nodes that stand for their clusters --- */

static double sum_clusters(const conic_hybrid_cutting *c, const conic_hybrid_node *node) {
  double sum = 0.0;
  for (uint32_t i = node->begin; i < node->end; i++)
    sum += c->amounts[i];
  return sum;
}

/* A node's children come right after it, and end where it ends. */
static double sum_children(const conic_hybrid_cutting *c, size_t node) {
  double sum = 0.0;
  for (size_t i = node + 1; i < c->hybrid->nodes[node].next; i = c->hybrid->nodes[i].next)
    sum += c->below[i];
  return sum;
}

/* A node by itself against the best of what is below it. */
static void cut_node(const conic_hybrid_cutting *c, size_t i, uint32_t *nodes) {
  const conic_hybrid_node *node = &c->hybrid->nodes[i];
  double sum = node->next == i + 1 ? sum_clusters(c, node) : sum_children(c, i);
  nodes[i] = CONIC_HYBRID_NO_NODE;
  c->below[i] = sum;
  if (!(sum > 0.0)) /* nothing is in sight, or something must stay */
    return;
  conic_hybrid_offer offer = c->offer(c->data, node);
  if (offer.amount < sum) {
    nodes[i] = offer.level;
    c->below[i] = offer.amount;
  }
}

/* The number of the k-th node that is looked at. All are, where there is no list. */
static size_t seen_node(const uint32_t *seen, size_t k) {
  return seen ? seen[k] : k;
}

double conic_hybrid_cut(const conic_hybrid_cutting *c, const uint32_t *seen, size_t n_seen, uint32_t *nodes) {
  const conic_hybrid *h = c->hybrid;
  double less = 0.0;
  for (size_t k = n_seen; k-- > 0;) /* from the leaves to the root */
    cut_node(c, seen_node(seen, k), nodes);
  for (size_t k = 0; k < n_seen;) {
    size_t i = seen_node(seen, k++);
    if (nodes[i] == CONIC_HYBRID_NO_NODE)
      continue;
    less += sum_clusters(c, &h->nodes[i]) - c->below[i];
    for (; k < n_seen && seen_node(seen, k) < h->nodes[i].next; k++)
      nodes[seen_node(seen, k)] = CONIC_HYBRID_NO_NODE;
  }
  return less;
}

void conic_hybrid_find_standing(const conic_hybrid *h, const uint32_t *nodes, uint32_t *standing) {
  for (size_t i = 0; i < h->n_clusters; i++)
    standing[i] = CONIC_HYBRID_NO_NODE;
  for (uint32_t i = 0; i < h->n_nodes; i++)
    for (uint32_t k = h->nodes[i].begin; k < h->nodes[i].end && nodes[i] != CONIC_HYBRID_NO_NODE; k++)
      standing[k] = i;
}
