/* Projects sets larger than memory. Points are put in the order of a lattice's cells; each cell is projected as a set
 * of its own, together with the points that reach into it; and the results are put back into the old order. In a team,
 * each process keeps the cells of its own points and those around them, and the first process gets all results. */

#include "core/base/real.h"
#include "core/base/team_runs.h"
#include "core/splats/columns.h"
#include "core/splats/splats_gather.h"
#include "surface/cells.h"
#include "surface/cells_results.h"
#include "surface/own_points.h"

/* A cell's side in h: so large that the points around it are few beside its own. */
static const double CELL_SIDE = 64.0;

/* Feet are looked for within half of h, and found again from the projected point, which is hardly ever farther off than
 * h. */
static const double HALO = 1.5;

/* The bytes that a point of a cell takes during projection, without and with finding its normals, and the bytes of
 * everything else. */
enum { BYTES_A_POINT = 192, BYTES_WITH_NORMALS = 320, OTHER_BYTES = 12 << 20 };

/* Records that are handled at a time. */
enum { BATCH = 1 << 16, PAGE = 4096 };

typedef struct record {
  conic_cell_sample point;
  uint32_t unused;
  uint64_t index; /* in the set */
} record;

/* Sums over the points as whole numbers, so that they do not depend on the processes. */
typedef struct cells_sums {
  uint64_t outcomes[CONIC_N_SURFACE_OUTCOMES], n_merged, n_evaluations, neighbours;
  uint64_t moved2[2]; /* in units of h² / 2^24, and the rest in 2^-30 of that */
  double moved2_most;
} cells_sums;

typedef struct cleaning {
  conic_context *context;
  const conic_clean_options *options;
  const conic_team *team; /* null: this process is alone */
  conic_cells cells;
  conic_cells_share share;
  conic_store records; /* by cell */
  conic_cells_results results;
  uint64_t n_points, n_finite, n_placed;
  double origin[3];
  unsigned fields; /* normals (of either kind) and colours of the points */
  record *page;    /* BATCH of them */
  uint64_t *keys;  /* BATCH of them: cell and number in a batch */
  conic_splats subset;
  size_t subset_room;
  cells_sums sums;
  conic_surface_report report;
} cleaning;

static int has_all_results(const cleaning *work) {
  return !work->team || work->team->index == 0;
}

static const char *name_of(const cleaning *work) {
  return work->options->name ? work->options->name : "surface";
}

/* Spheres need normals: where the points have none, each cell finds its own. Their sides may differ in the next cell,
 * which changes no sphere; so the results get no normals. */
static int finds_normals(const cleaning *work) {
  return work->options->surface.type == CONIC_SURFACE_APSS && !(work->fields & CONIC_SPLATS_NORMALS);
}

static uint64_t bytes_a_point(const cleaning *work) {
  return finds_normals(work) ? BYTES_WITH_NORMALS : BYTES_A_POINT;
}

static void put_sample(const conic_cell_sample *from, conic_splats *to, size_t i) {
  for (int axis = 0; axis < 3; axis++) {
    to->position[axis][i] = from->position[axis];
    if (to->normal[0])
      to->normal[axis][i] = from->normal[axis];
    if (to->color[0])
      to->color[axis][i] = from->color[axis];
  }
}

/* --- the points, put in the order of the cells --- */

typedef conic_status batch_taker(cleaning *work, const conic_splats *batch);

static conic_status enter_batch(cleaning *work, const conic_splats *batch, batch_taker *take) {
  conic_splats close;
  float *block;
  conic_status status = conic_splats_enter(work->context, name_of(work), batch, &close, &block);
  if (status == CONIC_OK)
    status = take(work, &close);
  conic_memory_release(work->context, block);
  return status;
}

static unsigned fields_of(const conic_splats *batch) {
  unsigned fields = conic_splats_fields(batch);
  return (fields & CONIC_SPLATS_COLORS) |
         (fields & (CONIC_SPLATS_NORMALS | CONIC_SPLATS_TANGENTS) ? (unsigned)CONIC_SPLATS_NORMALS : 0u);
}

