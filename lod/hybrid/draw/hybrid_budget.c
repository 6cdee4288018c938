/* The least error that so many primitives can give. */
#include "lod/hybrid/draw/hybrid_choose.h"

#include "core/base/base.h"
#include "lod/hybrid/draw/hybrid_offers.h"
#include "lod/hybrid/draw/hybrid_selecting.h"

/* Clusters in sight, and how far on the screen each of their levels is off. */
typedef struct fitting {
  const conic_hybrid *hybrid;
  int only_kind;
  uint64_t budget;
  const uint32_t *clusters;
  size_t n;
  double *errors_px; /* of all levels of the first cluster, then of the second … */
  uint32_t *levels;
  uint32_t *stages;    /* of each of the model's clusters: of the level that it has now; hidden if it is not in sight */
  double *node_errors; /* of all levels of the first node, and its point, then of the second … */
  size_t *first_errors; /* of each node */
  double *counts;       /* of each of the model's clusters, as cutting takes them */
  double *below;
  uint32_t *nodes;    /* what stands for its clusters now */
  uint32_t *standing; /* of each of the model's clusters */
  double error_px;
} fitting;

static int is_allowed(const fitting *f, const conic_hybrid_level *level) {
  return f->only_kind < 0 || level->kind == (uint32_t)f->only_kind;
}

/* The level of fewest primitives among those that are good enough; of as many, the better one. */
static uint32_t fewest(const fitting *f, const conic_hybrid_cluster *cluster, const double *errors_px,
                       double error_px) {
  const conic_hybrid_level *levels = f->hybrid->levels + cluster->first_level;
  uint32_t best = conic_hybrid_finest(f->hybrid, cluster, f->only_kind);
  for (uint32_t k = 0; k < cluster->n_levels; k++) {
    int is_fewer = levels[k].count < levels[best].count ||
                   (levels[k].count == levels[best].count && errors_px[k] < errors_px[best]);
    if (is_allowed(f, &levels[k]) && errors_px[k] <= error_px && is_fewer)
      best = k;
  }
  return best;
}

static const conic_hybrid_level *chosen(const fitting *f, size_t i) {
  return &f->hybrid->levels[f->hybrid->clusters[f->clusters[i]].first_level + f->levels[i]];
}

static const double *errors_of_node(const fitting *f, const conic_hybrid_node *node) {
  return f->node_errors + f->first_errors[node - f->hybrid->nodes];
}

/* The most of a node's triangles that the budget has room for. Levels lie close together, and some err alike. */
static int is_better_offer(const fitting *f, const conic_hybrid_level *level, conic_hybrid_offer best, int is_closer) {
  double n = level ? (double)level->count : 1.0;
  if (level ? !is_allowed(f, level) : f->only_kind == CONIC_HYBRID_TRIANGLES)
    return 0;
  if (level && level->kind == CONIC_HYBRID_TRIANGLES)
    return !(best.amount <= (double)f->budget);
  return n < best.amount || (n <= best.amount && is_closer);
}

/* The way of a node that has fewest; never one whose error is infinite: what reaches near is not joined, and a point
 * that is not there, or that the eye is in, cannot be drawn. */
static conic_hybrid_offer ask_node(const void *data, const conic_hybrid_node *node) {
  const fitting *f = data;
  const double *errors_px = errors_of_node(f, node);
  conic_hybrid_offer best = {0, HUGE_VAL};
  double best_px = HUGE_VAL;
  for (uint32_t k = 0; k <= node->n_levels; k++) {
    const conic_hybrid_level *level = k < node->n_levels ? &f->hybrid->levels[node->first_level + k] : NULL;
    if (errors_px[k] < HUGE_VAL && errors_px[k] <= f->error_px &&
        is_better_offer(f, level, best, errors_px[k] < best_px)) {
      best = (conic_hybrid_offer){k, level ? (double)level->count : 1.0};
      best_px = errors_px[k];
    }
  }
  return best;
}

