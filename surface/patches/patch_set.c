/* Lays patches: a polynomial about every point, with the radius up to which it can be trusted. */
#include "surface/patches/patch_set.h"

#include <math.h>
#include <string.h>

#include "core/base/memory.h"
#include "core/base/message.h"
#include "core/base/options.h"
#include "core/base/threads.h"
#include "core/base/vectors.h"
#include "core/splats/clip.h"
#include "core/splats/columns.h"

/* --- staying at the points: a polynomial does not know where the surface ends, but splats may --- */

/* Unit vectors, 45° apart. */
static const double eight_directions[8][2] = {
    {1, 0},  {0.70710678118654752, 0.70710678118654752},   {0, 1},  {-0.70710678118654752, 0.70710678118654752},
    {-1, 0}, {-0.70710678118654752, -0.70710678118654752}, {0, -1}, {0.70710678118654752, -0.70710678118654752}};

static int is_kept(const conic_splats *splats, size_t splat, double u, double v) {
  size_t i = conic_clip_find(splats, splat);
  int n_keeping = 0;
  if (i == splats->n_clips || splats->clips[i].splat != splat)
    return 1;
  const conic_clip *clip = &splats->clips[i];
  for (int k = 0; k < clip->n_lines; k++)
    n_keeping += (double)clip->lines[k][0] * u + (double)clip->lines[k][1] * v + (double)clip->lines[k][2] >= 0.0;
  return clip->operation == CONIC_CLIP_OR ? n_keeping > 0 : n_keeping == clip->n_lines;
}

/* Whether a splat with its centre at `to` from the place is within most_off of the place. */
static int is_at_splat(const conic_patches *patches, size_t splat, const double to[3]) {
  const conic_splats *splats = &patches->splats;
  double u[3], v[3], normal[3], limit = (double)patches->options.cutoff;
  conic_vector_at(splats->tangent_u, splat, u);
  conic_vector_at(splats->tangent_v, splat, v);
  double along = -conic_dot(to, u) / conic_dot(u, u), across = -conic_dot(to, v) / conic_dot(v, v);
  conic_cross(u, v, normal);
  return along * along + across * across <= limit * limit && conic_normalize(normal) &&
         fabs(conic_dot(to, normal)) <= patches->options.most_off && is_kept(splats, splat, along, across);
}

static double height_at(const conic_fit *fit, int degree, double x, double y) {
  double sum = 0.0, first = 1.0;
  for (int i = 0; i <= degree; i++, first *= x) {
    double power = first;
    for (int j = 0; i + j <= degree; j++, power *= y)
      sum += fit->coefficients[(i + j) * (i + j + 1) / 2 + j] * power;
  }
  return sum;
}

/* Whether the polynomial at (x, y), in units of h, is at a splat of the nearby points. */
static int is_at_points(const conic_patches *patches, const conic_workspace *workspace, int degree, double h, double x,
                        double y) {
  const conic_near *near = &workspace->near;
  const conic_fit *fit = &workspace->fit;
  double place[3], height = height_at(fit, degree, x, y);
  for (int axis = 0; axis < 3; axis++)
    place[axis] =
        fit->foot[axis] + h * (x * fit->frame[0][axis] + y * fit->frame[1][axis] + height * fit->frame[2][axis]);
  for (size_t i = 0; i < near->n; i++) {
    double to[3];
    if (near->sources[i] & CONIC_CLUSTER_BIT)
      continue;
    for (int axis = 0; axis < 3; axis++)
      to[axis] = near->offset[axis][i] - place[axis];
    if (is_at_splat(patches, patches->surface->tree.point_of_slot[near->sources[i]], to))
      return 1;
  }
  return 0;
}

/* Whether the polynomial of the workspace's fit stays within the options' most_off of the splats of the points that it
 * was fitted to: on a circle, on one half as large, and in the middle. */
static int stays_at_points(const conic_patches *patches, const conic_workspace *workspace, int degree, double h,
                           double radius) {
  for (int i = 0; i < 17; i++) {
    double share = i < 8 ? 1.0 : i < 16 ? 0.5 : 0.0;
    if (!is_at_points(patches, workspace, degree, h, share * radius / h * eight_directions[i % 8][0],
                      share * radius / h * eight_directions[i % 8][1]))
      return 0;
  }
  return 1;
}

