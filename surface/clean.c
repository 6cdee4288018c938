/* Projects a surface's own points, leaf by leaf of the tree: a leaf's points share their candidates. */

#include "core/base/team_runs.h"
#include "core/splats/splats_gather.h"
#include "surface/own_points.h"

enum { CHUNK = 16, CHUNKS_A_REPORT = 256 };

typedef struct points_cleaning {
  const conic_surface *surface;
  conic_own_points *own;
  uint64_t n_points;           /* the slots of so many first points are wanted */
  size_t first_leaf, end_leaf; /* the leaves with these slots */
  conic_workspace *workspaces;
} points_cleaning;

/* With two sheets, the polynomial's residuals are in two heaps. Their fourth moment is then little more than the square
 * of the second, where noise has three times that. The heaps must also be apart by a share of h. */
static const double TWO_HEAPS = 1.5, LEAST_GAP = 0.1;

/* Whether the samples of the last projected point lie in two sheets. */
static int is_between_sheets(const conic_surface *surface, const conic_workspace *workspace,
                             const conic_landing *projection) {
  const conic_near *near = &workspace->near;
  double sum = 0.0, second = 0.0, fourth = 0.0;
  if (surface->options.type != CONIC_SURFACE_MLS || surface->creases.side || projection->outcome != CONIC_SURFACE_DONE)
    return 0;
  const double *residuals = near->columns + (size_t)conic_n_coefficients(surface->options.degree) * near->n_padded;
  for (size_t i = 0; i < near->n; i++) {
    double square = residuals[i] * residuals[i]; /* in units of h */
    sum += near->weights[i];
    second += near->weights[i] * square;
    fourth += near->weights[i] * square * square;
  }
  return 4.0 * second > LEAST_GAP * LEAST_GAP * sum && fourth * sum < TWO_HEAPS * second * second;
}

static void keep_projection(points_cleaning *work, size_t slot, const double r[3], const conic_landing *projection,
                            const conic_workspace *workspace) {
  const conic_surface *surface = work->surface;
  conic_own_points *own = work->own;
  double side[3], color[3], turn = 0.0, moved2 = 0.0;
  own->outcomes[slot] = (uint8_t)projection->outcome;
  own->are_merged[slot] = (uint8_t)is_between_sheets(surface, workspace, projection);
  own->n_neighbours[slot] = (uint32_t)projection->n_neighbours;
  conic_surface_attributes(surface, workspace, side, color);
  for (int axis = 0; axis < 3; axis++)
    turn += side[axis] * projection->normal[axis];
  for (int axis = 0; axis < 3; axis++) {
    own->points.position[axis][slot] = (float)(r[axis] + projection->offset[axis]);
    moved2 += projection->offset[axis] * projection->offset[axis];
    if (own->points.normal[0])
      own->points.normal[axis][slot] = (float)(turn < 0.0 ? -projection->normal[axis] : projection->normal[axis]);
    if (own->points.color[0])
      own->points.color[axis][slot] = (float)color[axis];
  }
  own->moved2[slot] = moved2;
}

static void clean_leaf(points_cleaning *work, size_t i_leaf, conic_workspace *workspace) {
  const conic_surface *surface = work->surface;
  const conic_neighbours *tree = &surface->tree;
  size_t begin = conic_neighbours_leaf_begin(tree, i_leaf), end = conic_neighbours_leaf_begin(tree, i_leaf + 1);
  conic_surface_share_leaf(surface, i_leaf, workspace);
  for (size_t slot = begin; slot < end; slot++) {
    if (tree->point_of_slot[slot] >= work->n_points)
      continue;
    conic_landing projection;
    const double r[3] = {(double)tree->position[0][slot], (double)tree->position[1][slot],
                         (double)tree->position[2][slot]};
    conic_surface_project_one(surface, r, (double)surface->h[slot], CONIC_NO_SLOT, 1, workspace, &projection);
    keep_projection(work, slot, r, &projection, workspace);
  }
}

