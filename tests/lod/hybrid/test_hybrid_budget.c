/* Hybrid models under a budget: never more primitives than that, and no smaller error could have been had. */
#include <stdatomic.h>

#include "core/base/vectors.h"
#include "lod/hybrid/draw/hybrid_offers.h"
#include "lod/hybrid/draw/hybrid_selecting.h"
#include "tests/support/hybrid_fixture.h"

typedef struct spending {
  conic_context *context;
  conic_hybrid *hybrid;
  conic_hybrid_info info;
  conic_camera camera;
  conic_render_options options;
  conic_hybrid_selection selection;
  unsigned char *is_seen;            /* cluster by cluster */
  const conic_hybrid_level **chosen; /* what the fewest are, cluster by cluster; null where it is not seen or a node
                                        stands for it */
  uint32_t *stages;                  /* theirs */
  size_t *counts;                    /* cluster by cluster, of the fewest by themselves */
} spending;

static void look(spending *s, double azimuth, double zoom) {
  conic_framing framing;
  conic_framing_init(&framing);
  framing.width = framing.height = 300;
  framing.azimuth_deg = azimuth;
  framing.elevation_deg = 25.0;
  framing.zoom = zoom;
  CHECK_OK(conic_camera_frame(s->context, &framing, s->info.minimum, s->info.maximum, &s->camera));
}

/* So near that clusters reach the near plane, where pixels have no bound. */
static void look_from_within(spending *s) {
  look(s, 30.0, 1.0);
  for (int row = 0; row < 3; row++) {
    double center = 0.0;
    for (int axis = 0; axis < 3; axis++)
      center += 0.5 * (s->info.minimum[axis] + s->info.maximum[axis]) * s->camera.cam_from_world[row][axis];
    s->camera.cam_from_world[row][3] = -center;
  }
}

static conic_status select_with(spending *s, int only_kind, double error_px, uint64_t budget) {
  conic_hybrid_view view;
  conic_hybrid_view_init(&view);
  view.only_kind = only_kind;
  view.error_px = error_px;
  view.budget = budget;
  return conic_hybrid_select(s->hybrid, &s->camera, &s->options, &view, &s->selection);
}

static size_t n_selected(const spending *s) {
  return s->selection.splats.count + s->selection.triangles.count;
}

/* The error as budgets have it: half of it where all clusters are triangles as one. */
static double judged_px(const spending *s) {
  int is_whole = s->selection.triangles.count > 0 && s->selection.n_clusters[0] + s->selection.n_clusters[1] == 0;
  return is_whole ? 0.5 * s->selection.error_px : s->selection.error_px;
}

/* The clusters that are drawn, by what the selection says of its parts where no node stands for any. */
static void mark_seen(spending *s) {
  CHECK_OK(select_with(s, -1, 0.0, 0));
  CHECK(s->selection.n_joined == 0);
  memset(s->is_seen, 0, s->info.n_clusters);
  for (size_t i = 0; i < s->selection.splats.count; i++)
    s->is_seen[s->selection.splat_cluster[i]] = 1;
  for (size_t i = 0; i < s->selection.triangles.count; i++)
    s->is_seen[s->selection.triangles.cluster[i]] = 1;
}

static void note(double error, double error_px, double *next) {
  *next = error > error_px && error < *next ? error : *next;
}

/* Of the root's triangles the most that there may be; else the fewest. */
static int is_own_offer(const conic_hybrid_level *level, int only_kind, size_t own, size_t budget) {
  size_t n = level ? level->count : 1;
  if (level && level->kind == CONIC_HYBRID_TRIANGLES)
    return only_kind != CONIC_HYBRID_SURFELS && own > budget;
  return only_kind != CONIC_HYBRID_TRIANGLES && n < own;
}