enum { CHUNK = 16, CHUNKS_A_REPORT = 256 };

/* The most that a sample's error may grow at a patch's rim, squared, and the greatest slope there. */
static const double MOST_GAIN = 4.0, MOST_SLOPE = 3.0;

/* A patch that is not sound up to its rim shrinks in such steps, down to this share of its splat's outline: there it
 * just covers the cell of the tangent plane that the splat was made for. */
static const double SHRINKAGE = 0.85, LEAST_SHARE = 0.6;

/* A flat patch has this share of a splat's outline as radius: with the outlines of its samples it reaches about as
 * far. */
static const double FLAT_SHARE = 0.8;

void conic_patches_options_init_sized(conic_patches_options *options, size_t size) {
  conic_patches_options own = {.size = sizeof own, .cutoff = 1.5f, .step_px = 2.0};
  conic_surface_options_init(&own.surface);
  conic_options_give(options, size, &own);
}

static conic_status check_patch_options(conic_context *context, const conic_splats *splats,
                                        const conic_patches_options *o) {
  if (o->surface.type != CONIC_SURFACE_MLS)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "patches: spheres are no polynomials");
  if (!(o->cutoff >= 0.25f && o->cutoff <= 5.0f) || !(o->step_px >= 0.25 && o->step_px <= 16.0))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "patches: cutoff %g or step %g is out of range", (double)o->cutoff,
                      o->step_px);
  if (!(conic_splats_fields(splats) & CONIC_SPLATS_TANGENTS))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "patches: the splats have no tangent axes");
  return CONIC_OK;
}

typedef struct laying {
  conic_patches *patches;
  conic_workspace *workspaces;
  uint8_t *outcomes; /* by slot */
} laying;

/* Fig. 10: the circle about q that holds the samples in a ball about it, seen along the normal. */
static double radius_of(const conic_workspace *workspace, double ball) {
  const conic_near *near = &workspace->near;
  const conic_fit *fit = &workspace->fit;
  double radius2 = 0.0;
  for (size_t i = 0; i < near->n; i++) {
    double distance2 = 0.0, height = 0.0;
    for (int axis = 0; axis < 3; axis++) {
      double d = near->offset[axis][i] - fit->foot[axis];
      distance2 += d * d;
      height += d * fit->frame[2][axis];
    }
    double flat2 = distance2 - height * height;
    if (distance2 <= ball * ball && flat2 > radius2)
      radius2 = flat2;
  }
  return sqrt(radius2);
}

static double length_of_axis(float *const axes[3], size_t i) {
  double x = (double)axes[0][i], y = (double)axes[1][i], z = (double)axes[2][i];
  return sqrt((x * x + y * y) + z * z);
}

/* How far a point's own splat reaches; 0 where that is not finite. */
static double outline_of(const conic_patches *patches, size_t point) {
  double u = length_of_axis(patches->splats.tangent_u, point), v = length_of_axis(patches->splats.tangent_v, point);
  double outline = (double)patches->options.cutoff * (u > v ? u : v);
  return outline < 1e30 ? outline : 0.0;
}

/* The steepest slope of the polynomial at (x, y), in units of h. */
static double slope_at(const conic_fit *fit, int degree, double x, double y) {
  double along = 0.0, across = 0.0;
  for (int i = 0; i <= degree; i++) {
    double height = 0.0, slope = 0.0, power = 1.0;
    for (int j = degree - i; j >= 0; j--) {
      double c = fit->coefficients[(i + j) * (i + j + 1) / 2 + j];
      slope = j > 0 ? slope * y + (double)j * c : slope;
      height = height * y + c;
    }
    for (int k = 1; k < i; k++)
      power *= x;
    along += (double)i * height * power;
    across += slope * (i > 0 ? power * x : 1.0);
  }
  return sqrt(along * along + across * across);
}

/* Whether the polynomial can be trusted on a circle: as much as in its middle, and not too steep. */
static int is_sound(const conic_fit *fit, int degree, double radius) {
  for (int i = 0; i < 8; i++) {
    double x = radius * eight_directions[i][0], y = radius * eight_directions[i][1];
    if (!(conic_fit_gain(fit, degree, x, y) <= MOST_GAIN && slope_at(fit, degree, x, y) <= MOST_SLOPE))
      return 0;
  }
  return 1;
}

