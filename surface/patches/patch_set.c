/* Lays patches: a polynomial about every point, with the radius up to which it can be trusted. */
#include "surface/patches/patch_set.h"

#include "core/splats/columns.h"

/* Unit vectors, 45° apart. */
static const double eight_directions[8][2] = {
    {1, 0},  {0.70710678118654752, 0.70710678118654752},   {0, 1},  {-0.70710678118654752, 0.70710678118654752},
    {-1, 0}, {-0.70710678118654752, -0.70710678118654752}, {0, -1}, {0.70710678118654752, -0.70710678118654752}};

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
  conic_patch_mesh mesh;
  size_t *first_sides; /* with a mesh, by slot */
  uint8_t *is_laid;    /* with a mesh, by slot: its sides have patches */
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

double conic_fit_steepest(const conic_fit *fit, int degree, double radius_x, double radius_y) {
  double steepest = 0.0;
  for (int i = 0; i < 8; i++) {
    double slope = slope_at(fit, degree, radius_x * eight_directions[i][0], radius_y * eight_directions[i][1]);
    steepest = slope <= steepest ? steepest : slope;
  }
  return steepest;
}

/* Whether the polynomial can be trusted on a circle: as much as in its middle, and not too steep. */
static int is_sound(const conic_fit *fit, int degree, double radius) {
  for (int i = 0; i < 8; i++) {
    double x = radius * eight_directions[i][0], y = radius * eight_directions[i][1];
    if (!(conic_fit_gain(fit, degree, x, y) <= MOST_GAIN))
      return 0;
  }
  return conic_fit_steepest(fit, degree, radius, radius) <= MOST_SLOPE;
}

/* The greatest radius on which the polynomial is sound, in steps from `radius` down to `least`; 0: none. */
static double sound_radius(const conic_fit *fit, int degree, double h, double radius, double least) {
  for (; radius >= least; radius *= SHRINKAGE)
    if (is_sound(fit, degree, radius / h))
      return radius;
  return 0.0;
}

/* Makes the patch of a fit about r, with the radii along the fit's axes; `sign` -1 turns it over, by mirroring it along
 * its first axis. */
static void set_patch(conic_patch *patch, const conic_fit *fit, int degree, const double r[3], double h,
                      const double radii[2], double sign) {
  double slopes = 0.0, bends = 0.0, twists = 0.0, heights = 0.0, foot2 = 0.0;
  double radius = radii[0] > radii[1] ? radii[0] : radii[1], least = radii[0] < radii[1] ? radii[0] : radii[1];
  for (int axis = 0; axis < 3; axis++) {
    patch->center[axis] = (float)(r[axis] + fit->foot[axis]);
    patch->along[axis] = (float)(sign * radii[0] * fit->frame[0][axis]);
    patch->across[axis] = (float)(radii[1] * fit->frame[1][axis]);
    patch->normal[axis] = (float)(sign * fit->frame[2][axis]);
    foot2 += fit->foot[axis] * fit->foot[axis];
  }
  for (int power = 0, k = 0; power <= degree; power++)
    for (int j = 0; j <= power; j++, k++) {
      double turn = sign < 0.0 && (power - j) % 2 == 0 ? -1.0 : 1.0, scale = h;
      for (int i = 0; i < power; i++)
        scale *= radii[i < j ? 1 : 0] / h;
      double c = turn * fit->coefficients[k] * scale;
      patch->coefficients[k] = (float)c;
      slopes += (double)power * fabs(c);
      bends += 0.5 * (double)(power * (power - 1)) * fabs(c);
      twists += 0.5 * (double)(power * (power - 1) * (power - 2)) * fabs(c);
      heights += fabs(c);
    }
  patch->slope = (float)(slopes / least);
  patch->bend = (float)bends;
  patch->twist = (float)(twists / least);
  double outline = CONIC_SAMPLE_OUTLINE * 2.0 / CONIC_LEAST_GRID * sqrt(1.0 + (slopes / least) * (slopes / least));
  patch->reach = (float)(1.001 * (sqrt(foot2) + radius * (1.0 + outline) + heights));
  patch->radius = (float)radius;
}

