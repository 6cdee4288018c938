/* Densifying (PSS §5.2): points of the surface at the vertices of the points' Voronoi diagram, the widest gap first.
 *
 * Rounds: the cell of every point about which something changed is cut out anew in its tangent plane; then the widest
 * gaps, down to a share of the widest, are filled one after the other. What lies near a new point waits for the next
 * round, when the tree knows of it. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/memory.h"
#include "core/base/message.h"
#include "core/base/options.h"
#include "core/base/threads.h"
#include "core/splats/builder.h"
#include "core/splats/splats_gather.h"
#include "surface/gap.h"
#include "surface/mls_surface.h"

enum { CHUNK = 64, MAX_TOUCHED = 256 };

/* A round fills gaps down to this share of the widest. */
static const double ROUND_SHARE = 0.7;

/* A new point must stay as far from the old ones, as a share of the gap that it fills. */
static const double LEAST_CLEARANCE = 0.5;

void conic_densify_options_init_sized(conic_densify_options *options, size_t size) {
  static const conic_densify_options own = {.size = sizeof own};
  conic_options_give(options, size, &own);
}

/* A point with its tangent plane, and the widest gap in its cell. */
typedef struct site {
  double normal[3];
  double h;
  conic_gap gap;   /* radius 0: none */
  uint8_t is_live; /* has a plane: others don't grow */
  uint8_t is_dirty;
} site;

typedef struct densifying {
  conic_surface *surface;
  const conic_densify_options *options;
  conic_splats *points; /* grows */
  site *sites;          /* by point */
  size_t capacity, n_old;
  conic_neighbours tree; /* of all points, anew for each round */
  conic_workspace *workspaces;
  double widest_left;
} densifying;

static void position_of(const densifying *work, size_t i, double position[3]) {
  for (int axis = 0; axis < 3; axis++)
    position[axis] = (double)work->points->position[axis][i];
}

/* --- planes of the old points --- */

static void find_plane_of(densifying *work, size_t i, conic_workspace *workspace) {
  const conic_surface *surface = work->surface;
  site *own = &work->sites[i];
  conic_landing projection;
  double r[3];
  memset(own, 0, sizeof *own);
  position_of(work, i, r);
  uint32_t slot = surface->tree.slot_of_point[i];
  if (slot == CONIC_NO_SLOT || surface->tree.point_of_slot[slot] != i)
    return; /* nowhere, or a duplicate, for which the first stands */
  own->h = (double)surface->h[slot];
  conic_surface_project_one(surface, r, own->h, CONIC_NO_SLOT, 0, workspace, &projection);
  own->is_live = own->is_dirty = projection.outcome == CONIC_SURFACE_DONE;
  memcpy(own->normal, projection.normal, sizeof own->normal);
}

static void find_planes(void *data, size_t i_item, int i_thread) {
  densifying *work = data;
  for (size_t i = i_item * CHUNK; i < (i_item + 1) * CHUNK && i < work->n_old; i++)
    find_plane_of(work, i, &work->workspaces[i_thread]);
}

/* --- the gaps of a round --- */

static void find_gap_of(densifying *work, size_t i) {
  site *own = &work->sites[i];
  double hole = work->options->hole > 0.0 ? work->options->hole : own->h, center[3];
  uint32_t slot = work->tree.slot_of_point[i];
  own->is_dirty = 0;
  own->gap.radius = 0.0;
  if (slot == CONIC_NO_SLOT)
    return;
  position_of(work, i, center);
  conic_gap_find(&work->tree, slot, center, own->normal, work->options->spacing, hole, &own->gap);
}

static void find_gaps(void *data, size_t i_item, int i_thread) {
  densifying *work = data;
  (void)i_thread;
  for (size_t i = i_item * CHUNK; i < (i_item + 1) * CHUNK && i < work->points->count; i++)
    if (work->sites[i].is_live && work->sites[i].is_dirty)
      find_gap_of(work, i);
}

/* --- filling --- */

