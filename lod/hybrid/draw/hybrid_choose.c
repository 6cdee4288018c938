#include "lod/hybrid/draw/hybrid_choose.h"

#include "lod/hybrid/draw/hybrid_selecting.h"
#include "lod/planner/plan.h"

/* The level of a cluster or node, from its first, and how many primitives it has. */
typedef struct plan_offer {
  uint32_t level;
  double count;
} plan_offer;

/* Errors below 0 were not asked for yet. Those that keep no colours are not a number. */
typedef struct hybrid_planning {
  const conic_hybrid_choosing *asked;
  const conic_hybrid *hybrid;
  int only_kind;
  double error_px;   /* what is chosen for */
  double *errors_px; /* of all levels of the first cluster, then of the second …; then of the first node's levels and
                        its point, then of the second's … */
  size_t *first_errors;   /* of each cluster in sight, and of each node in sight */
  double *units;          /* of each cluster in sight: the pixels that a displacement by one can be within its sphere */
  uint32_t *levels;       /* of each cluster in sight */
  double *counts, *below; /* primitives of each cluster of the model by itself; of what is below each of its nodes */
  uint32_t *nodes;        /* what stands for its clusters */
  uint32_t *standing;     /* of each of the model's clusters: the node that stands for it */
  uint32_t *stages;       /* of each of the model's clusters: of the level that it has; hidden if it is not in sight */
  int is_short;           /* nothing of some cluster is good enough */
} hybrid_planning;

/* --- how far what can be chosen is off --- */

/* Colours that are off by what is allowed count as much as places that are off by a pixel, where the error is to be the
 * least; else they are good enough, or not. */
static double with_colors(const hybrid_planning *p, double error_px, double change) {
  double allowed = p->asked->view->color_error;
  if (!p->asked->budget)
    return change <= allowed ? error_px : NAN;
  double colors = change > 0.0 ? change / allowed : 0.0;
  return error_px > colors ? error_px : colors;
}

static double cluster_px(const hybrid_planning *p, size_t i, uint32_t k) {
  const conic_hybrid_camera *view = p->asked->view;
  const conic_hybrid_cluster *cluster = &p->hybrid->clusters[p->asked->clusters[i]];
  const conic_hybrid_level *level = &p->hybrid->levels[cluster->first_level + k];
  double *error_px = &p->errors_px[p->first_errors[i] + k];
  if (*error_px < 0.0)
    *error_px = with_colors(p, conic_hybrid_error_px(view, &cluster->bound, level),
                            conic_hybrid_change(view, &cluster->bound, level));
  return *error_px;
}

/* Where all is simplified as one, the greatest error is at few places. Such pictures are nearer to the mesh than those
 * of clusters that err by more than half of it (docs/notes/hybrid-measured.md). */
static const double weight_of_whole = 0.5;

static double measure_node(const hybrid_planning *p, const conic_hybrid_node *node, uint32_t k) {
  const conic_hybrid_camera *view = p->asked->view;
  if (k == node->n_levels)
    return with_colors(p, conic_hybrid_point_error_px(view, node), conic_hybrid_point_change(view, node));
  const conic_hybrid_level *level = &p->hybrid->levels[node->first_level + k];
  /* NOLINTNEXTLINE(clang-analyzer-core.NullDereference): there are levels where there are nodes */
  double weight = p->asked->budget && level->kind == CONIC_HYBRID_TRIANGLES ? weight_of_whole : 1.0;
  return with_colors(p, weight * conic_hybrid_node_error_px(p->hybrid, view, node, level),
                     conic_hybrid_change(view, &node->bound, level));
}

/* Of the i-th node in sight. */
static double node_px(const hybrid_planning *p, size_t i, uint32_t k) {
  double *error_px = &p->errors_px[p->first_errors[p->asked->n + i] + k];
  if (*error_px < 0.0)
    *error_px = measure_node(p, &p->hybrid->nodes[p->asked->seen[i]], k);
  return *error_px;
}

/* --- what is chosen for an error --- */