/* The greatest radius on which the polynomial is sound, in steps from `radius` down to `least`; 0: none. */
static double sound_radius(const conic_patches *patches, const conic_workspace *workspace, int degree, double h,
                           double radius, double least) {
  for (; radius >= least; radius *= SHRINKAGE)
    if (is_sound(&workspace->fit, degree, radius / h) &&
        (!(patches->options.most_off > 0.0) || stays_at_points(patches, workspace, degree, h, radius)))
      return radius;
  return 0.0;
}

/* Makes the patch of a fit about r; `sign` -1 turns it over, by mirroring it along its first axis. */
static void set_patch(conic_patch *patch, const conic_fit *fit, int degree, const double r[3], double h, double radius,
                      double sign) {
  double scale = h, slopes = 0.0, bends = 0.0, twists = 0.0, heights = 0.0, foot2 = 0.0;
  for (int axis = 0; axis < 3; axis++) {
    patch->center[axis] = (float)(r[axis] + fit->foot[axis]);
    patch->along[axis] = (float)(sign * radius * fit->frame[0][axis]);
    patch->across[axis] = (float)(radius * fit->frame[1][axis]);
    patch->normal[axis] = (float)(sign * fit->frame[2][axis]);
    foot2 += fit->foot[axis] * fit->foot[axis];
  }
  for (int power = 0, k = 0; power <= degree; power++, scale *= radius / h)
    for (int j = 0; j <= power; j++, k++) {
      double turn = sign < 0.0 && (power - j) % 2 == 0 ? -1.0 : 1.0, c = turn * fit->coefficients[k] * scale;
      patch->coefficients[k] = (float)c;
      slopes += (double)power * fabs(c);
      bends += 0.5 * (double)(power * (power - 1)) * fabs(c);
      twists += 0.5 * (double)(power * (power - 1) * (power - 2)) * fabs(c);
      heights += fabs(c);
    }
  patch->slope = (float)(slopes / radius);
  patch->bend = (float)bends;
  patch->twist = (float)(twists / radius);
  double outline = CONIC_SAMPLE_OUTLINE * 2.0 / CONIC_LEAST_GRID * sqrt(1.0 + (slopes / radius) * (slopes / radius));
  patch->reach = (float)(1.001 * (sqrt(foot2) + radius * (1.0 + outline) + heights));
  patch->radius = (float)radius;
}

/* Makes the patch of a point without a sound polynomial: the part of its plane that its splat covers. There is none
 * where the splat has no axes or is a dot. Beside a mesh's faces, too, the splat stays. */
static void set_flat_patch(const conic_patches *patches, size_t slot, const double r[3]) {
  const conic_splats *splats = &patches->splats;
  size_t point = patches->surface->tree.point_of_slot[slot];
  conic_patch *patch = &patches->patches[slot];
  double share = FLAT_SHARE * (double)patches->options.cutoff, outline = FLAT_SHARE * outline_of(patches, point);
  double u[3], v[3], normal[3];
  for (int axis = 0; axis < 3; axis++) {
    u[axis] = share * (double)splats->tangent_u[axis][point];
    v[axis] = share * (double)splats->tangent_v[axis][point];
  }
  conic_cross(u, v, normal);
  if (!(outline > 0.0) || !conic_normalize(normal) || patches->options.most_off > 0.0 ||
      (splats->dot && splats->dot[point] != 0.0f))
    return;
  *patch = (conic_patch){.radius = (float)outline};
  for (int axis = 0; axis < 3; axis++) {
    patch->center[axis] = (float)r[axis];
    patch->along[axis] = (float)u[axis];
    patch->across[axis] = (float)v[axis];
    patch->normal[axis] = (float)normal[axis];
  }
  patch->reach = (float)(1.001 * outline * (1.0 + CONIC_SAMPLE_OUTLINE * 2.0 / CONIC_LEAST_GRID));
}

