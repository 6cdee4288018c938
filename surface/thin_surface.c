/* Thinning (PSS §5.1): removes the point that lies nearest to the surface of the others first.
 *
 * Removing a point changes its neighbours' contributions. The neighbours are marked, and measured anew when they come
 * to the front of the queue, so that none is removed on an old measure. A point's distance from the surface of the
 * others mostly grows when these become fewer, so hardly any comes to the front too late. */

#include "core/base/heap.h"
#include "core/base/team_runs.h"
#include "core/splats/splats_gather.h"
#include "surface/mls_surface.h"

/* Points measured together: a fixed number, so that the order does not depend on the threads. */
enum { BATCH = 64, REMOVALS_A_REPORT = 512, BATCHES_A_REPORT = 32 };

/* The limit for single removals that keeps the whole within its own is searched: so many tries, or more until one
 * succeeds. The first try takes this share of the whole limit. */
enum { MAX_TRIES = 5 };
static const double FIRST_SHARE = 0.3;

/* A stage ends when this share of its points is left: neighbours, scales and tree are then found anew. */
static const double STAGE_SHARE = 0.6;

CONIC_DEFINE_ZERO_OPTIONS(conic_thin_options)

typedef struct thinning {
  conic_surface *surface; /* its h is NaN for removed slots */
  conic_workspace *workspaces;
  conic_heap heap;
  uint8_t *is_stale;
  const uint32_t *batch;
  double greatest_error;
  size_t n_evaluations;
} thinning;

/* How far the slot is from the surface of the others; infinite where they have no surface there. */
static double contribution(const thinning *work, uint32_t slot, conic_workspace *workspace) {
  const conic_surface *surface = work->surface;
  const double r[3] = {(double)surface->tree.position[0][slot], (double)surface->tree.position[1][slot],
                       (double)surface->tree.position[2][slot]};
  conic_landing projection;
  conic_surface_project_one(surface, r, (double)surface->h[slot], slot, 0, workspace, &projection);
  const double *moved = projection.offset;
  return projection.outcome == CONIC_SURFACE_DONE
             ? sqrt(moved[0] * moved[0] + moved[1] * moved[1] + moved[2] * moved[2])
             : HUGE_VAL;
}

static void measure_chunk(void *data, size_t i_item, int i_thread) {
  thinning *work = data;
  size_t end = (i_item + 1) * BATCH, n = work->surface->tree.n_slots;
  for (size_t slot = i_item * BATCH; slot < end && slot < n; slot++)
    work->heap.keys[slot] = contribution(work, (uint32_t)slot, &work->workspaces[i_thread]);
}

static void measure_quarter(void *data, size_t i_item, int i_thread) {
  thinning *work = data;
  for (size_t i = i_item * (BATCH / 4); i < (i_item + 1) * (BATCH / 4); i++)
    if (work->batch[i] != CONIC_NO_SLOT)
      work->heap.keys[work->batch[i]] = contribution(work, work->batch[i], &work->workspaces[i_thread]);
}

/* Measures the stale slots at the front of the queue anew. Slots that can no longer be measured are never removed. */
static void refresh_front(thinning *work) {
  uint32_t batch[BATCH];
  size_t n = 0;
  while (n < BATCH && work->heap.n && work->is_stale[work->heap.slots[0]])
    batch[n++] = conic_heap_pop(&work->heap);
  for (size_t i = n; i < BATCH; i++)
    batch[i] = CONIC_NO_SLOT;
  work->batch = batch;
  conic_parallel_for(work->surface->context, 4, measure_quarter, work);
  for (size_t i = 0; i < n; i++) {
    work->is_stale[batch[i]] = 0;
    if (work->heap.keys[batch[i]] < HUGE_VAL)
      conic_heap_push(&work->heap, batch[i]);
  }
}

/* Removes the slot, and marks all slots that it had weight for. */
static void remove_slot(thinning *work, uint32_t slot) {
  conic_surface *surface = work->surface;
  conic_workspace *workspace = &work->workspaces[0];
  const double r[3] = {(double)surface->tree.position[0][slot], (double)surface->tree.position[1][slot],
                       (double)surface->tree.position[2][slot]};
  const double box[6] = {r[0], r[1], r[2], r[0], r[1], r[2]};
  double reach = surface->options.neglect * (double)surface->h[slot];
  surface->h[slot] = NAN;
  conic_surface_gather(surface, box, 0.0, workspace, &workspace->single);
  for (size_t i = 0; i < workspace->single.n; i++) {
    uint32_t other = workspace->single.sources[i];
    if (conic_neighbours_distance2(&surface->tree, other, r) < reach * reach)
      work->is_stale[other] = 1;
  }
}

static int allocate_thinning(thinning *work) {
  size_t n = work->surface->tree.n_slots;
  conic_context *context = work->surface->context;
  return conic_memory_allocate_these(context, CONIC_ROOM(work->heap.slots, n), CONIC_ROOM(work->heap.keys, n),
                                     CONIC_ZEROED(work->is_stale, n)) == CONIC_OK;
}

