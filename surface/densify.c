/* Densifying (PSS §5.2): adds points of the surface wherever a circle of a certain radius is empty, the widest circles
 * first.
 *
 * Triangles say where there is surface: the set's own, or those that each point makes with its neighbours (Delaunay's).
 * In passes with ever smaller radii, a dart is thrown at every place of the triangles without a point nearby, and the
 * darts are projected. */
#include <math.h>
#include <string.h>

#include "core/base/memory.h"
#include "core/base/message.h"
#include "core/base/options.h"
#include "core/base/vectors.h"
#include "core/splats/builder.h"
#include "core/splats/splats_gather.h"
#include "surface/darts.h"
#include "surface/densify_triangles.h"
#include "surface/landings.h"

enum { TRIANGLES_A_REPORT = 4096 };

/* Darts are thrown at this share of the radius: the lattice may miss places, and projection moves darts. */
static const double RADIUS_SHARE = 0.97;

/* Each pass's radius, as a share of the last. */
static const double PASS_SHARE = 0.7;

void conic_densify_options_init_sized(conic_densify_options *options, size_t size) {
  static const conic_densify_options own = {.size = sizeof own};
  conic_options_give(options, size, &own);
}

typedef struct densifying {
  const conic_surface *surface;
  const conic_densify_options *options;
  conic_splats *points; /* grows */
  size_t limit;
  conic_densify_triangles triangles;
  conic_workspace *workspaces;
  conic_darts darts;
  conic_landing_places landed; /* where the darts landed */
  uint8_t *is_moved;           /* by triangle: a dart of it landed elsewhere, or nowhere */
  size_t n_flat, n_evaluations;
} densifying;

/* --- a pass --- */

static conic_status set_up_board(const densifying *work, double radius, conic_dart_board *board) {
  const conic_splats *points = work->points;
  conic_status status = conic_dart_board_begin(work->surface->context, radius, points->count, board);
  for (size_t i = 0; i < points->count && status == CONIC_OK; i++) {
    const double place[3] = {(double)points->position[0][i], (double)points->position[1][i],
                             (double)points->position[2][i]};
    if (conic_dot(place, place) < HUGE_VAL)
      status = conic_dart_board_add(board, place);
  }
  return status;
}

/* Throws darts at all triangles, or, the second time, at those marked as moved. */
static conic_status throw_darts(densifying *work, conic_dart_board *board, int is_second, double from, double to) {
  const conic_densify_triangles *triangles = &work->triangles;
  conic_status status = CONIC_OK;
  work->darts.n = 0;
  for (size_t i = 0; i < triangles->n && status == CONIC_OK; i++) {
    conic_dart_triangle triangle;
    if (i % TRIANGLES_A_REPORT == 0)
      status = conic_progress(work->surface->context, "densify", from + (to - from) * (double)i / (double)triangles->n);
    if (status != CONIC_OK || !(triangles->reaches[i] > board->radius) || (is_second && !work->is_moved[i]))
      continue;
    conic_densify_triangle(triangles, i, &triangle);
    status = conic_darts_throw(board, &triangle, (uint32_t)i, CONIC_MAX_POINTS - work->points->count, &work->darts);
  }
  return status;
}

static conic_status append_landed(densifying *work, size_t i) {
  const conic_landed *from = &work->landed.list[i];
  conic_splats *points = work->points;
  size_t to = points->count++;
  for (int axis = 0; axis < 3; axis++) {
    points->position[axis][to] = (float)from->place[axis];
    if (points->normal[0])
      points->normal[axis][to] = (float)from->normal[axis];
    if (points->color[0])
      points->color[axis][to] = (float)from->color[axis];
  }
  work->n_flat += from->how == CONIC_LANDED_FLAT;
  return CONIC_OK;
}

/* Appends the landed darts, as far as there is room; if there are too many, an even choice, and *is_full is set. In the
 * second throw of a radius, darts that landed beside a point are left out. */
static conic_status append_darts(densifying *work, double radius, int is_second, int *is_full) {
  conic_context *context = work->surface->context;
  size_t n = work->darts.n, room = work->limit > work->points->count ? work->limit - work->points->count : 0;
  size_t n_kept = n < room ? n : room;
  conic_dart_board board;
  *is_full = n > room;
  conic_status status =
      conic_splats_resize(context, work->points, work->points->count + n_kept, conic_splats_fields(work->points));
  if (status != CONIC_OK || !n)
    return status;
  status = is_second ? set_up_board(work, 0.5 * radius, &board) : CONIC_OK;
  for (size_t i = 0; i < n && status == CONIC_OK; i++) {
    const conic_landed *landed = &work->landed.list[i];
    int is_chosen = (uint64_t)(i + 1) * n_kept / n > (uint64_t)i * n_kept / n;
    if (landed->how != CONIC_LANDED_WELL)
      work->is_moved[work->darts.list[i].triangle] = 1;
    if (landed->how == CONIC_LANDED_NOWHERE || !is_chosen ||
        (is_second && conic_dart_board_covers(&board, landed->place)))
      continue;
    status = append_landed(work, i);
    if (is_second && status == CONIC_OK)
      status = conic_dart_board_add(&board, landed->place);
  }
  if (is_second)
    conic_dart_board_end(&board);
  return status;
}

