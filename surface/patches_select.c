/* What a picture takes of a set's patches: whom it sees, on how fine a grid, and the samples themselves. */
#include <math.h>
#include <string.h>

#include "core/memory.h"
#include "core/message.h"
#include "core/threads.h"
#include "surface/patches.h"
#include "surface/patches_view.h"

/* What becomes of a slot; from PLAN_GRID on, which grid. */
enum { PLAN_CULLED = 0, PLAN_SPLAT = 1, PLAN_DEEP = 2, PLAN_GRID = 3 };

/* The pyramid: each grid is at most 1.5 times as fine as the one before. */
static const int grid_sizes[] = {3, 4, 6, 8, 12, 16, 24, 32, 48, 64};
enum { N_GRIDS = sizeof grid_sizes / sizeof grid_sizes[0] };

/* A patch of fewer pixels than this about its middle is its point's splat. */
static const double LEAST_RADIUS_PX = 4.0;

/* No grid need be so fine that its samples are nearer to the surface, or to its slope, than this. */
static const double OFF_PX = 0.25, OFF_SLOPE = 0.01, LEAST_ROWS = 6.0;

/* A patch past the finest grid is cut into cells of so many rows, each as deep as it needs. */
enum { CELL_ROWS = 16, DEEPEST_CELL = 22 };

enum { N_SUBTREES_LOG2 = 6, CHUNK = 256, CHUNK_SLOTS = 4096 };

typedef struct selecting {
  conic_patches *patches;
  conic_patches_view view;
  conic_patch_selection *selection;
  size_t grid_counts[N_GRIDS];
  size_t *chunk_starts; /* where each chunk of points begins in the selection; one more than there are chunks */
  size_t n_chunks;
  size_t first_subtree, n_subtrees;
} selecting;

/* How many rows a patch needs, seen from no nearer than a sphere about p: so many that samples are a step apart on the
 * screen, or so many that they are as good as nearer ones. */
static double rows_of(const conic_patches_view *view, const conic_patch *patch, const double p[3], double around) {
  double across_px = 2.0 * conic_patches_pixels(view, p, around, (double)patch->radius);
  double bend_px = conic_patches_pixels(view, p, around, (double)patch->bend);
  double flat2 =
      4.0 * CONIC_SAMPLE_OUTLINE * CONIC_SAMPLE_OUTLINE * bend_px / OFF_PX; /* a disc's rim off the surface */
  double even2 = 4.0 * CONIC_SAMPLE_BLUR * CONIC_SAMPLE_BLUR * (double)patch->twist / OFF_SLOPE;
  double enough2 = flat2 > even2 ? flat2 : even2, enough = sqrt(enough2);
  enough = enough > LEAST_ROWS ? enough : LEAST_ROWS;
  double fine = across_px / view->step_px;
  return fine < enough ? fine : enough;
}

/* --- patches past the finest grid, cell by cell --- */

typedef struct descent {
  const conic_patches_view *view;
  const conic_patch *patch;
  int degree;
  double cutoff;
  const conic_grid_samples *to; /* null: samples are only counted */
  size_t n;
} descent;

/* The place (s, t) of a patch, in camera space. */
static void place_of(const descent *d, double s, double t, double p[3]) {
  double height = 0.0, s_power = 1.0, place[3];
  for (int i = 0; i <= d->degree; i++, s_power *= s) {
    double row = 0.0;
    for (int j = d->degree - i; j >= 0; j--)
      row = row * t + (double)d->patch->coefficients[(i + j) * (i + j + 1) / 2 + j];
    height += row * s_power;
  }
  for (int axis = 0; axis < 3; axis++)
    place[axis] = (double)d->patch->center[axis] + s * (double)d->patch->along[axis] +
                  t * (double)d->patch->across[axis] + height * (double)d->patch->normal[axis];
  conic_patches_to_camera(d->view, place, p);
}

static void emit_cell(descent *d, const conic_grid_part *part) {
  if (d->to) {
    conic_grid_samples to = *d->to;
    for (int axis = 0; axis < 3; axis++) {
      to.position[axis] += d->n;
      to.tangent_u[axis] += d->n;
      to.tangent_v[axis] += d->n;
    }
    to.weight += d->n;
    conic_grid_sample(d->patch, d->degree, d->cutoff, part, &to);
  }
  d->n += conic_grid_count(part);
}