static conic_status measure_all(thinning *work) {
  conic_team_loop loop = conic_team_loop_of("measure", 0.0, 1.0, work->surface->tree.n_slots, BATCH, BATCHES_A_REPORT,
                                            measure_chunk, work);
  loop.columns[0] = (conic_team_column){work->heap.keys, sizeof *work->heap.keys};
  return conic_team_runs(work->surface->context, &loop);
}

conic_status conic_surface_contributions(conic_surface *surface, float *contributions) {
  conic_context *context = surface->context;
  const conic_neighbours *tree = &surface->tree;
  thinning work = {.surface = surface};
  work.heap.keys = conic_memory_allocate(context, tree->n_slots, sizeof *work.heap.keys);
  conic_status status = work.heap.keys ? conic_workspaces_create(context, &work.workspaces) : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK)
    status = measure_all(&work);
  if (status == CONIC_OK)
    status = conic_workspaces_check(context, work.workspaces);
  for (size_t i = 0; i < tree->n_points && status == CONIC_OK; i++) {
    double found = tree->slot_of_point[i] == CONIC_NO_SLOT ? HUGE_VAL : work.heap.keys[tree->slot_of_point[i]];
    contributions[i] = found < HUGE_VAL ? (float)found : NAN;
  }
  conic_memory_release(context, work.heap.keys);
  conic_workspaces_release(context, work.workspaces);
  return status;
}

/* Removes slots until `n_wanted` are left or the next one's contribution exceeds the limit; *n_left says how many are
 * left. */
static conic_status remove_slots(thinning *work, size_t n_wanted, double max_error, size_t *n_left) {
  conic_context *context = work->surface->context;
  size_t n = work->surface->tree.n_slots;
  conic_status status = measure_all(work);
  if (status == CONIC_OK)
    status = conic_workspaces_count(context, work->workspaces, &work->n_evaluations);
  if (status != CONIC_OK)
    return status;
  for (size_t slot = 0; slot < n; slot++)
    if (work->heap.keys[slot] < HUGE_VAL)
      conic_heap_push(&work->heap, (uint32_t)slot);
  *n_left = n;
  while (*n_left > n_wanted && work->heap.n) {
    uint32_t first = work->heap.slots[0];
    if (work->is_stale[first]) {
      refresh_front(work);
      continue;
    }
    if (max_error > 0.0 && !(work->heap.keys[first] <= max_error))
      break;
    conic_heap_pop(&work->heap);
    work->greatest_error =
        work->heap.keys[first] > work->greatest_error ? work->heap.keys[first] : work->greatest_error;
    remove_slot(work, first);
    if (--*n_left % REMOVALS_A_REPORT == 0) {
      status = conic_progress(context, "thin", (double)(n - *n_left) / (double)(n - n_wanted));
      if (status != CONIC_OK)
        return status;
    }
  }
  return conic_workspaces_check(context, work->workspaces);
}

/* Copies the points of the remaining slots, one a slot, in their old order. */
static conic_status copy_left(const conic_surface *surface, size_t n_left, conic_splats *left) {
  const conic_neighbours *tree = &surface->tree;
  uint32_t *points = conic_memory_allocate(surface->context, n_left, sizeof *points);
  if (!points)
    return CONIC_ERROR_MEMORY;
  size_t n = 0;
  for (size_t i = 0; i < tree->n_points && n < n_left; i++) {
    uint32_t slot = tree->slot_of_point[i];
    if (slot != CONIC_NO_SLOT && tree->point_of_slot[slot] == i && surface->h[slot] >= 0.0f)
      points[n++] = (uint32_t)i;
  }
  conic_status status = conic_splats_gather(surface->context, &surface->points, points, n_left, left);
  conic_memory_release(surface->context, points);
  return status;
}

/* One stage of thinning: from `points` to the remaining ones. */
static conic_status thin_stage(conic_context *context, const conic_surface_options *options,
                               const conic_thin_options *wanted, const conic_splats *points, conic_splats *left,
                               conic_surface_report *report) {
  thinning work = {.greatest_error = report->error};
  size_t n_left = 0;
  conic_status status = conic_surface_create(context, points, options, &work.surface);
  if (status != CONIC_OK)
    return status;
  size_t n_stage = (size_t)(STAGE_SHARE * (double)work.surface->tree.n_slots);
  status = conic_workspaces_create(context, &work.workspaces);
  for (int i = 0; status == CONIC_OK && i < conic_context_threads(context); i++)
    work.workspaces[i].is_trusting = 1;
  if (status == CONIC_OK && !allocate_thinning(&work))
    status = CONIC_ERROR_MEMORY;
  if (status == CONIC_OK)
    status = remove_slots(&work, wanted->count > n_stage ? wanted->count : n_stage, wanted->max_error, &n_left);
  if (status == CONIC_OK)
    status = copy_left(work.surface, n_left, left);
  for (int i = 0; work.workspaces && i < conic_context_threads(context); i++)
    report->n_evaluations += work.workspaces[i].n_evaluations;
  report->n_evaluations += work.n_evaluations;
  report->error = work.greatest_error;
  conic_memory_release_these(context, work.heap.slots, work.heap.keys, work.is_stale);
  conic_workspaces_release(context, work.workspaces);
  conic_surface_destroy(work.surface);
  return status;
}