static conic_status count_points(cleaning *work, const conic_splats *batch) {
  work->fields = fields_of(batch);
  memcpy(work->origin, batch->origin, sizeof work->origin);
  for (size_t i = 0; i < batch->count; i++) {
    const float place[3] = {batch->position[0][i], batch->position[1][i], batch->position[2][i]};
    int32_t at[3];
    work->n_points++;
    if (!(place[0] - place[0] == 0.0f && place[1] - place[1] == 0.0f && place[2] - place[2] == 0.0f))
      continue;
    if (!conic_cells_locate(&work->cells, place, at))
      return conic_fail(work->context, CONIC_ERROR_ARGUMENT, "surface: h %g is too small for where the points are",
                        work->options->surface.h);
    conic_status status = conic_cells_count(&work->cells, at, place);
    if (status != CONIC_OK)
      return status;
    work->n_finite++;
  }
  return conic_progress(work->context, "sort", 0.0);
}

static conic_status count_batch(void *cookie, const conic_splats *batch) {
  return enter_batch(cookie, batch, count_points);
}

static void fill_record(const conic_splats *batch, size_t i, uint64_t index, unsigned fields, record *r) {
  double normal[3];
  memset(r, 0, sizeof *r);
  r->index = index;
  if (fields & CONIC_SPLATS_NORMALS)
    conic_surface_unit_normal(batch, i, normal);
  for (int axis = 0; axis < 3; axis++) {
    r->point.position[axis] = batch->position[axis][i];
    if (fields & CONIC_SPLATS_NORMALS)
      r->point.normal[axis] = (float)normal[axis];
    if (fields & CONIC_SPLATS_COLORS)
      r->point.color[axis] = batch->color[axis][i];
  }
}

CONIC_DEFINE_ORDER_OF(compare_keys, uint64_t)

/* Places points first … first + n - 1 of a batch; those that are not finite go straight to the results. */
static conic_status place_points(cleaning *work, const conic_splats *batch, size_t first, size_t n) {
  size_t n_keys = 0;
  conic_status status = CONIC_OK;
  for (size_t i = 0; i < n && status == CONIC_OK; i++) {
    const float place[3] = {batch->position[0][first + i], batch->position[1][first + i],
                            batch->position[2][first + i]};
    int32_t at[3];
    const conic_cell *cell = conic_cells_locate(&work->cells, place, at) ? conic_cells_find(&work->cells, at) : NULL;
    if (cell && work->share.parts[cell - work->cells.cells].is_kept)
      work->keys[n_keys++] = (uint64_t)(cell - work->cells.cells) << 32 | i;
    else if (!cell && has_all_results(work)) {
      const conic_cell_result none = {.outcome = CONIC_SURFACE_NOT_FINITE};
      status = conic_cells_results_keep(&work->results, work->n_placed + i, 1, &none);
    }
  }
  qsort(work->keys, n_keys, sizeof *work->keys, compare_keys);
  for (size_t i = 0; i < n_keys; i++) {
    size_t at = (size_t)(work->keys[i] & UINT32_MAX);
    fill_record(batch, first + at, work->n_placed + at, work->fields, &work->page[i]);
  }
  for (size_t i = 0, end; i < n_keys && status == CONIC_OK; i = end) {
    conic_cell *cell = &work->cells.cells[work->keys[i] >> 32];
    for (end = i + 1; end < n_keys && work->keys[end] >> 32 == work->keys[i] >> 32;)
      end++;
    if (cell->filled + (end - i) > cell->count)
      return conic_fail(work->context, CONIC_ERROR_INPUT, "%s: the points changed while they were read", name_of(work));
    status = conic_store_write(&work->records, cell->start + cell->filled, end - i, work->page + i);
    cell->filled += end - i;
  }
  work->n_placed += n;
  return status;
}