/* Of two levels of a cluster with as many primitives, whether the first is drawn faster. */
static int is_faster(const hybrid_planning *p, const conic_hybrid_cluster *cluster, uint32_t a, uint32_t b) {
  const conic_hybrid_level *levels = p->hybrid->levels + cluster->first_level;
  return conic_hybrid_cost(p->asked->view, cluster, &levels[a]) <
         conic_hybrid_cost(p->asked->view, cluster, &levels[b]);
}

/* The level of fewest primitives among those that are good enough. */
static uint32_t fewest(hybrid_planning *p, size_t i) {
  const conic_hybrid_cluster *cluster = &p->hybrid->clusters[p->asked->clusters[i]];
  const conic_hybrid_level *levels = p->hybrid->levels + cluster->first_level;
  const double unit = p->units[i];
  uint32_t best = UINT32_MAX, least = UINT32_MAX;
  for (uint32_t k = cluster->n_levels; k-- > 0;) {
    if ((p->only_kind >= 0 && levels[k].kind != (uint32_t)p->only_kind) || levels[k].count > least)
      continue;
    if ((double)levels[k].error * unit > p->error_px ||
        !(cluster_px(p, i, k) <= p->error_px)) /* whatever reaches out */
      continue;
    if (best == UINT32_MAX || levels[k].count < least || is_faster(p, cluster, k, best))
      best = k;
    least = levels[best].count;
  }
  if (best < UINT32_MAX)
    return best;
  p->is_short = 1;
  return conic_hybrid_finest(p->hybrid, cluster, p->only_kind);
}

static const conic_hybrid_level *chosen(const hybrid_planning *p, size_t i) {
  return &p->hybrid->levels[p->hybrid->clusters[p->asked->clusters[i]].first_level + p->levels[i]];
}

/* How many of a node's levels are triangles that need not be looked at, as they err by more than is allowed: the
 * first of the rest is the coarsest that may do. Errors grow with the level, but for colours. */
static uint32_t coarsest_triangles(const hybrid_planning *p, size_t i, uint32_t n_triangles) {
  uint32_t good = 0, bad = n_triangles;
  while (good < bad) {
    uint32_t middle = good + (bad - good) / 2;
    if (node_px(p, i, middle) > p->error_px)
      bad = middle;
    else
      good = middle + 1;
  }
  return good;
}

/* The triangles of a node that may stand for it: the fewest, or for a budget the most that there is room for, as the
 * levels lie close together and some err alike. */
static plan_offer ask_triangles(const hybrid_planning *p, size_t i) {
  const conic_hybrid_node *node = &p->hybrid->nodes[p->asked->seen[i]];
  const conic_hybrid_level *levels = p->hybrid->levels + node->first_level;
  plan_offer best = {0, HUGE_VAL};
  uint32_t n = 0;
  while (n < node->n_levels && levels[n].kind == CONIC_HYBRID_TRIANGLES)
    n++;
  for (uint32_t k = coarsest_triangles(p, i, n); k-- > 0;) {
    if (!(node_px(p, i, k) < HUGE_VAL && node_px(p, i, k) <= p->error_px))
      continue;
    if (best.count < HUGE_VAL && levels[k].count > p->asked->budget)
      break;
    best = (plan_offer){k, (double)levels[k].count};
  }
  return best;
}

/* The way of the i-th node in sight that has fewest, the better one of as many; never one whose error is infinite: what
 * reaches near is not joined, and a point that is not there, or that the eye is in, cannot be drawn. */
static plan_offer ask_node(const hybrid_planning *p, size_t i) {
  const conic_hybrid_node *node = &p->hybrid->nodes[p->asked->seen[i]];
  plan_offer best = {0, HUGE_VAL};
  if (p->only_kind == CONIC_HYBRID_TRIANGLES)
    return ask_triangles(p, i);
  for (uint32_t k = node->n_levels + 1; k-- > 0;) {
    const conic_hybrid_level *level = k < node->n_levels ? &p->hybrid->levels[node->first_level + k] : NULL;
    double count = level ? (double)level->count : 1.0;
    if (level && level->kind == CONIC_HYBRID_TRIANGLES)
      break; /* so are all before it */
    if (count < best.count && node_px(p, i, k) < HUGE_VAL && node_px(p, i, k) <= p->error_px)
      best = (plan_offer){k, count};
  }
  if (p->only_kind == CONIC_HYBRID_SURFELS)
    return best;
  plan_offer triangles = ask_triangles(p, i);
  return triangles.count < best.count ? triangles : best;
}