/* Lets nodes stand for clusters where that is fewer. Returns how many fewer. */
static uint64_t cut_tree(fitting *f) {
  const conic_hybrid_cutting cutting = {f->hybrid, f->counts, ask_node, f, f->below};
  for (size_t i = 0; i < f->n; i++)
    f->counts[f->clusters[i]] = (double)chosen(f, i)->count;
  return (uint64_t)conic_hybrid_cut(&cutting, NULL, f->hybrid->n_nodes, f->nodes); /* a whole number */
}

static void note_next(const double *errors_px, size_t n, double error_px, double *next_px) {
  for (size_t k = 0; k < n; k++)
    *next_px = errors_px[k] > error_px && errors_px[k] < *next_px ? errors_px[k] : *next_px;
}

static double greatest_error(const fitting *f) {
  const double *errors_px = f->errors_px;
  double greatest = 0.0;
  conic_hybrid_find_standing(f->hybrid, f->nodes, f->standing);
  for (size_t i = 0; i < f->n; i++) {
    uint32_t standing = f->standing[f->clusters[i]];
    double error_px = errors_px[f->levels[i]];
    if (standing != CONIC_HYBRID_NO_NODE)
      error_px = errors_of_node(f, &f->hybrid->nodes[standing])[f->nodes[standing]];
    greatest = error_px > greatest ? error_px : greatest;
    errors_px += f->hybrid->clusters[f->clusters[i]].n_levels;
  }
  return greatest;
}

/* Chooses for all clusters; returns how many primitives that are, without those that fit them to each other.
 * `greatest_px` is the greatest error of what was chosen, `next_px` the least above `error_px` that any level has. */
static uint64_t choose_all(fitting *f, double error_px, double *greatest_px, double *next_px) {
  const conic_hybrid *h = f->hybrid;
  const double *errors_px = f->errors_px;
  uint64_t count = 0;
  f->error_px = error_px;
  *next_px = HUGE_VAL;
  for (size_t i = 0; i < f->n; i++) {
    const conic_hybrid_cluster *cluster = &h->clusters[f->clusters[i]];
    f->levels[i] = fewest(f, cluster, errors_px, error_px);
    count += chosen(f, i)->count;
    note_next(errors_px, cluster->n_levels, error_px, next_px);
    errors_px += cluster->n_levels;
  }
  for (size_t i = 0; i < h->n_nodes; i++)
    note_next(errors_of_node(f, &h->nodes[i]), h->nodes[i].n_levels + 1, error_px, next_px);
  count -= cut_tree(f);
  *greatest_px = greatest_error(f);
  return count;
}

/* How many triangles more it takes to fit what was chosen to each other. */
static uint64_t count_stitches(const fitting *f) {
  uint64_t count = 0;
  for (size_t i = 0; i < f->n; i++)
    f->stages[f->clusters[i]] = f->standing[f->clusters[i]] == CONIC_HYBRID_NO_NODE ? chosen(f, i)->stage : 0;
  for (size_t i = 0; i < f->n; i++)
    if (f->standing[f->clusters[i]] == CONIC_HYBRID_NO_NODE)
      count += conic_hybrid_count_stitches(f->hybrid, f->clusters[i], chosen(f, i), f->stages);
  return count;
}

/* Colours that are off by what is allowed count as much as places that are off by a pixel. */
static double with_colors(const conic_hybrid_camera *view, double error_px, double change) {
  double colors = change > 0.0 ? change / view->color_error : 0.0;
  return error_px > colors ? error_px : colors;
}

static conic_status measure_levels(fitting *f, const conic_hybrid_camera *view) {
  const conic_hybrid *h = f->hybrid;
  size_t n_levels = 0;
  for (size_t i = 0; i < f->n; i++)
    n_levels += h->clusters[f->clusters[i]].n_levels;
  double *next = f->errors_px = conic_memory_allocate(h->context, n_levels, sizeof *f->errors_px);
  if (!next)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < f->n; i++) {
    const conic_hybrid_cluster *cluster = &h->clusters[f->clusters[i]];
    for (uint32_t k = 0; k < cluster->n_levels; k++) {
      const conic_hybrid_level *level = &h->levels[cluster->first_level + k];
      *next++ = with_colors(view, conic_hybrid_error_px(view, &cluster->bound, level),
                            conic_hybrid_change(view, &cluster->bound, level));
    }
  }
  return CONIC_OK;
}