/* How few the clusters below a node are, one by one or by nodes that stand for them. */
static size_t fewest_below(const spending *s, const conic_hybrid_camera *view, uint32_t i, int only_kind, size_t budget,
                           double error_px, double *next) {
  const conic_hybrid_node *node = &s->hybrid->nodes[i];
  size_t count = 0, own = SIZE_MAX;
  for (uint32_t k = node->begin; k < node->end && node->next == i + 1; k++)
    count += s->is_seen[k] ? s->counts[k] : 0;
  for (uint32_t child = i + 1; child < node->next; child = s->hybrid->nodes[child].next)
    count += fewest_below(s, view, child, only_kind, budget, error_px, next);
  for (uint32_t k = 0; k <= node->n_levels; k++) {
    const conic_hybrid_level *level = k < node->n_levels ? &s->hybrid->levels[node->first_level + k] : NULL;
    double weight = level && level->kind == CONIC_HYBRID_TRIANGLES ? 0.5 : 1.0;
    double error = level ? weight * conic_hybrid_node_error_px(s->hybrid, view, node, level)
                         : conic_hybrid_point_error_px(view, node);
    note(error, error_px, next);
    if (error <= error_px && is_own_offer(level, only_kind, own, budget) && (level || node->point.radius > 0.0f))
      own = level ? level->count : 1;
  }
  if (own >= count)
    return count;
  for (uint32_t k = node->begin; k < node->end; k++) {
    s->stages[k] = s->is_seen[k] ? 0 : CONIC_HYBRID_HIDDEN;
    s->chosen[k] = NULL;
  }
  return own;
}

/* Of as many, what is drawn faster. */
static int is_own_level(const conic_hybrid_camera *view, const conic_hybrid_cluster *cluster,
                        const conic_hybrid_level *level, const conic_hybrid_level *chosen) {
  return !chosen || level->count < chosen->count ||
         (level->count == chosen->count &&
          conic_hybrid_cost(view, cluster, level) < conic_hybrid_cost(view, cluster, chosen));
}

/* How few primitives, with those that fit them to each other, keep every seen cluster's error on the screen at or below
 * `error_px`; where surfels alone are asked for and none are good enough, the finest count. `next` becomes the least
 * error above it that any level has. */
static size_t fewest(const spending *s, const conic_hybrid_camera *view, int only_kind, size_t budget, double error_px,
                     double *next) {
  size_t count = 0;
  *next = HUGE_VAL;
  for (size_t i = 0; i < s->info.n_clusters; i++) {
    const conic_hybrid_cluster *cluster = &s->hybrid->clusters[i];
    size_t finest = 0;
    const conic_hybrid_level *chosen = NULL, *first = NULL;
    for (uint32_t k = cluster->n_levels; s->is_seen[i] && k-- > 0;) {
      const conic_hybrid_level *level = &s->hybrid->levels[cluster->first_level + k];
      double error = conic_hybrid_error_px(view, &cluster->bound, level);
      if (only_kind >= 0 && level->kind != (uint32_t)only_kind)
        continue;
      finest = level->count;
      first = level;
      if (error <= error_px && is_own_level(view, cluster, level, chosen))
        chosen = level;
      note(error, error_px, next);
    }
    s->counts[i] = chosen ? chosen->count : finest;
    count += s->counts[i];
    s->chosen[i] = chosen ? chosen : first;
    s->stages[i] = s->chosen[i] ? s->chosen[i]->stage : CONIC_HYBRID_HIDDEN;
  }
  count = fewest_below(s, view, 0, only_kind, budget, error_px, next);
  for (size_t i = 0; i < s->info.n_clusters; i++)
    count += s->chosen[i] ? conic_hybrid_count_stitches(s->hybrid, (uint32_t)i, s->chosen[i], s->stages) : 0;
  return count;
}

/* The least error of which so few are enough, by trying every one that there is. */
static double least_error(const spending *s, int only_kind, size_t budget) {
  conic_hybrid_camera view;
  conic_hybrid_camera_init(s->hybrid, &s->camera, &s->options, &view);
  for (double error = 0.0;;) {
    double next;
    if (fewest(s, &view, only_kind, budget, error, &next) <= budget)
      return error;
    if (!(error < HUGE_VAL))
      return NAN;
    error = next;
  }
}