static conic_status reserve_points(densifying *work) {
  conic_context *context = work->surface->context;
  size_t n = work->points->count, capacity = n + n / 2 + 1024;
  if (n < work->capacity)
    return CONIC_OK;
  conic_status status = conic_splats_resize(context, work->points, capacity, conic_splats_fields(work->points));
  if (status == CONIC_OK)
    status = conic_memory_grow(context, &work->sites, n, capacity, sizeof *work->sites);
  if (status == CONIC_OK)
    work->capacity = capacity;
  return status;
}

/* The slots whose gaps a new point may lie in are looked at anew in the next round. */
static void touch(densifying *work, const double place[3], double radius) {
  uint32_t slots[MAX_TOUCHED];
  double distances2[MAX_TOUCHED];
  size_t n =
      conic_neighbours_nearest(&work->tree, place, CONIC_NO_SLOT, MAX_TOUCHED, radius * radius, slots, distances2);
  for (size_t i = 0; i < n; i++)
    work->sites[work->tree.point_of_slot[slots[i]]].is_dirty = 1;
}

static void append_point(densifying *work, const double place[3], const conic_landing *projection) {
  conic_splats *points = work->points;
  size_t i = points->count++;
  double side[3], color[3], turn = 0.0;
  conic_surface_attributes(work->surface, &work->workspaces[0], side, color);
  for (int axis = 0; axis < 3; axis++)
    turn += side[axis] * projection->normal[axis];
  for (int axis = 0; axis < 3; axis++) {
    points->position[axis][i] = (float)place[axis];
    if (points->normal[0])
      points->normal[axis][i] = (float)(turn < 0.0 ? -projection->normal[axis] : projection->normal[axis]);
    if (points->color[0])
      points->color[axis][i] = (float)color[axis];
  }
  memset(&work->sites[i], 0, sizeof work->sites[i]);
  memcpy(work->sites[i].normal, projection->normal, sizeof projection->normal);
  work->sites[i].h = projection->h;
  work->sites[i].is_live = work->sites[i].is_dirty = 1;
}

/* Puts a point of the surface into the gap; a gap where there is none stays, and is not tried again until something
 * changes about it. Errors: MEMORY. */
static conic_status fill_round(densifying *work, size_t i) {
  conic_gap gap = work->sites[i].gap;
  conic_landing projection;
  double place[3], distance2;
  uint32_t slot;
  work->sites[i].gap.radius = 0.0;
  conic_surface_project_one(work->surface, gap.center, conic_surface_scale(work->surface, gap.center), CONIC_NO_SLOT, 0,
                            &work->workspaces[0], &projection);
  if (projection.outcome != CONIC_SURFACE_DONE)
    return CONIC_OK;
  for (int axis = 0; axis < 3; axis++)
    place[axis] = gap.center[axis] + projection.offset[axis];
  conic_neighbours_nearest(&work->tree, place, CONIC_NO_SLOT, 1, HUGE_VAL, &slot, &distance2);
  if (!(distance2 >= LEAST_CLEARANCE * LEAST_CLEARANCE * gap.radius * gap.radius))
    return CONIC_OK;
  conic_status status = reserve_points(work);
  if (status != CONIC_OK)
    return status;
  append_point(work, place, &projection);
  touch(work, place, 2.0 * gap.radius);
  return CONIC_OK;
}

typedef struct densify_candidate {
  double radius;
  size_t point;
} densify_candidate;

static int compare_candidates(const void *a, const void *b) {
  const densify_candidate *first = a, *second = b;
  if (first->radius != second->radius)
    return first->radius < second->radius ? 1 : -1;
  return (first->point > second->point) - (first->point < second->point);
}