static double sum_clusters(const hybrid_planning *p, const conic_hybrid_node *node) {
  double sum = 0.0;
  for (uint32_t i = node->begin; i < node->end; i++)
    sum += p->counts[i];
  return sum;
}

/* A node's children come right after it, and end where it ends. */
static double sum_children(const hybrid_planning *p, size_t node) {
  double sum = 0.0;
  for (size_t i = node + 1; i < p->hybrid->nodes[node].next; i = p->hybrid->nodes[i].next)
    sum += p->below[i];
  return sum;
}

void conic_hybrid_find_standing(const conic_hybrid *h, const uint32_t *nodes, uint32_t *standing) {
  for (size_t i = 0; i < h->n_clusters; i++)
    standing[i] = CONIC_HYBRID_NO_NODE;
  for (uint32_t i = 0; i < h->n_nodes; i++)
    for (uint32_t k = h->nodes[i].begin; k < h->nodes[i].end && nodes[i] != CONIC_HYBRID_NO_NODE; k++)
      standing[k] = i;
}

/* Lets nodes stand for their clusters wherever that is fewer, from the leaves to the root. */
static void cut_tree(const hybrid_planning *p) {
  const conic_hybrid_choosing *asked = p->asked;
  for (size_t k = asked->n_seen; k-- > 0;) {
    uint32_t i = asked->seen[k];
    const conic_hybrid_node *node = &p->hybrid->nodes[i];
    double sum = node->next == i + 1 ? sum_clusters(p, node) : sum_children(p, i);
    plan_offer offer = {CONIC_HYBRID_NO_NODE, sum};
    if (sum > 0.0)
      offer = ask_node(p, k);
    p->nodes[i] = offer.count < sum ? offer.level : CONIC_HYBRID_NO_NODE;
    p->below[i] = offer.count < sum ? offer.count : sum;
  }
  for (size_t k = 0; k < asked->n_seen;) {
    uint32_t i = asked->seen[k++];
    for (; p->nodes[i] != CONIC_HYBRID_NO_NODE && k < asked->n_seen && asked->seen[k] < p->hybrid->nodes[i].next; k++)
      p->nodes[asked->seen[k]] = CONIC_HYBRID_NO_NODE;
  }
  conic_hybrid_find_standing(p->hybrid, p->nodes, p->standing);
}

static double greatest_error(const hybrid_planning *p) {
  double greatest = 0.0;
  for (size_t i = 0; i < p->asked->n; i++)
    if (p->standing[p->asked->clusters[i]] == CONIC_HYBRID_NO_NODE)
      greatest = fmax(greatest, cluster_px(p, i, p->levels[i]));
  for (size_t i = 0; i < p->asked->n_seen; i++)
    if (p->nodes[p->asked->seen[i]] != CONIC_HYBRID_NO_NODE)
      greatest = fmax(greatest, node_px(p, i, p->nodes[p->asked->seen[i]]));
  return greatest;
}

/* How many primitives were chosen, without those that fit clusters to each other. */
static uint64_t count_chosen(const hybrid_planning *p) {
  uint64_t count = 0;
  for (size_t i = 0; i < p->asked->n; i++)
    count += p->standing[p->asked->clusters[i]] == CONIC_HYBRID_NO_NODE ? chosen(p, i)->count : 0;
  for (size_t i = 0; i < p->asked->n_seen; i++) {
    const conic_hybrid_node *node = &p->hybrid->nodes[p->asked->seen[i]];
    uint32_t level = p->nodes[p->asked->seen[i]];
    if (level != CONIC_HYBRID_NO_NODE)
      count += level < node->n_levels ? p->hybrid->levels[node->first_level + level].count : 1;
  }
  return count;
}

/* Chooses for all. Returns how many primitives that takes, without those that fit clusters to each other. */
static uint64_t choose_alone(void *data, double error_px, double *reached_px) {
  hybrid_planning *p = data;
  p->error_px = error_px;
  p->is_short = 0;
  for (size_t i = 0; i < p->asked->n; i++) {
    p->levels[i] = fewest(p, i);
    p->counts[p->asked->clusters[i]] = (double)chosen(p, i)->count;
  }
  cut_tree(p);
  *reached_px = greatest_error(p);
  return count_chosen(p);
}