/* Makes the patch of a point without a sound polynomial: the part of its plane that its splat covers. There is none
 * where the splat has no axes or is a dot. */
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
  if (!(outline > 0.0) || !conic_normalize(normal) || (splats->dot && splats->dot[point] != 0.0f))
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

/* Lays the patches of a mesh's vertex, one a side, and their bounds as the slot's. Returns 0 where any side has none.
 */
static int lay_sides(const laying *work, size_t slot, const double r[3], conic_fit *fit) {
  conic_patches *patches = work->patches;
  conic_patch *bounds = &patches->patches[slot];
  int n_sides = work->mesh.n_sides ? work->mesh.n_sides[slot] : 0, degree = patches->options.surface.degree;
  size_t end = n_sides ? work->mesh.starts[slot] : 0;
  for (int i = 0; i < n_sides; i++) {
    size_t begin = end, side = work->first_sides[slot] + (size_t)i;
    conic_patch *patch = &patches->sides[side];
    double radii[2];
    end = conic_patch_mesh_side_end(&work->mesh, begin, work->mesh.starts[slot + 1]);
    if (!conic_patch_mesh_fit(&work->mesh, slot, begin, end, degree, fit, radii, &patches->fences[side])) {
      *bounds = (conic_patch){.radius = 0.0f};
      return 0;
    }
    set_patch(patch, fit, degree, r, radii[0], radii, 1.0);
    patch->fence = patches->fences[side].n_lines ? &patches->fences[side] : NULL;
    if (i == 0)
      *bounds = *patch;
    bounds->slope = i == 0 ? bounds->slope : INFINITY; /* some side may face the eye */
    bounds->radius = fmaxf(bounds->radius, patch->radius);
    bounds->bend = fmaxf(bounds->bend, patch->bend);
    bounds->twist = fmaxf(bounds->twist, patch->twist);
    bounds->reach = fmaxf(bounds->reach, patch->reach);
  }
  if (n_sides)
    work->is_laid[slot] = 1;
  return n_sides > 0;
}