/* The gaps of this round, the widest first. */
static conic_status list_candidates(densifying *work, densify_candidate **list, size_t *n) {
  double widest = 0.0;
  *n = 0;
  for (size_t i = 0; i < work->points->count; i++)
    widest = work->sites[i].gap.radius > widest ? work->sites[i].gap.radius : widest;
  work->widest_left = widest;
  *list = conic_memory_allocate(work->surface->context, work->points->count, sizeof **list);
  if (!*list)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < work->points->count && widest > 0.0; i++)
    if (work->sites[i].gap.radius >= ROUND_SHARE * widest) {
      (*list)[*n].radius = work->sites[i].gap.radius;
      (*list)[(*n)++].point = i;
    }
  qsort(*list, *n, sizeof **list, compare_candidates);
  return CONIC_OK;
}

static conic_status fill_gaps(densifying *work, size_t *n_tried) {
  densify_candidate *list;
  size_t n, limit = work->options->max_count ? work->options->max_count : (size_t)CONIC_MAX_POINTS;
  conic_status status = list_candidates(work, &list, &n);
  *n_tried = n;
  for (size_t i = 0; i < n && status == CONIC_OK; i++) {
    if (work->points->count >= limit) {
      *n_tried = 0;
      break;
    }
    if (!work->sites[list[i].point].is_dirty)
      status = fill_round(work, list[i].point);
  }
  conic_memory_release(work->surface->context, list);
  return status;
}

static conic_status run_round(densifying *work, size_t *n_tried) {
  conic_context *context = work->surface->context;
  conic_status status =
      conic_neighbours_build(context, (const float *const *)work->points->position, work->points->count, &work->tree);
  if (status != CONIC_OK)
    return status;
  conic_parallel_for(context, (work->points->count + CHUNK - 1) / CHUNK, find_gaps, work);
  status = fill_gaps(work, n_tried);
  if (status == CONIC_OK)
    status = conic_workspaces_check(context, work->workspaces);
  conic_neighbours_release(context, &work->tree);
  return status;
}

/* --- the whole --- */

static conic_status begin_densifying(densifying *work) {
  conic_context *context = work->surface->context;
  const conic_splats *from = &work->surface->points;
  memcpy(work->points->origin, from->origin, sizeof from->origin);
  conic_status status = conic_splats_append(context, work->points, from);
  if (status != CONIC_OK)
    return status;
  work->n_old = work->capacity = from->count;
  work->sites = conic_memory_allocate(context, from->count, sizeof *work->sites);
  if (!work->sites)
    return CONIC_ERROR_MEMORY;
  conic_parallel_for(context, (work->n_old + CHUNK - 1) / CHUNK, find_planes, work);
  return conic_workspaces_check(context, work->workspaces);
}

conic_status conic_surface_densify(conic_surface *surface, const conic_densify_options *given, conic_splats *dense,
                                   conic_surface_report *report) {
  conic_context *context = surface->context;
  conic_densify_options own, *options = &own;
  densifying work = {.surface = surface, .options = options, .points = dense};
  memset(dense, 0, sizeof *dense);
  conic_densify_options_init(options);
  if (!conic_options_take(options, given) || !(options->spacing > 0.0) || !(options->hole >= 0.0))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "densify: no spacing is given");
  conic_status status = conic_workspaces_create(context, &work.workspaces);
  if (status == CONIC_OK)
    status = begin_densifying(&work);
  for (size_t n_tried = 1; status == CONIC_OK && n_tried;) {
    status = run_round(&work, &n_tried);
    double share = work.widest_left > 0.0 ? options->spacing / work.widest_left : 1.0;
    if (status == CONIC_OK)
      status = conic_progress(context, "densify", share < 1.0 ? share : 1.0);
  }
  if (status == CONIC_OK && report) {
    memset(report, 0, sizeof *report);
    report->n_in = work.n_old;
    report->n_out = dense->count;
    report->h = surface->median_h;
    report->error = work.widest_left;
    for (int i = 0; i < conic_context_threads(context); i++)
      report->n_evaluations += work.workspaces[i].n_evaluations;
  }
  conic_memory_release(context, work.sites);
  conic_workspaces_release(context, work.workspaces);
  if (status != CONIC_OK)
    conic_splats_release(context, dense);
  return status;
}