/* How many triangles more it takes to fit what was chosen to each other. Where there are `counts`, each cluster's are
 * added to its own. */
static uint64_t count_stitches(const hybrid_planning *p, double *counts) {
  uint64_t count = 0;
  const uint32_t *clusters = p->asked->clusters;
  for (size_t i = 0; i < p->asked->n; i++)
    p->stages[clusters[i]] = p->standing[clusters[i]] == CONIC_HYBRID_NO_NODE ? chosen(p, i)->stage : 0;
  for (size_t i = 0; i < p->asked->n; i++) {
    if (p->standing[clusters[i]] != CONIC_HYBRID_NO_NODE)
      continue;
    size_t n = conic_hybrid_count_stitches(p->hybrid, clusters[i], chosen(p, i), p->stages);
    count += n;
    if (counts)
      counts[clusters[i]] += (double)n;
  }
  return count;
}

/* The same, but counts those that fit clusters to each other, too. */
static uint64_t choose_fitting(void *data, double error_px, double *reached_px) {
  uint64_t count = choose_alone(data, error_px, reached_px);
  return count + count_stitches(data, NULL);
}

/* --- budgets --- */

/* The least error above one that anything has. */
static double next_error(const hybrid_planning *p, double error_px) {
  const conic_hybrid_choosing *asked = p->asked;
  double next_px = HUGE_VAL;
  for (size_t i = 0; i < asked->n + asked->n_seen; i++) {
    uint32_t n = i < asked->n ? p->hybrid->clusters[asked->clusters[i]].n_levels
                              : p->hybrid->nodes[asked->seen[i - asked->n]].n_levels + 1;
    for (uint32_t k = 0; k < n; k++) {
      double own_px = i < asked->n ? cluster_px(p, i, k) : node_px(p, i - asked->n, k);
      next_px = own_px > error_px && own_px < next_px ? own_px : next_px;
    }
  }
  return next_px;
}

/* With what fits clusters to each other, the number may go up and down with the error. So from the least at which the
 * levels alone are few enough each error is tried, but no more of them than a frame has time for. Returns whether one
 * was found, the number that it takes, or the coarsest does, and the error of what was chosen. */
static int fit(hybrid_planning *p, uint64_t *count, double *reached_px) {
  enum { ONE_BY_ONE = 64 };
  uint64_t budget = p->asked->budget;
  double error_px = 0.0;
  if (choose_alone(p, 0.0, reached_px) > budget && !conic_plan_fit(choose_alone, p, budget, 0.0, &error_px))
    error_px = HUGE_VAL;
  for (int i = 0; i < ONE_BY_ONE; i++) {
    *count = choose_fitting(p, error_px, reached_px);
    if (*count <= budget)
      return 1;
    if (!(error_px < HUGE_VAL))
      return 0;
    error_px = next_error(p, error_px);
  }
  int is_found = conic_plan_fit(choose_fitting, p, budget, error_px, &error_px);
  *count = choose_fitting(p, is_found ? error_px : HUGE_VAL, reached_px);
  return is_found;
}

/* --- all of it --- */

typedef struct plan_best {
  uint64_t count;
  double reached_px;
  uint32_t *levels, *nodes;
} plan_best;

static void take_best(const hybrid_planning *p, uint64_t count, double reached_px, plan_best *best) {
  best->count = count;
  best->reached_px = reached_px;
  memcpy(best->levels, p->levels, p->asked->n * sizeof *best->levels);
  memcpy(best->nodes, p->nodes, p->hybrid->n_nodes * sizeof *best->nodes);
}

/* Chooses for the error; and with what fits clusters to each other counted before nodes may stand for them, which may
 * be fewer. */
static void keep_error(hybrid_planning *p, plan_best *best) {
  double reached_px;
  uint64_t count = choose_alone(p, p->asked->error_px, &reached_px), n = count_stitches(p, p->counts);
  if (p->is_short && p->only_kind != p->asked->only_kind)
    return;
  if (count + n < best->count)
    take_best(p, count + n, reached_px, best);
  if (n == 0)
    return;
  cut_tree(p);
  count = count_chosen(p) + count_stitches(p, NULL);
  if (count < best->count)
    take_best(p, count, reached_px, best);
}