static void lay_patch(laying *work, size_t slot, conic_workspace *workspace) {
  conic_patches *patches = work->patches;
  const conic_surface *surface = patches->surface;
  conic_landing landing;
  double r[3], turn = 0.0, h = (double)surface->h[slot];
  conic_vector_at(surface->tree.position, slot, r);
  const float side[3] = {surface->normal[0][slot], surface->normal[1][slot], surface->normal[2][slot]};
  workspace->side = side;
  conic_surface_project_one(surface, r, h, CONIC_NO_SLOT, 1, workspace, &landing);
  work->outcomes[slot] = (uint8_t)landing.outcome;
  double outline = outline_of(patches, surface->tree.point_of_slot[slot]);
  set_flat_patch(patches, slot, r);
  if (landing.outcome != CONIC_SURFACE_DONE || !(outline > 0.0))
    return;
  conic_fit *fit = &workspace->fit;
  for (int axis = 0; axis < 3; axis++)
    turn += (double)surface->normal[axis][slot] * fit->frame[2][axis];
  double radius = radius_of(workspace, h), least = LEAST_SHARE * outline;
  radius = radius > least ? radius : least;
  for (int degree = surface->options.degree; degree > 1; degree--) { /* degree 1 would be the flat patch */
    conic_fit_solve(fit, degree);
    double sound = sound_radius(patches, workspace, degree, h, radius, least);
    if (!(sound > 0.0))
      continue;
    set_patch(&patches->patches[slot], fit, degree, r, h, sound, turn < 0.0 ? -1.0 : 1.0);
    return;
  }
}

static void lay_chunk(void *data, size_t i_item, int i_thread) {
  laying *work = data;
  const conic_surface *surface = work->patches->surface;
  conic_workspace *workspace = &work->workspaces[i_thread];
  for (size_t i = i_item * CHUNK; i < (i_item + 1) * CHUNK && i < surface->tree.n_leaves; i++) {
    conic_surface_share_leaf(surface, i, workspace);
    for (size_t slot = conic_neighbours_leaf_begin(&surface->tree, i);
         slot < conic_neighbours_leaf_begin(&surface->tree, i + 1); slot++)
      lay_patch(work, slot, workspace);
  }
}

static conic_status lay_all(laying *work) {
  conic_context *context = work->patches->context;
  size_t n_chunks = (work->patches->surface->tree.n_leaves + CHUNK - 1) / CHUNK;
  conic_status status = conic_workspaces_create(context, &work->workspaces);
  if (status == CONIC_OK)
    status = conic_parallel_runs(context, "patches", 0.0, 1.0, n_chunks, CHUNKS_A_REPORT, lay_chunk, work);
  if (status == CONIC_OK)
    status = conic_workspaces_check(context, work->workspaces);
  conic_workspaces_release(context, work->workspaces);
  return status;
}

/* Clip lines stand for creases, which polynomials do not have. */
static void take_clipped_away(conic_patches *patches) {
  const conic_splats *splats = &patches->splats;
  for (size_t i = 0; i < splats->n_clips; i++)
    if (splats->clips[i].splat < splats->count) {
      uint32_t slot = patches->surface->tree.slot_of_point[splats->clips[i].splat];
      if (slot != CONIC_NO_SLOT)
        patches->patches[slot].radius = 0.0f;
    }
}

/* Points at one place share a slot: it must reach as far as any of their splats. */
static void reach_splats(conic_patches *patches) {
  const conic_neighbours *tree = &patches->surface->tree;
  for (size_t i = 0; i < tree->n_points; i++) {
    uint32_t slot = tree->slot_of_point[i];
    if (slot == CONIC_NO_SLOT)
      continue;
    float outline = (float)(1.001 * outline_of(patches, i));
    if (patches->patches[slot].reach < outline)
      patches->patches[slot].reach = outline;
  }
}

static void bound_node(conic_patches *patches, size_t i) {
  const conic_neighbours *tree = &patches->surface->tree;
  float *reach = &patches->node_reach[i], *radius = &patches->node_radius[i];
  *reach = *radius = 0.0f;
  if (i < tree->n_leaves - 1) {
    for (size_t child = 2 * i + 1; child <= 2 * i + 2; child++) {
      *reach = *reach > patches->node_reach[child] ? *reach : patches->node_reach[child];
      *radius = *radius > patches->node_radius[child] ? *radius : patches->node_radius[child];
    }
    return;
  }
  size_t i_leaf = i - (tree->n_leaves - 1);
  for (size_t slot = conic_neighbours_leaf_begin(tree, i_leaf); slot < conic_neighbours_leaf_begin(tree, i_leaf + 1);
       slot++) {
    const conic_patch *patch = &patches->patches[slot];
    *reach = *reach > patch->reach ? *reach : patch->reach;
    *radius = *radius > patch->radius ? *radius : patch->radius;
  }
}