/* The cell in `row` and `column` of the 2^depth × 2^depth that the patch is cut into. */
static void descend(descent *d, int depth, int64_t row, int64_t column) {
  double half = 1.0 / (double)(INT64_C(1) << depth), p[3];
  double s = (double)(2 * column + 1) * half - 1.0, t = (double)(2 * row + 1) * half - 1.0;
  double to_s = fabs(s) > half ? fabs(s) - half : 0.0, to_t = fabs(t) > half ? fabs(t) - half : 0.0;
  if (to_s * to_s + to_t * to_t > 1.0)
    return;
  double slope = (double)d->patch->slope, stretch = (double)d->patch->radius * sqrt(1.0 + slope * slope);
  double step = 2.0 * half / CELL_ROWS;
  double around = 1.001 * stretch * (1.4143 * half + CONIC_SAMPLE_OUTLINE * step);
  place_of(d, s, t, p);
  if (!conic_patches_sees(d->view, p, around))
    return;
  if (depth == DEEPEST_CELL || rows_of(d->view, d->patch, p, around) * half <= CELL_ROWS) {
    conic_grid_part part = {CELL_ROWS * (INT64_C(1) << depth), CELL_ROWS * row, CELL_ROWS * column, CELL_ROWS,
                            CELL_ROWS};
    emit_cell(d, &part);
    return;
  }
  for (int child = 0; child < 4; child++)
    descend(d, depth + 1, 2 * row + child / 2, 2 * column + child % 2);
}

static size_t sample_deep(const selecting *work, uint32_t slot, const conic_grid_samples *to) {
  const conic_patches *patches = work->patches;
  descent d = {
      &work->view, &patches->patches[slot], patches->options.surface.degree, (double)patches->options.cutoff, to, 0};
  descend(&d, 0, 0, 0);
  return d.n;
}

/* --- who is drawn, and how: down the tree --- */

/* Whether all of a patch turns its back to the eye. */
static int faces_away(const conic_patches_view *view, const conic_patch *patch, double around) {
  double center[3], p[3], normal[3], n[3], across2 = 0.0, along = 0.0, slope = (double)patch->slope;
  for (int axis = 0; axis < 3; axis++) {
    center[axis] = (double)patch->center[axis];
    normal[axis] = (double)patch->normal[axis];
  }
  conic_patches_to_camera(view, center, p);
  for (int i = 0; i < 3; i++) {
    n[i] = view->rotation[i][0] * normal[0] + view->rotation[i][1] * normal[1] + view->rotation[i][2] * normal[2];
    along += n[i] * p[i];
    across2 += p[i] * p[i];
  }
  across2 -= along * along;
  return along > 1.001 * (slope * sqrt(across2 > 0.0 ? across2 : 0.0) + around * (1.0 + slope));
}

static uint8_t plan_slot(const selecting *work, size_t slot) {
  const conic_patches *patches = work->patches;
  const conic_patch *patch = &patches->patches[slot];
  const double place[3] = {(double)patches->surface->tree.position[0][slot],
                           (double)patches->surface->tree.position[1][slot],
                           (double)patches->surface->tree.position[2][slot]};
  double p[3], reach = (double)patch->reach;
  conic_patches_to_camera(&work->view, place, p);
  if (!conic_patches_sees(&work->view, p, reach))
    return PLAN_CULLED;
  double radius_px = conic_patches_pixels(&work->view, p, reach, (double)patch->radius);
  if (!(radius_px > LEAST_RADIUS_PX))
    return PLAN_SPLAT;
  if (work->view.cull_back && faces_away(&work->view, patch, reach))
    return PLAN_CULLED;
  double rows = rows_of(&work->view, patch, p, reach);
  for (int i = 0; i < N_GRIDS; i++)
    if (rows <= (double)grid_sizes[i])
      return (uint8_t)(PLAN_GRID + i);
  return PLAN_DEEP;
}

static size_t count_of(const selecting *work, uint32_t slot) {
  uint8_t plan = work->patches->plans[slot];
  return plan >= PLAN_GRID   ? work->grid_counts[plan - PLAN_GRID]
         : plan == PLAN_DEEP ? work->patches->counts[slot]
                             : plan;
}