/* Chooses of either kind; or of one kind alone, which may be fewer together. */
/* NOLINTNEXTLINE(readability-non-const-parameter): `best` fills them */
static conic_status choose_kinds(hybrid_planning *p, uint32_t *levels, uint32_t *nodes) {
  const conic_hybrid_choosing *asked = p->asked;
  uint64_t fewest_count = UINT64_MAX, count;
  plan_best best = {UINT64_MAX, HUGE_VAL, levels, nodes};
  int last = asked->only_kind < 0 ? CONIC_HYBRID_SURFELS : asked->only_kind;
  for (p->only_kind = asked->only_kind; p->only_kind <= last; p->only_kind++) {
    double reached_px = 0.0;
    if (!asked->budget)
      keep_error(p, &best);
    else if (fit(p, &count, &reached_px) && (best.count == UINT64_MAX || reached_px < best.reached_px))
      take_best(p, count, reached_px, &best);
    else
      fewest_count = count < fewest_count ? count : fewest_count;
  }
  return best.count < UINT64_MAX
             ? CONIC_OK
             : conic_fail(p->hybrid->context, CONIC_ERROR_ARGUMENT,
                          "hybrid: the coarsest of what is in sight are %llu triangles and surfels, more than the "
                          "budget of %llu",
                          (unsigned long long)fewest_count, (unsigned long long)asked->budget);
}

/* Where each one's errors are. Returns how many there are. */
static size_t place_errors(const hybrid_planning *p) {
  const conic_hybrid_choosing *asked = p->asked;
  size_t n = 0;
  for (size_t i = 0; i < asked->n + asked->n_seen; i++) {
    p->first_errors[i] = n;
    n += i < asked->n ? p->hybrid->clusters[asked->clusters[i]].n_levels
                      : p->hybrid->nodes[asked->seen[i - asked->n]].n_levels + 1;
  }
  return n;
}

static conic_status begin_plan(hybrid_planning *p) {
  const conic_hybrid *h = p->hybrid;
  conic_context *context = h->context;
  if (conic_memory_allocate_these(context, CONIC_ROOM(p->first_errors, p->asked->n + p->asked->n_seen),
                                  CONIC_ROOM(p->units, p->asked->n), CONIC_ROOM(p->levels, p->asked->n),
                                  CONIC_ZEROED(p->counts, h->n_clusters), CONIC_ZEROED(p->below, h->n_nodes),
                                  CONIC_ROOM(p->nodes, h->n_nodes), CONIC_ROOM(p->standing, h->n_clusters),
                                  CONIC_ROOM(p->stages, h->n_clusters)) != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < h->n_clusters; i++)
    p->stages[i] = CONIC_HYBRID_HIDDEN;
  for (size_t i = 0; i < h->n_nodes; i++)
    p->nodes[i] = CONIC_HYBRID_NO_NODE;
  for (size_t i = 0; i < p->asked->n; i++)
    p->units[i] = conic_hybrid_pixels_a_unit(p->asked->view, &h->clusters[p->asked->clusters[i]].bound, 0.0);
  size_t n_errors = place_errors(p);
  p->errors_px = conic_memory_allocate(context, n_errors, sizeof *p->errors_px);
  for (size_t i = 0; p->errors_px && i < n_errors; i++)
    p->errors_px[i] = -1.0;
  return p->errors_px ? CONIC_OK : CONIC_ERROR_MEMORY;
}

conic_status conic_hybrid_choose_levels(const conic_hybrid_choosing *choosing, uint32_t *levels, uint32_t *nodes) {
  hybrid_planning p = {.asked = choosing, .hybrid = choosing->hybrid};
  conic_status status = begin_plan(&p);
  if (status == CONIC_OK)
    status = choose_kinds(&p, levels, nodes);
  conic_context *context = choosing->hybrid->context;
  conic_memory_release_these(context, p.errors_px, p.stages, p.standing, p.nodes, p.below, p.counts, p.levels, p.units,
                             p.first_errors);
  return status;
}