/* Where all is simplified as one, the greatest error is at few places. Such pictures are nearer to the mesh than those
 * of clusters that err by more than half of it (docs/notes/hybrid-measured.md). */
static const double weight_of_whole = 0.5;

static conic_status measure_nodes(fitting *f, const conic_hybrid_camera *view) {
  const conic_hybrid *h = f->hybrid;
  size_t n = h->n_nodes;
  f->first_errors = conic_memory_allocate(h->context, h->n_nodes, sizeof *f->first_errors);
  for (size_t i = 0; i < h->n_nodes; i++)
    n += h->nodes[i].n_levels;
  double *next = f->node_errors = conic_memory_allocate(h->context, n, sizeof *f->node_errors);
  if (!f->first_errors || !f->node_errors)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < h->n_nodes; i++) {
    const conic_hybrid_node *node = &h->nodes[i];
    f->first_errors[i] = (size_t)(next - f->node_errors);
    for (uint32_t k = 0; k < node->n_levels; k++) {
      const conic_hybrid_level *level = &h->levels[node->first_level + k];
      double weight = level->kind == CONIC_HYBRID_TRIANGLES ? weight_of_whole : 1.0;
      *next++ = with_colors(view, weight * conic_hybrid_node_error_px(h, view, node, level),
                            conic_hybrid_change(view, &node->bound, level));
    }
    *next++ = with_colors(view, conic_hybrid_point_error_px(view, node), conic_hybrid_point_change(view, node));
  }
  return CONIC_OK;
}

/* Halves the errors, which order like their bits as none is negative, down to the least at which the levels alone are
 * no more than the budget. */
static double least_error(fitting *f, uint64_t budget) {
  double error_px, next_px;
  choose_all(f, HUGE_VAL, &error_px, &next_px);
  uint64_t low = 0, high = conic_bits_of_double(error_px);
  while (high - low > 1) {
    uint64_t middle = low + (high - low) / 2;
    if (choose_all(f, conic_double_of_bits(middle), &error_px, &next_px) > budget)
      low = middle;
    else /* what was chosen may be better than what was asked for */
      high = error_px < conic_double_of_bits(middle) ? conic_bits_of_double(error_px) : middle;
  }
  return conic_double_of_bits(high);
}

/* choose_all, with what fits the choice to each other; whether the budget is enough. */
static int try_error(fitting *f, double error_px, uint64_t budget, uint64_t *count, double *greatest_px,
                     double *next_px) {
  *count = choose_all(f, error_px, greatest_px, next_px) + count_stitches(f);
  return *count <= budget;
}

/* Halves the errors between one that is too small and the greatest: finds one that is enough where the next smaller
 * one is not, which need not be the least of all. Returns whether there is any. */
static int halve_errors(fitting *f, double low_px, uint64_t budget, uint64_t *count, double *greatest_px) {
  double next_px;
  if (!try_error(f, HUGE_VAL, budget, count, greatest_px, &next_px))
    return 0;
  uint64_t low = conic_bits_of_double(low_px), high = conic_bits_of_double(*greatest_px);
  while (high > low && high - low > 1) {
    uint64_t middle = low + (high - low) / 2;
    if (!try_error(f, conic_double_of_bits(middle), budget, count, greatest_px, &next_px))
      low = middle;
    else
      high = *greatest_px < conic_double_of_bits(middle) ? conic_bits_of_double(*greatest_px) : middle;
  }
  return try_error(f, conic_double_of_bits(high), budget, count, greatest_px, &next_px);
}