/* The leaves below a node. */
static void leaves_of(const conic_neighbours *tree, size_t i_node, size_t *begin, size_t *end) {
  size_t first = i_node, last = i_node;
  while (first < tree->n_leaves - 1) {
    first = 2 * first + 1;
    last = 2 * last + 2;
  }
  *begin = first - (tree->n_leaves - 1);
  *end = last - (tree->n_leaves - 1) + 1;
}

static void plan_all(selecting *work, size_t i_node, int is_splat) {
  const conic_neighbours *tree = &work->patches->surface->tree;
  size_t begin, end;
  leaves_of(tree, i_node, &begin, &end);
  size_t first = conic_neighbours_leaf_begin(tree, begin), last = conic_neighbours_leaf_begin(tree, end);
  for (size_t slot = first; slot < last; slot++) {
    uint8_t plan = is_splat ? PLAN_SPLAT : plan_slot(work, slot);
    work->patches->plans[slot] = plan;
    if (plan == PLAN_DEEP)
      work->patches->counts[slot] = (uint32_t)sample_deep(work, (uint32_t)slot, NULL);
  }
}

static void plan_node(selecting *work, size_t i_node) {
  const conic_patches *patches = work->patches;
  const conic_neighbours *tree = &patches->surface->tree;
  const float *box = tree->boxes[i_node];
  double center[3], p[3], half2 = 0.0;
  for (int axis = 0; axis < 3; axis++) {
    double half = 0.5 * ((double)box[3 + axis] - (double)box[axis]);
    center[axis] = 0.5 * ((double)box[axis] + (double)box[3 + axis]);
    half2 += half * half;
  }
  double around = 1.001 * sqrt(half2) + (double)patches->node_reach[i_node];
  conic_patches_to_camera(&work->view, center, p);
  if (!conic_patches_sees(&work->view, p, around))
    return; /* culled, as it was set */
  if (conic_patches_pixels(&work->view, p, around, (double)patches->node_radius[i_node]) <= LEAST_RADIUS_PX)
    plan_all(work, i_node, 1);
  else if (i_node >= tree->n_leaves - 1)
    plan_all(work, i_node, 0);
  else {
    plan_node(work, 2 * i_node + 1);
    plan_node(work, 2 * i_node + 2);
  }
}

static void plan_subtree(void *data, size_t i_item, int i_thread) {
  selecting *work = data;
  (void)i_thread;
  plan_node(work, work->first_subtree + i_item);
}

/* --- what is drawn, in the order of the points --- */

static void count_chunk(void *data, size_t i_item, int i_thread) {
  selecting *work = data;
  const conic_neighbours *tree = &work->patches->surface->tree;
  size_t end = (i_item + 1) * CHUNK < tree->n_points ? (i_item + 1) * CHUNK : tree->n_points, n = 0;
  (void)i_thread;
  for (size_t i = i_item * CHUNK; i < end; i++)
    n += tree->slot_of_point[i] == CONIC_NO_SLOT ? 1 : count_of(work, tree->slot_of_point[i]);
  work->chunk_starts[i_item + 1] = n;
}

static void copy_axes(float *const from[3], size_t i, float *const to[3], size_t at) {
  for (int axis = 0; axis < 3; axis++)
    to[axis][at] = from[axis][i];
}

/* The point's own splat; one that is not finite, too, so that the renderer counts it. */
static void put_splat(const selecting *work, size_t point, size_t at) {
  const conic_splats *from = work->patches->splats;
  conic_splats *to = &work->selection->splats;
  copy_axes(from->position, point, to->position, at);
  copy_axes(from->tangent_u, point, to->tangent_u, at);
  copy_axes(from->tangent_v, point, to->tangent_v, at);
  to->opacity[at] = from->opacity ? from->opacity[point] : 1.0f;
}

