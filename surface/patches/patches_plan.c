/* Decides, down the tree, which slots a picture draws, and how finely. */

#include "surface/patches/patch_set.h"

const int conic_grid_sizes[CONIC_N_GRIDS] = {3, 4, 6, 8, 12, 16, 24, 32, 48, 64};

enum { N_SUBTREES = 64 };

/* A patch with a radius of fewer pixels than the first is drawn as its point's splat, from the second on as itself; in
 * between, it fades. */
static const double LEAST_RADIUS_PX = 4.0, SURE_RADIUS_PX = 6.0;

/* No grid needs finer steps than make its samples' distance from the surface, or from its slope, this small; nor fewer
 * rows than this. */
static const double OFF_PX = 0.25, OFF_SLOPE = 0.01, LEAST_ROWS = 6.0;

typedef struct patches_planning {
  conic_patches *patches;
  const conic_patches_view *view;
  uint8_t *plans;
  size_t first_subtree;
} patches_planning;

/* So many rows that samples are a step apart on the screen, or so many that more would not be better. */
static double patch_rows(const conic_patches_view *view, const conic_patch *patch, const double p[3], double around) {
  double across_px = 2.0 * conic_patches_pixels(view, p, around, (double)patch->radius);
  double bend_px = conic_patches_pixels(view, p, around, (double)patch->bend);
  double flat2 =
      4.0 * CONIC_SAMPLE_OUTLINE * CONIC_SAMPLE_OUTLINE * bend_px / OFF_PX; /* a disc's rim leaves the surface */
  double even2 = 4.0 * CONIC_SAMPLE_BLUR * CONIC_SAMPLE_BLUR * (double)patch->twist / OFF_SLOPE;
  double enough2 = flat2 > even2 ? flat2 : even2, enough = sqrt(enough2);
  enough = enough > LEAST_ROWS ? enough : LEAST_ROWS;
  double fine = across_px / view->step_px;
  return fine < enough ? fine : enough;
}

/* Whether a whole patch faces away from the eye. */
static int faces_away(const conic_patches_view *view, const conic_patch *patch, double around) {
  double center[3], p[3], normal[3], n[3], across2 = 0.0, along = 0.0, slope = (double)patch->slope;
  for (int axis = 0; axis < 3; axis++) {
    center[axis] = (double)patch->center[axis];
    normal[axis] = (double)patch->normal[axis];
  }
  conic_viewpoint_move(&view->from, center, p);
  for (int i = 0; i < 3; i++) {
    n[i] = conic_dot(view->from.rotation[i], normal);
    along += n[i] * p[i];
    across2 += p[i] * p[i];
  }
  across2 -= along * along;
  return along > 1.001 * (slope * sqrt(across2 > 0.0 ? across2 : 0.0) + around * (1.0 + slope));
}

/* A slot's place in camera space; returns its reach. */
static double place_of_patch(const conic_patches *patches, const conic_patches_view *view, size_t slot, double p[3]) {
  const conic_neighbours *tree = &patches->surface->tree;
  const double place[3] = {(double)tree->position[0][slot], (double)tree->position[1][slot],
                           (double)tree->position[2][slot]};
  conic_viewpoint_move(&view->from, place, p);
  return (double)patches->patches[slot].reach;
}

double conic_patches_share(const conic_patches *patches, const conic_patches_view *view, size_t slot) {
  double p[3], reach = place_of_patch(patches, view, slot, p);
  double radius_px = conic_patches_pixels(view, p, reach, (double)patches->patches[slot].radius);
  return (radius_px - LEAST_RADIUS_PX) / (SURE_RADIUS_PX - LEAST_RADIUS_PX);
}