/* With what fits clusters to each other, the number may go up and down with the error. So from here on each error is
 * tried, but no more of them than a frame has time for. Returns whether one was found, the number that it takes, or the
 * coarsest does, and the error of what was chosen. */
static int fit(fitting *f, uint64_t budget, uint64_t *count, double *greatest_px) {
  enum { ONE_BY_ONE = 64 };
  double next_px, error_px = 0.0;
  if (choose_all(f, error_px, greatest_px, &next_px) > budget)
    error_px = least_error(f, budget);
  for (int i = 0; i < ONE_BY_ONE; i++) {
    if (try_error(f, error_px, budget, count, greatest_px, &next_px))
      return 1;
    if (!(error_px < HUGE_VAL))
      return 0;
    error_px = next_px;
  }
  return halve_errors(f, error_px, budget, count, greatest_px);
}

/* Chooses for each cluster the level of fewest primitives; or of one kind alone, which may be fewer together. */
static conic_status fit_kinds(fitting *f, uint64_t budget, uint32_t *levels, uint32_t *nodes) {
  uint64_t fewest_count = UINT64_MAX;
  double least_px = 0.0;
  int is_found = 0, last = f->only_kind < 0 ? CONIC_HYBRID_SURFELS : f->only_kind;
  for (int kind = f->only_kind; kind <= last; kind++) {
    double greatest_px;
    uint64_t count;
    f->only_kind = kind;
    if (fit(f, budget, &count, &greatest_px) && (!is_found || greatest_px < least_px)) {
      is_found = 1;
      least_px = greatest_px;
      memcpy(levels, f->levels, f->n * sizeof *levels);
      memcpy(nodes, f->nodes, f->hybrid->n_nodes * sizeof *nodes);
    }
    fewest_count = count < fewest_count ? count : fewest_count;
  }
  return is_found ? CONIC_OK
                  : conic_fail(f->hybrid->context, CONIC_ERROR_ARGUMENT,
                               "hybrid: the coarsest of what is in sight are %llu triangles and surfels, more than the "
                               "budget of %llu",
                               (unsigned long long)fewest_count, (unsigned long long)budget);
}

static conic_status begin_budget(fitting *f, const conic_hybrid_camera *view) {
  const conic_hybrid *h = f->hybrid;
  f->levels = conic_memory_allocate(h->context, f->n, sizeof *f->levels);
  f->stages = conic_memory_allocate(h->context, h->n_clusters, sizeof *f->stages);
  f->counts = conic_memory_allocate_zeroed(h->context, h->n_clusters, sizeof *f->counts);
  f->standing = conic_memory_allocate(h->context, h->n_clusters, sizeof *f->standing);
  f->below = conic_memory_allocate(h->context, h->n_nodes, sizeof *f->below);
  f->nodes = conic_memory_allocate(h->context, h->n_nodes, sizeof *f->nodes);
  if (!f->levels || !f->stages || !f->counts || !f->standing || !f->below || !f->nodes)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < h->n_clusters; i++)
    f->stages[i] = CONIC_HYBRID_HIDDEN;
  conic_status status = measure_levels(f, view);
  return status == CONIC_OK ? measure_nodes(f, view) : status;
}

conic_status conic_hybrid_fit_budget(const conic_hybrid *hybrid, const conic_hybrid_camera *view, int only_kind,
                                     uint64_t budget, const uint32_t *clusters, size_t n, uint32_t *levels,
                                     uint32_t *nodes) {
  fitting f = {.hybrid = hybrid, .only_kind = only_kind, .budget = budget, .clusters = clusters, .n = n};
  conic_status status = begin_budget(&f, view);
  if (status == CONIC_OK)
    status = fit_kinds(&f, budget, levels, nodes);
  void *parts[] = {f.errors_px, f.node_errors, f.first_errors, f.nodes, f.below,
                   f.standing,  f.counts,      f.stages,       f.levels};
  conic_memory_release_all(hybrid->context, parts, sizeof parts / sizeof *parts);
  return status;
}