static void put_grid(const selecting *work, uint32_t slot, size_t at) {
  const conic_patches *patches = work->patches;
  conic_splats *splats = &work->selection->splats;
  uint8_t plan = patches->plans[slot];
  conic_grid_samples to = {.weight = splats->opacity + at};
  for (int axis = 0; axis < 3; axis++) {
    to.position[axis] = splats->position[axis] + at;
    to.tangent_u[axis] = splats->tangent_u[axis] + at;
    to.tangent_v[axis] = splats->tangent_v[axis] + at;
  }
  if (plan == PLAN_DEEP) {
    sample_deep(work, slot, &to);
    return;
  }
  conic_grid_part part = conic_grid_whole(grid_sizes[plan - PLAN_GRID]);
  conic_grid_sample(&patches->patches[slot], patches->options.surface.degree, (double)patches->options.cutoff, &part,
                    &to);
}

/* What all samples of a point share. */
static void put_point(const selecting *work, size_t point, size_t at, size_t n, int is_grid) {
  const conic_splats *from = work->patches->splats;
  conic_patch_selection *selection = work->selection;
  for (size_t i = at; i < at + n; i++)
    selection->points[i] = (uint32_t)point;
  for (int axis = 0; axis < 3 && from->color[0]; axis++)
    for (size_t i = at; i < at + n; i++)
      selection->splats.color[axis][i] = from->color[axis][point];
  for (size_t i = at; i < at + n && is_grid && from->opacity; i++)
    selection->splats.opacity[i] *= from->opacity[point];
}

static void fill_chunk(void *data, size_t i_item, int i_thread) {
  selecting *work = data;
  const conic_neighbours *tree = &work->patches->surface->tree;
  size_t end = (i_item + 1) * CHUNK < tree->n_points ? (i_item + 1) * CHUNK : tree->n_points;
  size_t at = work->chunk_starts[i_item];
  (void)i_thread;
  for (size_t i = i_item * CHUNK; i < end; i++) {
    uint32_t slot = tree->slot_of_point[i];
    int is_grid = slot != CONIC_NO_SLOT && work->patches->plans[slot] >= PLAN_DEEP;
    size_t n = slot == CONIC_NO_SLOT ? 1 : count_of(work, slot);
    if (is_grid)
      put_grid(work, slot, at);
    else if (n > 0)
      put_splat(work, i, at);
    put_point(work, i, at, n, is_grid);
    at += n;
  }
}

/* The clip lines of the splats that are drawn as such. */
static void put_clips(const selecting *work) {
  const conic_splats *from = work->patches->splats;
  conic_patch_selection *selection = work->selection;
  size_t at = 0, n = selection->splats.count;
  selection->splats.n_clips = 0;
  for (size_t i = 0; i < from->n_clips; i++) {
    size_t end = n;
    while (at < end) { /* the first sample whose point is not before */
      size_t middle = at + (end - at) / 2;
      if (selection->points[middle] < from->clips[i].splat)
        at = middle + 1;
      else
        end = middle;
    }
    if (at < n && selection->points[at] == from->clips[i].splat) {
      conic_clip *clip = &selection->splats.clips[selection->splats.n_clips++];
      *clip = from->clips[i];
      clip->splat = (uint32_t)at;
    }
  }
}

static conic_status reserve(const selecting *work, size_t n) {
  conic_context *context = work->patches->context;
  conic_patch_selection *selection = work->selection;
  unsigned fields = conic_splats_fields(work->patches->splats) & (CONIC_SPLATS_COLORS | CONIC_SPLATS_CLIPS);
  fields |= CONIC_SPLATS_TANGENTS | CONIC_SPLATS_OPACITIES;
  if (n <= selection->room && conic_splats_fields(&selection->splats) == fields)
    return CONIC_OK;
  conic_patch_selection_release(context, selection);
  size_t room = n + n / 4 + 1;
  conic_status status = conic_splats_allocate(context, room, fields, &selection->splats);
  selection->points = status == CONIC_OK ? conic_memory_allocate(context, room, sizeof *selection->points) : NULL;
  if (!selection->points) {
    conic_patch_selection_release(context, selection);
    return CONIC_ERROR_MEMORY;
  }
  selection->room = room;
  return CONIC_OK;
}