static void clean_chunk(void *data, size_t i_item, int i_thread) {
  points_cleaning *work = data;
  size_t first = work->first_leaf + i_item * CHUNK;
  for (size_t i = first; i < first + CHUNK && i < work->end_leaf; i++)
    clean_leaf(work, i, &work->workspaces[i_thread]);
}

/* The first slot of the leaves of a chunk. */
static size_t first_slot(const void *data, size_t i_item) {
  const points_cleaning *work = data;
  size_t leaf = work->first_leaf + i_item * CHUNK;
  return conic_neighbours_leaf_begin(&work->surface->tree, leaf < work->end_leaf ? leaf : work->end_leaf);
}

static conic_status clean_leaves(points_cleaning *work, double begin, double end) {
  size_t n_leaves = work->end_leaf - work->first_leaf;
  conic_own_points *own = work->own;
  conic_team_loop loop = {.name = "project", .from = begin, .to = end, .n_a_run = CHUNKS_A_REPORT};
  loop.n_items = (n_leaves + CHUNK - 1) / CHUNK;
  loop.task = CONIC_TASK(clean_chunk);
  loop.data = work;
  loop.first_of = first_slot;
  int n = 0;
  loop.columns[n++] = (conic_team_column){own->moved2, sizeof *own->moved2};
  loop.columns[n++] = (conic_team_column){own->n_neighbours, sizeof *own->n_neighbours};
  loop.columns[n++] = (conic_team_column){own->outcomes, sizeof *own->outcomes};
  loop.columns[n++] = (conic_team_column){own->are_merged, sizeof *own->are_merged};
  for (int axis = 0; axis < 3; axis++) {
    loop.columns[n++] = (conic_team_column){own->points.position[axis], sizeof(float)};
    loop.columns[n++] = (conic_team_column){own->points.normal[axis], sizeof(float)};
    loop.columns[n++] = (conic_team_column){own->points.color[axis], sizeof(float)};
  }
  return conic_team_runs(work->surface->context, &loop);
}

/* Finds the leaves of the wanted slots. */
static void find_own_leaves(points_cleaning *work, const conic_own_range *wanted) {
  const conic_neighbours *tree = &work->surface->tree;
  uint64_t n = 0;
  size_t leaf = 0;
  work->n_points = wanted ? wanted->n_points : UINT64_MAX;
  work->first_leaf = wanted ? tree->n_leaves : 0;
  for (; leaf < tree->n_leaves && wanted && n < wanted->end; leaf++) {
    if (n >= wanted->first && leaf < work->first_leaf)
      work->first_leaf = leaf;
    for (size_t slot = conic_neighbours_leaf_begin(tree, leaf); slot < conic_neighbours_leaf_begin(tree, leaf + 1);
         slot++)
      n += tree->point_of_slot[slot] < wanted->n_points;
  }
  work->end_leaf = wanted ? leaf : tree->n_leaves;
  work->first_leaf = work->first_leaf < work->end_leaf ? work->first_leaf : work->end_leaf;
}

static conic_status allocate_own(const conic_surface *surface, conic_own_points *own) {
  conic_context *context = surface->context;
  size_t n = surface->tree.n_slots;
  conic_status status = conic_splats_allocate(context, n, conic_splats_fields(&surface->points), &own->points);
  memcpy(own->points.origin, surface->points.origin, sizeof own->points.origin);
  own->moved2 = conic_memory_allocate(context, n, sizeof *own->moved2);
  own->n_neighbours = conic_memory_allocate(context, n, sizeof *own->n_neighbours);
  own->outcomes = conic_memory_allocate(context, n, sizeof *own->outcomes);
  own->are_merged = conic_memory_allocate(context, n, sizeof *own->are_merged);
  return own->moved2 && own->n_neighbours && own->outcomes && own->are_merged ? status : CONIC_ERROR_MEMORY;
}