static conic_status throw_once(densifying *work, double radius, int is_second, double from, double to, int *is_full) {
  conic_dart_board board;
  conic_status status = set_up_board(work, radius, &board);
  if (status == CONIC_OK)
    status = throw_darts(work, &board, is_second, from, 0.5 * (from + to));
  conic_dart_board_end(&board);
  if (status == CONIC_OK)
    status = conic_land_darts(work->surface, &work->triangles, &work->darts, 0.5 * (from + to), to, work->workspaces,
                              &work->landed);
  return status == CONIC_OK ? append_darts(work, radius, is_second, is_full) : status;
}

/* Makes passes from the widest circle down; *left is the greatest radius of a circle that may still be empty. */
static conic_status run_passes(densifying *work, double *left) {
  double least = RADIUS_SHARE * work->options->spacing, radius = least;
  int n_passes = 1, is_full = 0;
  conic_status status = CONIC_OK;
  *left = work->triangles.widest;
  for (; radius < PASS_SHARE * work->triangles.widest; n_passes++)
    radius /= PASS_SHARE;
  for (int i = 0; i < n_passes && status == CONIC_OK && !is_full; i++, radius *= PASS_SHARE) {
    double from = (double)i / (double)(n_passes + 1), to = (double)(i + 1) / (double)(n_passes + 1);
    status = throw_once(work, radius, 0, from, to, &is_full);
    if (!is_full && *left > radius / RADIUS_SHARE)
      *left = radius / RADIUS_SHARE;
  }
  if (status == CONIC_OK && !is_full)
    status = throw_once(work, least, 1, (double)n_passes / (double)(n_passes + 1), 1.0, &is_full);
  return status;
}

/* --- the whole --- */

static conic_status begin_densifying(densifying *work) {
  conic_context *context = work->surface->context;
  const conic_splats *from = &work->surface->points;
  memcpy(work->points->origin, from->origin, sizeof from->origin);
  work->limit = work->options->max_count ? work->options->max_count : (size_t)CONIC_MAX_POINTS;
  conic_status status = conic_splats_append(context, work->points, from);
  if (status == CONIC_OK)
    status = conic_workspaces_create(context, &work->workspaces);
  if (status == CONIC_OK)
    status = conic_densify_triangles_find(work->surface, work->options, work->workspaces, &work->triangles);
  if (status != CONIC_OK)
    return status;
  work->is_moved = conic_memory_allocate_zeroed(context, work->triangles.n, sizeof *work->is_moved);
  return work->is_moved ? CONIC_OK : CONIC_ERROR_MEMORY;
}

static void report_densified(const densifying *work, double left, conic_surface_report *report) {
  memset(report, 0, sizeof *report);
  report->n_in = work->surface->points.count;
  report->n_out = work->points->count;
  report->n_flat = work->n_flat;
  report->h = work->surface->median_h;
  report->error = left;
  report->n_evaluations = work->n_evaluations;
}

static int are_densify_options(const conic_surface *surface, const conic_densify_options *o) {
  if (!(o->spacing > 0.0) || !(o->hole >= 0.0) || (o->n_triangles && !o->triangles))
    return 0;
  for (size_t i = 0; i < o->n_triangles; i++)
    for (int k = 0; k < 3; k++)
      if (o->triangles[i][k] >= surface->points.count)
        return 0;
  return 1;
}

conic_status conic_surface_densify(conic_surface *surface, const conic_densify_options *given, conic_splats *dense,
                                   conic_surface_report *report) {
  conic_context *context = surface->context;
  conic_densify_options own, *options = &own;
  densifying work = {.surface = surface, .options = options, .points = dense};
  double left = 0.0;
  memset(dense, 0, sizeof *dense);
  conic_densify_options_init(options);
  if (!conic_options_take(options, given) || !are_densify_options(surface, options))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "densify: no spacing is given, or triangles without their points");
  conic_status status = begin_densifying(&work);
  if (status == CONIC_OK)
    status = run_passes(&work, &left);
  if (status == CONIC_OK)
    status = conic_workspaces_check(context, work.workspaces);
  if (status == CONIC_OK)
    status = conic_workspaces_count(context, work.workspaces, &work.n_evaluations);
  if (status == CONIC_OK && report)
    report_densified(&work, left, report);
  conic_densify_triangles_release(context, &work.triangles);
  conic_memory_release_these(context, work.is_moved, work.darts.list, work.landed.list);
  conic_workspaces_release(context, work.workspaces);
  if (status != CONIC_OK)
    conic_splats_release(context, dense);
  return status;
}