static conic_status place_all(cleaning *work, const conic_splats *batch) {
  conic_status status = CONIC_OK;
  if (work->n_placed + batch->count > work->n_points || fields_of(batch) != work->fields)
    return conic_fail(work->context, CONIC_ERROR_INPUT, "%s: the points changed while they were read", name_of(work));
  for (size_t i = 0; i < batch->count && status == CONIC_OK; i += BATCH)
    status = place_points(work, batch, i, batch->count - i < BATCH ? batch->count - i : BATCH);
  return status == CONIC_OK ? conic_progress(work->context, "sort", (double)work->n_placed / (double)work->n_points)
                            : status;
}

static conic_status place_batch(void *cookie, const conic_splats *batch) {
  return enter_batch(cookie, batch, place_all);
}

/* --- a cell --- */

/* Whether so many points, with the memory that they take, fit. */
static conic_status check_room(const cleaning *work, uint64_t n) {
  uint64_t bytes = n * bytes_a_point(work) + OTHER_BYTES;
  if (work->options->memory_bytes && bytes > work->options->memory_bytes)
    return conic_fail(work->context, CONIC_ERROR_MEMORY,
                      "surface: a cell of %g h and what is about it hold %llu points or more, which takes %llu MiB",
                      CELL_SIDE, (unsigned long long)n, (unsigned long long)(bytes >> 20) + 1);
  if (n > UINT32_MAX - 1)
    return conic_fail(work->context, CONIC_ERROR_ARGUMENT, "surface: h %g is too large for so many points",
                      work->options->surface.h);
  return CONIC_OK;
}

/* Room for n more points in the subset. */
static conic_status reserve_subset(cleaning *work, size_t n) {
  size_t wanted = work->subset.count + n, room = wanted + wanted / 4;
  if (wanted <= work->subset_room)
    return CONIC_OK;
  conic_status status = check_room(work, wanted);
  if (status == CONIC_OK)
    status = conic_splats_resize(work->context, &work->subset, room, work->fields);
  if (status == CONIC_OK)
    work->subset_room = room;
  return status;
}

static int is_record_within(const record *r, const double low[3], const double high[3]) {
  int is_inside = 1;
  for (int axis = 0; axis < 3; axis++)
    is_inside &= (double)r->point.position[axis] >= low[axis] && (double)r->point.position[axis] <= high[axis];
  return is_inside;
}

/* Gathers the cell's points, then those around it. */
static conic_status gather_cell(cleaning *work, const conic_cell *cell) {
  const conic_surface_options *surface = &work->options->surface;
  double halo = (surface->neglect + HALO) * surface->h, low[3], high[3];
  conic_status status = CONIC_OK;
  for (int axis = 0; axis < 3; axis++) {
    low[axis] = (double)cell->at[axis] * work->cells.side - halo;
    high[axis] = ((double)cell->at[axis] + 1.0) * work->cells.side + halo;
  }
  work->subset.count = 0;
  for (int i = 0; i < CONIC_CELL_NEIGHBOURS && status == CONIC_OK; i++) {
    const conic_cell *from = conic_cells_neighbour(&work->cells, cell, i);
    for (uint64_t at = 0; from && at < from->count && status == CONIC_OK; at += PAGE) {
      size_t n = from->count - at < PAGE ? (size_t)(from->count - at) : PAGE;
      status = conic_store_read(&work->records, from->start + at, n, work->page);
      if (status == CONIC_OK)
        status = reserve_subset(work, n);
      for (size_t k = 0; k < n && status == CONIC_OK; k++)
        if (i == 0 || is_record_within(&work->page[k], low, high))
          put_sample(&work->page[k].point, &work->subset, work->subset.count++);
    }
  }
  return status;
}

/* Adds to a sum whose bits do not depend on the order. */
static void add_move(cleaning *work, double moved2) {
  double h = work->options->surface.h, units = moved2 / (h * h) * 0x1p24;
  units = units < 0x1p40 ? units : 0x1p40;
  uint64_t whole = (uint64_t)units;
  work->sums.moved2[0] += whole;
  work->sums.moved2[1] += (uint64_t)((units - (double)whole) * 0x1p30);
  work->sums.moved2_most = moved2 > work->sums.moved2_most ? moved2 : work->sums.moved2_most;
}