/* What no budget makes better: the finest levels' error, where all of the kind have one. */
static double floor_error(const spending *s, int only_kind) {
  conic_hybrid_camera view;
  double greatest = 0.0;
  conic_hybrid_camera_init(s->hybrid, &s->camera, &s->options, &view);
  for (size_t i = 0; i < s->info.n_clusters; i++) {
    const conic_hybrid_cluster *cluster = &s->hybrid->clusters[i];
    uint32_t k = 0;
    while (only_kind >= 0 && s->hybrid->levels[cluster->first_level + k].kind != (uint32_t)only_kind)
      k++;
    double error = conic_hybrid_error_px(&view, &cluster->bound, &s->hybrid->levels[cluster->first_level + k]);
    greatest = s->is_seen[i] && error > greatest ? error : greatest;
  }
  return greatest;
}

static void check_budget(spending *s, int only_kind, size_t budget) {
  conic_hybrid_camera view;
  conic_hybrid_camera_init(s->hybrid, &s->camera, &s->options, &view);
  CHECK_OK(select_with(s, only_kind, 0.0, budget));
  double expected = HUGE_VAL, next;
  int is_counted = 0;
  int last = only_kind < 0 ? CONIC_HYBRID_SURFELS : only_kind;
  for (int kind = only_kind; kind <= last; kind++) { /* one kind alone may be fewer */
    double least = least_error(s, kind, budget);
    if (!isnan(least))
      expected = fmin(expected, fmax(least, floor_error(s, kind)));
    is_counted |= !isnan(least) && fewest(s, &view, kind, budget, least, &next) == n_selected(s);
  }
  CHECK(n_selected(s) > 0 && n_selected(s) <= budget && is_counted);
  CHECK(s->selection.n_clusters[0] + s->selection.n_clusters[1] + s->selection.n_joined + s->selection.n_culled ==
        s->info.n_clusters);
  if (only_kind >= 0)
    CHECK(s->selection.n_clusters[1 - only_kind] == 0);
  if (!(judged_px(s) == expected))
    fprintf(stderr, "budget %zu: error %.17g, and %.17g could be had\n", budget, judged_px(s), expected);
  CHECK(judged_px(s) == expected);
}

/* From what everything takes down to a single point; of triangles to less than the coarsest take. */
static void check_view(spending *s, int only_kind) {
  double last = 0.0;
  size_t budget = 2 * s->info.n_vertices + s->info.n_all_surfels, n_steps = 0;
  mark_seen(s);
  for (; budget > 0 && select_with(s, only_kind, 0.0, budget) == CONIC_OK; n_steps++) {
    CHECK(judged_px(s) >= last);
    last = judged_px(s);
    check_budget(s, only_kind, budget);
    budget = n_selected(s) * 9 / 10;
  }
  printf("kind %d: %zu budgets, errors up to %g px\n", only_kind, n_steps, last);
  CHECK(n_steps > 5 && last > 0.5);
  if (only_kind != CONIC_HYBRID_TRIANGLES) {
    CHECK(n_selected(s) == 1 && s->selection.n_points == 1);
    return;
  }
  CHECK(budget > 0 && select_with(s, only_kind, 0.0, budget) == CONIC_ERROR_ARGUMENT);
  CHECK(isnan(least_error(s, only_kind, budget)));
}

/* Nodes stand for clusters where that is cheaper, in no more places than the error allows. */
static void check_nodes(spending *s) {
  CHECK_OK(select_with(s, -1, 40.0, 0));
  CHECK(s->selection.n_joined > 1 && s->selection.n_nodes + s->selection.n_points > 0);
  CHECK(s->selection.error_px <= 40.0);
  CHECK(s->selection.n_clusters[0] + s->selection.n_clusters[1] + s->selection.n_joined + s->selection.n_culled ==
        s->info.n_clusters);
  for (size_t i = 0; i < s->selection.splats.count; i++)
    CHECK(s->selection.splat_cluster[i] < s->info.n_clusters + s->info.n_nodes);
  size_t n = n_selected(s);
  CHECK_OK(select_with(s, CONIC_HYBRID_TRIANGLES, 40.0, 0));
  CHECK(s->selection.splats.count == 0 && n_selected(s) >= n);
  CHECK_OK(select_with(s, CONIC_HYBRID_SURFELS, 40.0, 0));
  CHECK(s->selection.n_joined > 0 && s->selection.triangles.count == 0);
  CHECK_OK(select_with(s, -1, 0.0, n)); /* as many do no worse */
  CHECK(judged_px(s) <= 40.0);
}