/* Runs stages until `count` points are left or a stage removes nothing. */
static conic_status thin_once(const conic_surface *surface, const conic_thin_options *wanted, conic_splats *thinned,
                              conic_surface_report *report) {
  conic_context *context = surface->context;
  conic_surface_options stage_options = surface->options;
  conic_splats now = surface->points, next;
  conic_status status = CONIC_OK;
  int is_own = 0;
  stage_options.cluster = 0.0; /* clusters cannot lose a point */
  for (size_t before = SIZE_MAX; now.count < before && (now.count > wanted->count || !is_own);) {
    before = now.count;
    status = thin_stage(context, &stage_options, wanted, &now, &next, report);
    if (status != CONIC_OK)
      break;
    if (is_own)
      conic_splats_release(context, &now);
    now = next;
    is_own = 1;
  }
  if (status == CONIC_OK)
    *thinned = now;
  else if (is_own)
    conic_splats_release(context, &now);
  return status;
}

static conic_status measure_both(conic_surface *surface, const conic_splats *thinned, conic_surface_report *report) {
  conic_surface *left;
  conic_status status = conic_surface_create(surface->context, thinned, &surface->options, &left);
  if (status == CONIC_OK)
    status = conic_surface_deviation(surface, left, &report->there);
  if (status == CONIC_OK)
    status = conic_surface_deviation(left, surface, &report->back);
  conic_surface_destroy(left);
  return status;
}

/* Whether the two surfaces are as near as wanted; a few points in a thousand may have nothing of the other surface near
 * them where it has a border. */
static int is_near_enough(const conic_surface_report *report, double max_error) {
  const conic_surface_distance *there = &report->there, *back = &report->back;
  return there->max <= max_error && back->max <= max_error && there->n_failed <= there->n_measured / 250 &&
         back->n_failed <= back->n_measured / 250;
}

/* Each removal is measured against the remaining points, so errors add up to an unknown sum. Searches for the limit of
 * single removals that keeps the measured sum within the wanted limit with the fewest points. */
static conic_status thin_within(conic_surface *surface, const conic_thin_options *options, conic_splats *thinned,
                                conic_surface_report *report) {
  conic_context *context = surface->context;
  conic_thin_options wanted = *options;
  double good = 0.0, bad = HUGE_VAL;
  conic_status status = CONIC_OK;
  wanted.max_error = FIRST_SHARE * options->max_error;
  for (int i = 0; status == CONIC_OK && (i < MAX_TRIES || good == 0.0); i++) {
    conic_surface_report counted = {0};
    conic_splats tried;
    status = thin_once(surface, &wanted, &tried, &counted);
    if (status != CONIC_OK)
      break;
    status = measure_both(surface, &tried, &counted);
    counted.n_evaluations += report->n_evaluations;
    int is_good =
        status == CONIC_OK && (is_near_enough(&counted, options->max_error) || tried.count == surface->tree.n_slots);
    if (is_good) {
      conic_splats_release(context, thinned);
      *thinned = tried;
      *report = counted;
      good = wanted.max_error;
      if (tried.count <= options->count || tried.count == surface->tree.n_slots)
        break;
    } else {
      conic_splats_release(context, &tried);
      report->n_evaluations = counted.n_evaluations;
      bad = wanted.max_error;
    }
    wanted.max_error = bad == HUGE_VAL ? 2.0 * good : good == 0.0 ? 0.4 * bad : sqrt(good * bad);
  }
  return status;
}

conic_status conic_surface_thin(conic_surface *surface, const conic_thin_options *given, conic_splats *thinned,
                                conic_surface_report *report) {
  conic_context *context = surface->context;
  conic_thin_options own, *options = &own;
  conic_surface_report counted = {0};
  memset(thinned, 0, sizeof *thinned);
  conic_thin_options_init(options);
  if (!conic_options_take(options, given) || !(options->max_error >= 0.0) ||
      (options->count == 0 && !(options->max_error > 0.0)))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "thin: neither a count nor an error is given");
  conic_status status = CONIC_OK;
  if (options->max_error > 0.0)
    status = thin_within(surface, options, thinned, &counted);
  else {
    status = thin_once(surface, options, thinned, &counted);
    if (status == CONIC_OK && options->is_measured)
      status = measure_both(surface, thinned, &counted);
  }
  if (status != CONIC_OK) {
    conic_splats_release(context, thinned);
    return status;
  }
  counted.n_in = surface->points.count;
  counted.n_out = thinned->count;
  counted.h = surface->median_h;
  if (report)
    *report = counted;
  return CONIC_OK;
}