static void lay_patch(laying *work, size_t slot, conic_workspace *workspace) {
  conic_patches *patches = work->patches;
  const conic_surface *surface = patches->surface;
  conic_landing landing;
  double r[3], radii[2], turn = 0.0, h = (double)surface->h[slot];
  conic_vector_at(surface->tree.position, slot, r);
  const float side[3] = {surface->normal[0][slot], surface->normal[1][slot], surface->normal[2][slot]};
  if (work->mesh.starts && work->mesh.starts[slot] < work->mesh.starts[slot + 1]) {
    int is_laid = lay_sides(work, slot, r, &workspace->fit);
    work->outcomes[slot] = is_laid ? CONIC_SURFACE_DONE : CONIC_SURFACE_ILL_CONDITIONED;
    return;
  }
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
    double sound = sound_radius(fit, degree, h, radius, least);
    if (!(sound > 0.0))
      continue;
    radii[0] = radii[1] = sound;
    set_patch(&patches->patches[slot], fit, degree, r, h, radii, turn < 0.0 ? -1.0 : 1.0);
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

/* Clip lines stand for creases, which polynomials of points do not have. */
static void take_clipped_away(conic_patches *patches) {
  const conic_splats *splats = &patches->splats;
  for (size_t i = 0; i < splats->n_clips; i++)
    if (splats->clips[i].splat < splats->count) {
      uint32_t slot = patches->surface->tree.slot_of_point[splats->clips[i].splat];
      if (slot != CONIC_NO_SLOT && !(patches->side_of_point && patches->side_of_point[splats->clips[i].splat]))
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
    report->n_patches +=
        slot != CONIC_NO_SLOT && patches->patches[slot].radius > 0.0f && conic_patches_shown(patches, i, slot);
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

/* Makes room for the sides of a mesh's vertices. A vertex with more sides than points, which were made of its
 * triangles, gets none. */
static conic_status prepare_sides(laying *work) {
  conic_patches *patches = work->patches;
  conic_context *context = patches->context;
  const conic_neighbours *tree = &patches->surface->tree;
  conic_patch_mesh *mesh = &work->mesh;
  size_t n_sides = 0;
  conic_status status =
      conic_patch_mesh_create(context, patches->options.mesh, tree, patches->splats.origin, &work->mesh);
  if (status != CONIC_OK || !mesh->n_sides)
    return status;
  if (conic_memory_allocate_these(context, CONIC_ZEROED(work->first_sides, tree->n_slots),
                                  CONIC_ZEROED(work->is_laid, tree->n_slots),
                                  CONIC_ZEROED(patches->side_of_point, tree->n_points)) != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < tree->n_points; i++)
    if (tree->slot_of_point[i] != CONIC_NO_SLOT)
      work->first_sides[tree->slot_of_point[i]]++;
  for (size_t slot = 0; slot < tree->n_slots; slot++) {
    mesh->n_sides[slot] = work->first_sides[slot] < mesh->n_sides[slot] ? 0 : mesh->n_sides[slot];
    work->first_sides[slot] = n_sides;
    n_sides += mesh->n_sides[slot];
  }
  patches->sides = conic_memory_allocate(context, n_sides, sizeof *patches->sides);
  patches->fences = conic_memory_allocate(context, n_sides, sizeof *patches->fences);
  return patches->sides && patches->fences && n_sides < CONIC_NO_SIDE ? CONIC_OK : CONIC_ERROR_MEMORY;
}

/* The first points at a vertex show a side each, the others nothing. */
static void hand_out_sides(laying *work) {
  const conic_neighbours *tree = &work->patches->surface->tree;
  size_t n_of_mesh = 0, n_sides = 0;
  double sum2 = 0.0;
  for (size_t i = 0; work->is_laid && i < tree->n_points; i++) {
    uint32_t slot = tree->slot_of_point[i];
    if (slot == CONIC_NO_SLOT || !work->is_laid[slot])
      continue;
    work->patches->side_of_point[i] =
        work->mesh.n_sides[slot] ? (uint32_t)(1 + work->first_sides[slot]++) : CONIC_NO_SIDE;
    n_of_mesh++;
    if (work->mesh.n_sides[slot]) {
      double off = (double)work->patches->fences[work->first_sides[slot] - 1].off;
      work->mesh.n_sides[slot]--;
      n_sides++;
      sum2 += off * off;
    }
  }
  work->patches->report.mesh_off = 2 * n_of_mesh > tree->n_points ? sqrt(sum2 / (double)n_sides) : -1.0;
}

static conic_status lay(conic_patches *patches) {
  conic_context *context = patches->context;
  laying work = {.patches = patches};
  conic_status status = conic_surface_create(context, &patches->splats, &patches->options.surface, &patches->surface);
  if (status == CONIC_OK)
    status = allocate_patches(patches);
  if (status != CONIC_OK)
    return status;
  work.outcomes = conic_memory_allocate(context, patches->surface->tree.n_slots, sizeof *work.outcomes);
  status = work.outcomes ? prepare_sides(&work) : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK)
    status = lay_all(&work);
  if (status == CONIC_OK) {
    hand_out_sides(&work);
    take_clipped_away(patches);
    reach_splats(patches);
    for (size_t i = 2 * patches->surface->tree.n_leaves - 1; i-- > 0;)
      bound_node(patches, i);
    report_patches(patches, work.outcomes);
  }
  conic_patch_mesh_release(context, &work.mesh);
  conic_memory_release_these(context, work.outcomes, work.first_sides, work.is_laid);
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
  if (status == CONIC_OK && options->mesh)
    status = conic_triangles_check_own(context, "patches", options->mesh);
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
  made->options.mesh = NULL; /* the caller's */
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
  conic_memory_release_these(context, patches->block, patches->patches, patches->sides, patches->fences,
                             patches->side_of_point);
  conic_patches_release_frames(patches);
  conic_memory_release_these(context, patches->counts, patches->node_reach, patches->node_radius, patches);
}

void conic_patches_describe(const conic_patches *patches, conic_patches_report *report) {
  *report = patches->report;
}
