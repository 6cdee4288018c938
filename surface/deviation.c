/* How far one surface is from another, measured at its points. */

#include "core/base/team_runs.h"
#include "surface/own_points.h"

enum { CHUNK = 256, CHUNKS_A_REPORT = 64 };

/* Instead of a distance: the point is not on its own surface; or the other surface has nothing there. */
static const double NOWHERE = -1.0, LOST = -2.0;

typedef struct measuring {
  const conic_surface *from, *to;
  const conic_own_points *own;
  double *distances2; /* by slot: squared distance, NOWHERE or LOST */
  conic_workspace *workspaces;
} measuring;

static double distance2_to(const measuring *work, size_t slot, conic_workspace *workspace) {
  conic_landing projection;
  double r[3], sum = 0.0;
  if (work->own->outcomes[slot] != CONIC_SURFACE_DONE)
    return NOWHERE;
  for (int axis = 0; axis < 3; axis++)
    r[axis] = (double)work->own->points.position[axis][slot] +
              (work->from->points.origin[axis] - work->to->points.origin[axis]);
  conic_surface_project_one(work->to, r, conic_surface_scale(work->to, r), CONIC_NO_SLOT, 0, workspace, &projection);
  for (int axis = 0; axis < 3; axis++)
    sum += projection.offset[axis] * projection.offset[axis];
  return projection.outcome == CONIC_SURFACE_DONE ? sum : LOST;
}

static void measure_chunk(void *data, size_t i_item, int i_thread) {
  measuring *work = data;
  for (size_t slot = i_item * CHUNK; slot < (i_item + 1) * CHUNK && slot < work->from->tree.n_slots; slot++)
    work->distances2[slot] = distance2_to(work, slot, &work->workspaces[i_thread]);
}

static conic_status measure_slots(measuring *work) {
  conic_context *context = work->from->context;
  conic_team_loop loop =
      conic_team_loop_of("measure", 0.0, 1.0, work->from->tree.n_slots, CHUNK, CHUNKS_A_REPORT, measure_chunk, work);
  loop.columns[0] = (conic_team_column){work->distances2, sizeof *work->distances2};
  conic_status status = conic_workspaces_create(context, &work->workspaces);
  for (int i = 0; status == CONIC_OK && i < conic_context_threads(context); i++)
    work->workspaces[i].is_trusting = 1;
  if (status == CONIC_OK)
    status = conic_team_runs(context, &loop);
  if (status == CONIC_OK)
    status = conic_workspaces_check(context, work->workspaces);
  conic_workspaces_release(context, work->workspaces);
  return status;
}

static void sum_up(const measuring *work, conic_surface_distance *distance) {
  double sum2 = 0.0, greatest2 = 0.0;
  for (size_t slot = 0; slot < work->from->tree.n_slots; slot++) {
    double distance2 = work->distances2[slot];
    distance->n_failed += distance2 == LOST;
    if (distance2 < 0.0)
      continue;
    distance->n_measured++;
    sum2 += distance2;
    greatest2 = distance2 > greatest2 ? distance2 : greatest2;
  }
  distance->max = sqrt(greatest2);
  distance->rms = distance->n_measured ? sqrt(sum2 / (double)distance->n_measured) : 0.0;
}

conic_status conic_surface_deviation(conic_surface *from, conic_surface *to, conic_surface_distance *distance) {
  conic_context *context = from->context;
  conic_own_points own;
  measuring work = {from, to, &own, NULL, NULL};
  memset(distance, 0, sizeof *distance);
  conic_status status = conic_own_points_project(from, NULL, 0.0, 1.0, &own);
  if (status != CONIC_OK)
    return status;
  work.distances2 = conic_memory_allocate(context, from->tree.n_slots, sizeof *work.distances2);
  status = work.distances2 ? measure_slots(&work) : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK)
    sum_up(&work, distance);
  conic_memory_release(context, work.distances2);
  conic_own_points_release(context, &own);
  return status;
}