static void report_patches(conic_patches *patches, const uint8_t *outcomes) {
  const conic_neighbours *tree = &patches->surface->tree;
  conic_patches_report *report = &patches->report;
  report->n_points = tree->n_points;
  for (size_t i = 0; i < tree->n_points; i++) {
    uint32_t slot = tree->slot_of_point[i];
    report->outcomes[slot == CONIC_NO_SLOT ? CONIC_SURFACE_NOT_FINITE : outcomes[slot]]++;
    report->n_patches += slot != CONIC_NO_SLOT && patches->patches[slot].radius > 0.0f;
  }

  report->n_bytes =
      tree->n_slots * (sizeof(conic_patch) + 2 + 3 * sizeof(uint32_t)) + 4 * tree->n_leaves * sizeof(float);
}

static conic_status allocate_patches(conic_patches *patches) {
  conic_context *context = patches->context;
  size_t n = patches->surface->tree.n_slots, n_nodes = 2 * patches->surface->tree.n_leaves;
  patches->patches = conic_memory_allocate_zeroed(context, n, sizeof *patches->patches);
  patches->counts = conic_memory_allocate(context, n, sizeof *patches->counts);
  patches->node_reach = conic_memory_allocate(context, n_nodes, sizeof(float));
  patches->node_radius = conic_memory_allocate(context, n_nodes, sizeof(float));
  int is_whole = patches->patches && patches->counts && patches->node_reach && patches->node_radius;
  for (int i = 0; i < 2; i++) {
    is_whole &= (patches->frames[i].plans = conic_memory_allocate_zeroed(context, n, 1)) != NULL;
    is_whole &= (patches->frames[i].starts = conic_memory_allocate(context, n, sizeof(uint32_t))) != NULL;
  }
  return is_whole ? CONIC_OK : CONIC_ERROR_MEMORY;
}

static conic_status lay(conic_patches *patches) {
  conic_context *context = patches->context;
  laying work = {patches, NULL, NULL};
  conic_status status = conic_surface_create(context, &patches->splats, &patches->options.surface, &patches->surface);
  if (status == CONIC_OK)
    status = allocate_patches(patches);
  if (status != CONIC_OK)
    return status;
  work.outcomes = conic_memory_allocate(context, patches->surface->tree.n_slots, sizeof *work.outcomes);
  status = work.outcomes ? lay_all(&work) : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK) {
    take_clipped_away(patches);
    reach_splats(patches);
    for (size_t i = 2 * patches->surface->tree.n_leaves - 1; i-- > 0;)
      bound_node(patches, i);
    report_patches(patches, work.outcomes);
  }
  conic_memory_release(context, work.outcomes);
  return status;
}

conic_status conic_patches_create(conic_context *context, const conic_splats *splats,
                                  const conic_patches_options *given, conic_patches **patches) {
  conic_patches_options own, *options = &own;
  *patches = NULL;
  conic_patches_options_init(options);
  if (given && !conic_options_take(options, given))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "patches: the options were not initialised");
  conic_status status = conic_splats_check(context, "patches", splats);
  if (status == CONIC_OK)
    status = check_patch_options(context, splats, options);
  if (status != CONIC_OK)
    return status;
  conic_patches *made = conic_memory_allocate_zeroed(context, 1, sizeof *made);
  if (!made)
    return CONIC_ERROR_MEMORY;
  made->context = context;
  made->options = *options;
  status = conic_splats_enter(context, "patches", splats, &made->splats, &made->block);
  if (status == CONIC_OK)
    status = lay(made);
  if (status == CONIC_OK)
    *patches = made;
  else
    conic_patches_destroy(made);
  return status;
}

void conic_patches_destroy(conic_patches *patches) {
  if (!patches)
    return;
  conic_context *context = patches->context;
  conic_surface_destroy(patches->surface);
  conic_memory_release_these(context, patches->block, patches->patches);
  conic_patches_release_frames(patches);
  conic_memory_release_these(context, patches->counts, patches->node_reach, patches->node_radius, patches);
}

void conic_patches_describe(const conic_patches *patches, conic_patches_report *report) {
  *report = patches->report;
}