static conic_status plan(selecting *work) {
  const conic_neighbours *tree = &work->patches->surface->tree;
  size_t n = 1;
  while (n < tree->n_leaves && n < (size_t)1 << N_SUBTREES_LOG2)
    n *= 2;
  work->first_subtree = n - 1;
  for (int i = 0; i < N_GRIDS; i++) {
    conic_grid_part part = conic_grid_whole(grid_sizes[i]);
    work->grid_counts[i] = conic_grid_count(&part);
  }
  memset(work->patches->plans, PLAN_CULLED, tree->n_slots);
  conic_parallel_for(work->patches->context, n, plan_subtree, work);
  conic_parallel_for(work->patches->context, work->n_chunks, count_chunk, work);
  work->chunk_starts[0] = 0;
  for (size_t i = 0; i < work->n_chunks; i++)
    work->chunk_starts[i + 1] += work->chunk_starts[i];
  if (work->chunk_starts[work->n_chunks] > UINT32_MAX - 1)
    return conic_fail(work->patches->context, CONIC_ERROR_MEMORY, "patches: the picture needs too many samples");
  return CONIC_OK;
}

/* By point, as points at one place are drawn each. */
static void count_kinds(const selecting *work) {
  const conic_neighbours *tree = &work->patches->surface->tree;
  conic_patch_selection *selection = work->selection;
  selection->n_patches = selection->n_splats = selection->n_culled = 0;
  for (size_t i = 0; i < tree->n_points; i++) {
    uint32_t slot = tree->slot_of_point[i];
    int what = slot == CONIC_NO_SLOT ? PLAN_SPLAT : work->patches->plans[slot];
    selection->n_culled += what == PLAN_CULLED;
    selection->n_splats += what == PLAN_SPLAT;
    selection->n_patches += what >= PLAN_DEEP;
  }
  selection->n_samples = selection->splats.count - selection->n_splats;
}

conic_status conic_patches_select(conic_patches *patches, const conic_camera *camera,
                                  const conic_render_options *render, conic_patch_selection *selection) {
  const conic_neighbours *tree = &patches->surface->tree;
  const float *box = tree->boxes[0];
  double diagonal2 = 0.0;
  selecting work = {.patches = patches, .selection = selection, .n_chunks = (tree->n_points + CHUNK - 1) / CHUNK};
  if (!(camera->fx > 0.0 && camera->fy > 0.0 && camera->width > 0 && camera->height > 0) ||
      render->kernel.cutoff != patches->options.cutoff || !(render->prefilter >= 0.0f))
    return conic_fail(patches->context, CONIC_ERROR_ARGUMENT,
                      "patches: the camera makes no sense, or the kernel's cutoff is not that of the patches");
  for (int axis = 0; axis < 3; axis++)
    diagonal2 += ((double)box[3 + axis] - (double)box[axis]) * ((double)box[3 + axis] - (double)box[axis]);
  conic_patches_view_init(&work.view, camera, render, patches->splats->origin,
                          diagonal2 > 0.0 ? 1e-4 * sqrt(diagonal2) : 1e-4, patches->options.step_px);
  work.chunk_starts = conic_memory_allocate(patches->context, work.n_chunks + 1, sizeof *work.chunk_starts);
  conic_status status = work.chunk_starts ? plan(&work) : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK)
    status = reserve(&work, work.chunk_starts[work.n_chunks]);
  if (status == CONIC_OK) {
    selection->splats.count = work.chunk_starts[work.n_chunks];
    memcpy(selection->splats.origin, patches->splats->origin, sizeof selection->splats.origin);
    conic_parallel_for(patches->context, work.n_chunks, fill_chunk, &work);
    put_clips(&work);
    count_kinds(&work);
  }
  conic_memory_release(patches->context, work.chunk_starts);
  return status;
}

void conic_patch_selection_name(const conic_patch_selection *selection, conic_image *image) {
  uint32_t *ids = image->planes[CONIC_PLANE_ID];
  size_t n = (size_t)image->width * (size_t)image->height;
  for (size_t i = 0; ids && i < n; i++)
    if (ids[i] < selection->splats.count)
      ids[i] = selection->points[ids[i]];
}

void conic_patch_selection_release(conic_context *context, conic_patch_selection *selection) {
  conic_splats_release(context, &selection->splats);
  conic_memory_release(context, selection->points);
  memset(selection, 0, sizeof *selection);
}