static void fill_result(cleaning *work, const conic_own_points *own, uint32_t slot, conic_cell_result *to) {
  memset(to, 0, sizeof *to);
  to->outcome = own->outcomes[slot];
  work->sums.outcomes[to->outcome]++;
  if (to->outcome != CONIC_SURFACE_DONE)
    return;
  for (int axis = 0; axis < 3; axis++) {
    to->point.position[axis] = own->points.position[axis][slot];
    to->point.normal[axis] = own->points.normal[0] ? own->points.normal[axis][slot] : 0.0f;
    to->point.color[axis] = own->points.color[0] ? own->points.color[axis][slot] : 0.0f;
  }
  work->sums.n_merged += own->are_merged[slot];
  work->sums.neighbours += own->n_neighbours[slot];
  add_move(work, own->moved2[slot]);
}

/* Keeps the results of the process's own points of a cell. */
static conic_status keep_cell(cleaning *work, const conic_cell *cell, const conic_surface *surface,
                              const conic_own_points *own) {
  conic_cell_result run[CONIC_RESULTS_RUN];
  conic_status status = CONIC_OK;
  for (uint64_t at = 0; at < cell->count && status == CONIC_OK; at += PAGE) {
    size_t n = cell->count - at < PAGE ? (size_t)(cell->count - at) : PAGE, n_run = 0;
    status = conic_store_read(&work->records, cell->start + at, n, work->page);
    for (size_t i = 0; i < n && status == CONIC_OK; i++) {
      uint32_t slot = surface->tree.slot_of_point[at + i];
      int is_own = slot >= own->begin && slot < own->end;
      if (n_run > 0 && (!is_own || n_run == CONIC_RESULTS_RUN || work->page[i].index != work->page[i - 1].index + 1)) {
        status = conic_cells_results_keep(&work->results, work->page[i - 1].index + 1 - n_run, n_run, run);
        n_run = 0;
      }
      if (is_own)
        fill_result(work, own, slot, &run[n_run++]);
    }
    if (n_run > 0 && status == CONIC_OK)
      status = conic_cells_results_keep(&work->results, work->page[n - 1].index + 1 - n_run, n_run, run);
  }
  return status;
}

/* Makes the surface of the cell's points and those around it. */
static conic_status create_cell_surface(cleaning *work, conic_surface **surface) {
  conic_estimate_options options;
  conic_model model = {.n_triangles = 0};
  if (!finds_normals(work))
    return conic_surface_create(work->context, &work->subset, &work->options->surface, surface);
  conic_estimate_options_init(&options);
  memcpy(model.points.origin, work->subset.origin, sizeof model.points.origin);
  conic_status status = conic_splats_append(work->context, &model.points, &work->subset);
  if (status == CONIC_OK)
    status = conic_model_to_splats(work->context, &options, &model, NULL);
  if (status == CONIC_OK)
    status = conic_surface_create(work->context, &model.points, &work->options->surface, surface);
  conic_model_release(work->context, &model);
  return status;
}

static conic_status clean_cell(cleaning *work, const conic_cell *cell, const conic_cell_part *part) {
  const conic_own_range wanted = {cell->count, part->first, part->end};
  conic_surface *surface;
  conic_own_points own;
  conic_status status = gather_cell(work, cell);
  if (status == CONIC_OK)
    status = create_cell_surface(work, &surface);
  if (status != CONIC_OK)
    return status;
  status = conic_own_points_project(surface, &wanted, part->from, part->to, &own);
  if (status == CONIC_OK) {
    status = keep_cell(work, cell, surface, &own);
    work->sums.n_evaluations += own.n_evaluations;
    conic_own_points_release(work->context, &own);
  }
  conic_surface_destroy(surface);
  return status;
}

/* --- the whole --- */

/* The most points in a cell. */
static uint64_t most_in(const cleaning *work) {
  uint64_t most = 0;
  for (size_t i = 0; i < work->cells.n; i++)
    most = work->cells.cells[i].count > most ? work->cells.cells[i].count : most;
  return most;
}