/* A point hides its node's sphere: it is seen under the same angle or a wider one. Neither it nor surfels have a bound
 * where the sphere reaches near. */
static void check_points(const spending *s) {
  const conic_hybrid *h = s->hybrid;
  conic_hybrid_camera view;
  conic_hybrid_camera_init(h, &s->camera, &s->options, &view);
  for (size_t i = 0; i < h->n_nodes; i++) {
    const conic_hybrid_node *node = &h->nodes[i];
    double way[3], axis[3], radius = (double)node->point.radius, cutoff = (double)h->cutoff;
    float values[12];
    conic_hybrid_point_splat(&view, node, cutoff, values);
    for (int k = 0; k < 3; k++) {
      way[k] = (double)node->bound.center[k] - view.from.eye[k];
      axis[k] = cutoff * (double)values[3 + k];
    }
    double distance2 = conic_dot(way, way), disc2 = conic_dot(axis, axis);
    CHECK(distance2 > radius * radius && fabs(conic_dot(way, axis)) < 1e-6 * distance2);
    CHECK(disc2 * distance2 >= radius * radius * (distance2 + disc2) * (1.0 - 1e-6));
    CHECK(conic_hybrid_point_error_px(&view, node) < HUGE_VAL);
    conic_hybrid_camera near = view;
    near.near_z = conic_dot(view.from.rotation[2], way) - 0.9 * (double)node->bound.radius;
    CHECK(conic_hybrid_point_error_px(&near, node) == HUGE_VAL);
    if (node->n_levels > 0)
      CHECK(conic_hybrid_error_px(&near, &node->bound, &h->levels[node->first_level]) == HUGE_VAL);
  }
}

/* An error that is asked for is kept, and said. */
static void check_errors(spending *s) {
  static const double errors[] = {0.25, 1.0, 4.0};
  for (size_t i = 0; i < sizeof errors / sizeof *errors; i++) {
    CHECK_OK(select_with(s, -1, errors[i], 0));
    CHECK(s->selection.error_px > 0.0 && s->selection.error_px <= errors[i]);
    size_t n = n_selected(s);
    CHECK_OK(select_with(s, -1, 0.0, n)); /* as many do no worse */
    CHECK(judged_px(s) <= errors[i]);
  }
  CHECK_OK(select_with(s, CONIC_HYBRID_TRIANGLES, 0.0, 0));
  CHECK(s->selection.error_px == 0.0);
  CHECK(select_with(s, -1, 1.0, 1000) == CONIC_ERROR_ARGUMENT);
}

static atomic_int n_left = 1 << 30; /* any thread asks */

static void *allocate_few(void *cookie, size_t bytes) {
  (void)cookie;
  return atomic_fetch_sub(&n_left, 1) > 0 ? malloc(bytes) : NULL;
}

static void release_any(void *cookie, void *pointer) {
  (void)cookie;
  free(pointer);
}

/* Memory that runs out anywhere is told, and nothing is lost. */
static void check_memory(spending *s) {
  int n_failed = 0;
  conic_hybrid_selection_release(s->context, &s->selection);
  for (n_left = 0; select_with(s, -1, 0.0, 1000) == CONIC_ERROR_MEMORY; n_left = ++n_failed)
    CHECK(n_failed < 100);
  CHECK(n_failed > 4);
  n_left = 1 << 30;
  CHECK_OK(select_with(s, -1, 0.0, 1000));
}

static void check_numbers(const spending *s) {
  const conic_splats *splats = &s->selection.splats;
  for (size_t i = 0; i < splats->count; i++)
    for (int axis = 0; axis < 3; axis++)
      CHECK(isfinite(splats->position[axis][i]) && isfinite(splats->tangent_u[axis][i]) &&
            isfinite(splats->tangent_v[axis][i]));
}