conic_status conic_own_points_project(const conic_surface *surface, const conic_own_range *wanted, double from,
                                      double to, conic_own_points *own) {
  conic_context *context = surface->context;
  points_cleaning work = {.surface = surface, .own = own};
  memset(own, 0, sizeof *own);
  find_own_leaves(&work, wanted);
  own->begin = conic_neighbours_leaf_begin(&surface->tree, work.first_leaf);
  own->end = conic_neighbours_leaf_begin(&surface->tree, work.end_leaf);
  conic_status status = conic_workspaces_create(context, &work.workspaces);
  if (status == CONIC_OK)
    status = allocate_own(surface, own);
  if (status == CONIC_OK)
    status = clean_leaves(&work, from, to);
  if (status == CONIC_OK)
    status = conic_workspaces_check(context, work.workspaces);
  if (status == CONIC_OK)
    status = conic_workspaces_count(context, work.workspaces, &own->n_evaluations);
  conic_workspaces_release(context, work.workspaces);
  if (status != CONIC_OK)
    conic_own_points_release(context, own);
  return status;
}

void conic_own_points_release(conic_context *context, conic_own_points *own) {
  conic_splats_release(context, &own->points);
  conic_memory_release_these(context, own->moved2, own->n_neighbours, own->outcomes, own->are_merged);
  memset(own, 0, sizeof *own);
}

/* Counts every point, so that duplicates count each time. */
static void report_points(const conic_surface *surface, const conic_own_points *own, conic_surface_report *report) {
  const conic_neighbours *tree = &surface->tree;
  double sum2 = 0.0, greatest2 = 0.0, neighbours = 0.0;
  memset(report, 0, sizeof *report);
  report->n_in = tree->n_points;
  report->h = surface->median_h;
  report->n_evaluations = own->n_evaluations;
  for (size_t i = 0; i < tree->n_points; i++) {
    uint32_t slot = tree->slot_of_point[i];
    unsigned outcome = slot == CONIC_NO_SLOT ? CONIC_SURFACE_NOT_FINITE : own->outcomes[slot];
    report->outcomes[outcome]++;
    if (outcome != CONIC_SURFACE_DONE)
      continue;
    sum2 += own->moved2[slot];
    greatest2 = own->moved2[slot] > greatest2 ? own->moved2[slot] : greatest2;
    neighbours += (double)own->n_neighbours[slot];
    report->n_merged += own->are_merged[slot];
  }
  report->n_out = report->outcomes[CONIC_SURFACE_DONE];
  if (report->n_out) {
    report->moved_rms = sqrt(sum2 / (double)report->n_out);
    report->moved_max = sqrt(greatest2);
    report->mean_neighbours = neighbours / (double)report->n_out;
  }
}

static conic_status write_points(const conic_surface *surface, const conic_own_points *own, size_t n_out,
                                 conic_splats *projected) {
  const conic_neighbours *tree = &surface->tree;
  uint32_t *slots = conic_memory_allocate(surface->context, n_out, sizeof *slots);
  if (!slots)
    return CONIC_ERROR_MEMORY;
  size_t n = 0;
  for (size_t i = 0; i < tree->n_points; i++) {
    uint32_t slot = tree->slot_of_point[i];
    if (slot != CONIC_NO_SLOT && own->outcomes[slot] == CONIC_SURFACE_DONE)
      slots[n++] = slot;
  }
  conic_status status = conic_splats_gather(surface->context, &own->points, slots, n_out, projected);
  conic_memory_release(surface->context, slots);
  return status;
}

conic_status conic_surface_clean(conic_surface *surface, conic_splats *projected, conic_surface_report *report) {
  conic_own_points own;
  conic_surface_report counted;
  memset(projected, 0, sizeof *projected);
  conic_status status = conic_own_points_project(surface, NULL, 0.0, 1.0, &own);
  if (status != CONIC_OK)
    return status;
  report_points(surface, &own, &counted);
  status = write_points(surface, &own, counted.n_out, projected);
  conic_own_points_release(surface->context, &own);
  if (status == CONIC_OK && report)
    *report = counted;
  return status;
}