/* Once the number of points is known: makes room for one cell, and for storing the others. */
static conic_status reserve_page(cleaning *work) {
  const conic_clean_options *o = work->options;
  const conic_cells_share *share = &work->share;
  uint64_t most = most_in(work), kept_bytes = share->n_kept * sizeof(record) +
                                              conic_cells_results_bytes(work->team, work->n_points, share->n_most);
  conic_status status = check_room(work, most);
  if (status != CONIC_OK)
    return status;
  const char *path = o->memory_bytes && 2 * most * bytes_a_point(work) + OTHER_BYTES + kept_bytes > o->memory_bytes
                         ? o->scratch
                         : NULL;
  status = conic_store_begin(work->context, path, share->n_kept, sizeof(record), &work->records);
  if (status == CONIC_OK)
    status = conic_cells_results_begin(work->context, work->team, path, work->n_points, share->n_most, &work->results);
  work->page = conic_memory_allocate(work->context, BATCH, sizeof *work->page);
  work->keys = conic_memory_allocate(work->context, BATCH, sizeof *work->keys);
  if (status == CONIC_OK && !(work->page && work->keys))
    status = CONIC_ERROR_MEMORY;
  return status;
}

static void sum_up(cleaning *work) {
  conic_surface_report *report = &work->report;
  const cells_sums *sums = &work->sums;
  double h = work->options->surface.h;
  for (int i = 0; i < CONIC_N_SURFACE_OUTCOMES; i++)
    report->outcomes[i] = (size_t)sums->outcomes[i];
  report->n_merged = sums->n_merged;
  report->n_evaluations = (size_t)sums->n_evaluations;
  report->n_in = (size_t)work->n_points;
  report->n_out = report->outcomes[CONIC_SURFACE_DONE];
  report->outcomes[CONIC_SURFACE_NOT_FINITE] += (size_t)(work->n_points - work->n_finite);
  report->h = h;
  if (report->n_out) {
    double moved2 = ((double)sums->moved2[0] + 0x1p-30 * (double)sums->moved2[1]) * 0x1p-24 * (h * h);
    report->moved_rms = sqrt(moved2 / (double)report->n_out);
    report->moved_max = sqrt(sums->moved2_most);
    report->mean_neighbours = (double)sums->neighbours / (double)report->n_out;
  }
}

/* Projects this process's cells, one after the other. */
static conic_status clean_own(cleaning *work) {
  conic_status status = CONIC_OK;
  for (size_t i = 0; i < work->cells.n && status == CONIC_OK; i++) {
    const conic_cell_part *part = &work->share.parts[i];
    conic_moment start = conic_moment_now();
    if (part->first == part->end)
      continue;
    status = clean_cell(work, &work->cells.cells[i], part);
    conic_team_note(work->team, "cell", start, part->end - part->first);
  }
  return status;
}

static conic_status clean_all(cleaning *work, conic_points_source *source, void *source_cookie) {
  conic_status status = conic_cells_begin(work->context, CELL_SIDE * work->options->surface.h, &work->cells);
  if (status == CONIC_OK)
    status = source(source_cookie, count_batch, work);
  if (status == CONIC_OK && work->n_finite == 0)
    status = conic_fail(work->context, CONIC_ERROR_INPUT, "%s: %s", name_of(work),
                        work->n_points ? "no point is finite" : "it holds no points");
  if (status != CONIC_OK)
    return status;
  conic_cells_sort(&work->cells);
  status = conic_cells_share_out(&work->cells, work->team, &work->share);
  if (status == CONIC_OK)
    status = reserve_page(work);
  if (status == CONIC_OK)
    status = source(source_cookie, place_batch, work);
  if (status == CONIC_OK && work->n_placed != work->n_points)
    status = conic_fail(work->context, CONIC_ERROR_INPUT, "%s: the points changed while they were read", name_of(work));
  return status == CONIC_OK ? clean_own(work) : status;
}

/* --- a team's results --- */