/* The eye is in the spheres of nodes: their points cannot be drawn, and are not chosen, however few there may be. */
static void check_within(spending *s) {
  int n_kept = 0;
  for (size_t budget = 1; budget < 3000; budget *= 2)
    if (select_with(s, -1, 0.0, budget) == CONIC_OK) {
      CHECK(n_selected(s) > 0 && n_selected(s) <= budget);
      check_numbers(s);
      n_kept++;
    }
  CHECK(n_kept > 0);
  for (int only_kind = -1; only_kind < 2; only_kind += 2) {
    CHECK_OK(select_with(s, only_kind, HUGE_VAL, 0));
    CHECK(n_selected(s) > 0 && s->selection.n_joined < s->info.n_clusters);
    check_numbers(s);
  }
}

/* Of a model without points none is drawn, whatever the error. */
static void check_without_points(conic_context *context) {
  spending s = {.context = context};
  conic_hybrid_options how;
  conic_triangles mesh;
  conic_hybrid_options_init(&how);
  conic_render_options_init(&s.options);
  how.has_single_levels = 1;
  hybrid_terrain(context, 12, &mesh);
  CHECK_OK(conic_hybrid_build(context, &mesh, &how, &s.hybrid, NULL));
  CHECK_OK(conic_hybrid_describe(s.hybrid, &s.info));
  s.options.near_z = s.info.near_z;
  look(&s, 30.0, 1.0);
  for (int only_kind = -1; only_kind < 2; only_kind += 2) {
    CHECK_OK(select_with(&s, only_kind, HUGE_VAL, 0));
    CHECK(s.selection.n_joined == 0 && s.selection.n_points == 0 && n_selected(&s) >= s.info.n_clusters);
  }
  conic_hybrid_selection_release(context, &s.selection);
  conic_hybrid_destroy(s.hybrid);
}

int main(void) {
  conic_context_options options;
  conic_hybrid_options how;
  conic_triangles mesh;
  spending s;
  memset(&s, 0, sizeof s);
  conic_context_options_init(&options);
  options.threads = 2;
  options.allocate = allocate_few;
  options.release = release_any;
  CHECK_OK(conic_context_create(&options, &s.context));
  conic_hybrid_options_init(&how);
  conic_render_options_init(&s.options);
  hybrid_terrain(s.context, 60, &mesh);
  CHECK_OK(conic_hybrid_build(s.context, &mesh, &how, &s.hybrid, NULL));
  CHECK_OK(conic_hybrid_describe(s.hybrid, &s.info));
  s.options.near_z = s.info.near_z;
  s.is_seen = malloc(s.info.n_clusters);
  s.chosen = malloc(s.info.n_clusters * sizeof *s.chosen);
  s.stages = malloc(s.info.n_clusters * sizeof *s.stages);
  s.counts = malloc(s.info.n_clusters * sizeof *s.counts);
  if (!s.is_seen || !s.chosen || !s.stages || !s.counts)
    exit(1);
  look(&s, 30.0, 1.0);
  for (int only_kind = -1; only_kind < 2; only_kind++)
    check_view(&s, only_kind);
  check_errors(&s);
  check_nodes(&s);
  check_points(&s);
  check_memory(&s);
  look(&s, 200.0, 4.0); /* half of it is out of sight */
  check_view(&s, -1);
  CHECK(s.selection.n_culled > 0);
  look_from_within(&s);
  mark_seen(&s);
  check_budget(&s, -1, 20000);
  check_budget(&s, -1, 3000);
  check_budget(&s, CONIC_HYBRID_SURFELS, 3000);
  check_within(&s);
  check_without_points(s.context);
  conic_hybrid_selection_release(s.context, &s.selection);
  conic_hybrid_destroy(s.hybrid);
  free(s.is_seen);
  free(s.chosen);
  free(s.stages);
  free(s.counts);
  conic_context_destroy(s.context);
  return check_result();
}