static uint8_t plan_slot(const patches_planning *work, size_t slot) {
  const conic_patch *patch = &work->patches->patches[slot];
  double p[3], reach = place_of_patch(work->patches, work->view, slot, p);
  if (!conic_patches_sees(work->view, p, reach))
    return CONIC_PLAN_CULLED;
  double radius_px = conic_patches_pixels(work->view, p, reach, (double)patch->radius);
  if (!(radius_px > LEAST_RADIUS_PX))
    return CONIC_PLAN_SPLAT;
  if (work->view->cull_back && faces_away(work->view, patch, reach))
    return CONIC_PLAN_CULLED;
  double rows = patch_rows(work->view, patch, p, reach);
  int fading = radius_px < SURE_RADIUS_PX ? CONIC_PLAN_FADING : 0;
  for (int i = 0; i < CONIC_N_GRIDS; i++)
    if (rows <= (double)conic_grid_sizes[i])
      return (uint8_t)((CONIC_PLAN_GRID + i) | fading);
  return CONIC_PLAN_DEEP;
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

static uint32_t deep_count(const patches_planning *work, size_t slot) {
  const conic_patches *patches = work->patches;
  size_t n = conic_patch_sample_deep(work->view, &patches->patches[slot], patches->options.surface.degree,
                                     (double)patches->options.cutoff, NULL);
  return n < UINT32_MAX ? (uint32_t)n : UINT32_MAX; /* too many, which is reported later */
}

static void plan_all(patches_planning *work, size_t i_node, int is_splat) {
  const conic_neighbours *tree = &work->patches->surface->tree;
  size_t begin, end;
  leaves_of(tree, i_node, &begin, &end);
  size_t first = conic_neighbours_leaf_begin(tree, begin), last = conic_neighbours_leaf_begin(tree, end);
  for (size_t slot = first; slot < last; slot++) {
    uint8_t plan = is_splat ? CONIC_PLAN_SPLAT : plan_slot(work, slot);
    work->plans[slot] = plan;
    int is_slots_own =
        conic_patches_shown(work->patches, tree->point_of_slot[slot], (uint32_t)slot) == &work->patches->patches[slot];
    if (plan == CONIC_PLAN_DEEP && is_slots_own)
      work->patches->counts[slot] = deep_count(work, slot);
  }
}

static void plan_node(patches_planning *work, size_t i_node) {
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
  conic_viewpoint_move(&work->view->from, center, p);
  if (!conic_patches_sees(work->view, p, around))
    return; /* stays culled */
  if (conic_patches_pixels(work->view, p, around, (double)patches->node_radius[i_node]) <= LEAST_RADIUS_PX)
    plan_all(work, i_node, 1);
  else if (i_node >= tree->n_leaves - 1)
    plan_all(work, i_node, 0);
  else {
    plan_node(work, 2 * i_node + 1);
    plan_node(work, 2 * i_node + 2);
  }
}

static void plan_subtree(void *data, size_t i_item) {
  patches_planning *work = data;
  plan_node(work, work->first_subtree + i_item);
}

void conic_patches_plan(conic_patches *patches, const conic_patches_view *view, uint8_t *plans) {
  const conic_neighbours *tree = &patches->surface->tree;
  size_t n = 1;
  while (n < tree->n_leaves && n < N_SUBTREES)
    n *= 2;
  patches_planning work = {patches, view, plans, n - 1};
  memset(plans, CONIC_PLAN_CULLED, tree->n_slots);
  conic_parallel_for(patches->context, n, plan_subtree, &work);
}

/* --- patches near the eye: cells out of sight are left out, and each other is sampled as finely as it needs --- */

enum { CELL_ROWS = 16, DEEPEST_CELL = 22 };

typedef struct descent {
  const conic_patches_view *view;
  const conic_patch *patch;
  int degree;
  double cutoff;
  const conic_grid_samples *to; /* null: samples are only counted */
  size_t n;
} descent;

/* The place (s, t) of a patch, in camera space. */
static void place_on_patch(const descent *d, double s, double t, double p[3]) {
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
  conic_viewpoint_move(&d->view->from, place, p);
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
    to.clips = to.clips ? to.clips + d->n : NULL;
    conic_grid_sample(d->patch, d->degree, d->cutoff, part, &to);
  }
  d->n += conic_grid_count(part, d->patch->fence);
}

/* Samples, or divides further, the cell in `row` and `column` of the 2^depth × 2^depth cells of the patch. */
static void descend(descent *d, int depth, int64_t row, int64_t column) {
  double half = 1.0 / (double)(INT64_C(1) << depth), p[3];
  double s = (double)(2 * column + 1) * half - 1.0, t = (double)(2 * row + 1) * half - 1.0;
  double to_s = fabs(s) > half ? fabs(s) - half : 0.0, to_t = fabs(t) > half ? fabs(t) - half : 0.0;
  if (to_s * to_s + to_t * to_t > 1.0)
    return;
  double slope = (double)d->patch->slope, stretch = (double)d->patch->radius * sqrt(1.0 + slope * slope);
  double step = 2.0 * half / CELL_ROWS;
  double around = 1.001 * stretch * (1.4143 * half + CONIC_SAMPLE_OUTLINE * step);
  place_on_patch(d, s, t, p);
  if (!conic_patches_sees(d->view, p, around))
    return;
  if (depth == DEEPEST_CELL || patch_rows(d->view, d->patch, p, around) * half <= CELL_ROWS) {
    conic_grid_part part = {CELL_ROWS * (INT64_C(1) << depth), CELL_ROWS * row, CELL_ROWS * column, CELL_ROWS,
                            CELL_ROWS};
    emit_cell(d, &part);
    return;
  }
  for (int child = 0; child < 4; child++)
    descend(d, depth + 1, 2 * row + child / 2, 2 * column + child % 2);
}

size_t conic_patch_sample_deep(const conic_patches_view *view, const conic_patch *patch, int degree, double cutoff,
                               const conic_grid_samples *to) {
  descent d = {view, patch, degree, cutoff, to, 0};
  descend(&d, 0, 0, 0);
  return d.n;
}