static void add_sums(cells_sums *sums, const cells_sums *other) {
  for (int i = 0; i < CONIC_N_SURFACE_OUTCOMES; i++)
    sums->outcomes[i] += other->outcomes[i];
  sums->n_merged += other->n_merged;
  sums->n_evaluations += other->n_evaluations;
  sums->neighbours += other->neighbours;
  sums->moved2[0] += other->moved2[0];
  sums->moved2[1] += other->moved2[1];
  sums->moved2_most = other->moved2_most > sums->moved2_most ? other->moved2_most : sums->moved2_most;
}

/* Collective, after success or failure here: the first process then has all results, and every process the sums. */
static conic_status bring_together(cleaning *work, conic_status status) {
  const conic_team *team = work->team;
  size_t sizes[CONIC_MOST_IN_TEAM];
  status = conic_team_agree(team, status);
  if (status != CONIC_OK || !team)
    return status;
  cells_sums *all = team->collect(team->data, &work->sums, sizeof work->sums, sizes);
  memset(&work->sums, 0, sizeof work->sums);
  for (int i = 0; i < team->count; i++)
    add_sums(&work->sums, &all[i]);
  team->release(team->data, all);
  return conic_team_agree(team, conic_cells_results_bring(&work->results));
}

/* Hands over the DONE points, in the old order. */
static conic_status deliver(cleaning *work, const conic_points_sink *sink) {
  conic_splats batch;
  conic_status status = conic_splats_allocate(work->context, PAGE, work->fields, &batch);
  conic_cell_result *page = conic_memory_allocate(work->context, PAGE, sizeof *page);
  memcpy(batch.origin, work->origin, sizeof batch.origin);
  if (status == CONIC_OK)
    status = page ? sink->begin(sink->cookie, &work->report, work->fields) : CONIC_ERROR_MEMORY;
  for (uint64_t at = 0; at < work->n_points && status == CONIC_OK; at += PAGE) {
    size_t n = work->n_points - at < PAGE ? (size_t)(work->n_points - at) : PAGE, k = 0;
    status = conic_store_read(&work->results.store, at, n, page);
    for (size_t i = 0; i < n && status == CONIC_OK; i++)
      if (page[i].outcome == CONIC_SURFACE_DONE)
        put_sample(&page[i].point, &batch, k++);
    batch.count = k;
    if (status == CONIC_OK && k > 0)
      status = sink->receive(sink->cookie, &batch);
  }
  batch.count = PAGE;
  conic_memory_release(work->context, page);
  conic_splats_release(work->context, &batch);
  return status;
}

void conic_clean_options_init_sized(conic_clean_options *options, size_t size) {
  conic_clean_options own = {.size = sizeof own};
  conic_surface_options_init(&own.surface);
  conic_options_give(options, size, &own);
}

conic_status conic_surface_clean_cells(conic_context *context, const conic_clean_options *given,
                                       conic_points_source *source, void *source_cookie, const conic_points_sink *sink,
                                       conic_surface_report *report) {
  conic_clean_options options;
  cleaning work = {.context = context, .options = &options};
  conic_clean_options_init(&options);
  if (!conic_options_take(&options, given) || !(options.surface.h > 0.0 && options.surface.h < 1e30) ||
      options.surface.cluster != 0.0 || options.surface.is_sharp)
    return conic_fail(context, CONIC_ERROR_ARGUMENT,
                      "surface: cells need an h for all points, and have neither clusters nor creases");
  work.team = conic_context_join(context, NULL);
  conic_status status = bring_together(&work, clean_all(&work, source, source_cookie));
  if (status == CONIC_OK)
    sum_up(&work);
  if (status == CONIC_OK && has_all_results(&work))
    status = deliver(&work, sink);
  if (status == CONIC_OK && report)
    *report = work.report;
  conic_splats_release(context, &work.subset);
  conic_memory_release_these(context, work.page, work.keys);
  conic_store_end(&work.results.store);
  conic_store_end(&work.records);
  conic_cells_share_end(context, &work.share);
  conic_cells_end(&work.cells);
  return status;
}
