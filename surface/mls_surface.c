#include "surface/mls_surface.h"

#include "core/base/rank.h"
#include "core/base/team_runs.h"
#include "core/base/vectors.h"
#include "core/splats/columns.h"
#include "surface/loops/weight.h"

/* --- cells of the tree as single samples (PSS §3.4.2) --- */

/* The sums over a node's slots, each weighed by its mass. */
typedef struct node_sums {
  double mass, place[3], normal[3], color[3], h;
} node_sums;

static void add_slot(const conic_surface *surface, size_t slot, node_sums *sums) {
  double mass = (double)surface->mass[slot];
  sums->mass += mass;
  sums->h += mass * (double)surface->h[slot];
  for (int axis = 0; axis < 3; axis++) {
    sums->place[axis] += mass * (double)surface->tree.position[axis][slot];
    sums->normal[axis] += surface->normal[0] ? mass * (double)surface->normal[axis][slot] : 0.0;
    sums->color[axis] += surface->color[0] ? mass * (double)surface->color[axis][slot] : 0.0;
  }
}

static void add_child(const conic_surface_clusters *clusters, size_t i, node_sums *sums) {
  double mass = clusters->mass[i];
  sums->mass += mass;
  sums->h += mass * (double)clusters->h[i];
  for (int axis = 0; axis < 3; axis++) {
    sums->place[axis] += mass * clusters->centroid[i][axis];
    sums->normal[axis] += clusters->normal ? mass * (double)clusters->normal[i][axis] : 0.0;
    sums->color[axis] += clusters->color ? mass * (double)clusters->color[i][axis] : 0.0;
  }
}

static void settle(conic_surface *surface, size_t i, const node_sums *sums) {
  conic_surface_clusters *clusters = &surface->clusters;
  const float *box = surface->tree.boxes[i];
  double share = sums->mass > 0.0 ? 1.0 / sums->mass : 0.0, size2 = 0.0;
  clusters->mass[i] = sums->mass;
  clusters->h[i] = (float)(sums->h * share);
  for (int axis = 0; axis < 3; axis++) {
    double edge = (double)box[3 + axis] - (double)box[axis];
    size2 += edge * edge;
    clusters->centroid[i][axis] = sums->place[axis] * share;
    if (clusters->normal)
      clusters->normal[i][axis] = (float)(sums->normal[axis] * share);
    if (clusters->color)
      clusters->color[i][axis] = (float)(sums->color[axis] * share);
  }
  clusters->size[i] = (float)sqrt(size2);
}

/* Errors: MEMORY. */
static conic_status clusters_create(conic_surface *surface) {
  conic_context *context = surface->context;
  conic_surface_clusters *clusters = &surface->clusters;
  const conic_neighbours *tree = &surface->tree;
  size_t n = 2 * tree->n_leaves - 1;
  clusters->centroid = conic_memory_allocate(context, n, sizeof *clusters->centroid);
  clusters->mass = conic_memory_allocate(context, n, sizeof *clusters->mass);
  clusters->size = conic_memory_allocate(context, n, sizeof *clusters->size);
  clusters->h = conic_memory_allocate(context, n, sizeof *clusters->h);
  if (surface->normal[0])
    clusters->normal = conic_memory_allocate(context, n, sizeof *clusters->normal);
  if (surface->color[0])
    clusters->color = conic_memory_allocate(context, n, sizeof *clusters->color);
  if (!clusters->centroid || !clusters->mass || !clusters->size || !clusters->h ||
      (surface->normal[0] && !clusters->normal) || (surface->color[0] && !clusters->color))
    return CONIC_ERROR_MEMORY;
  for (size_t i = n; i-- > 0;) {
    node_sums sums = {0};
    if (i >= tree->n_leaves - 1) {
      size_t i_leaf = i - (tree->n_leaves - 1), end = conic_neighbours_leaf_begin(tree, i_leaf + 1);
      for (size_t slot = conic_neighbours_leaf_begin(tree, i_leaf); slot < end; slot++)
        add_slot(surface, slot, &sums);
    } else {
      add_child(clusters, 2 * i + 1, &sums);
      add_child(clusters, 2 * i + 2, &sums);
    }
    settle(surface, i, &sums);
  }
  return CONIC_OK;
}

static void clusters_release(conic_surface *surface) {
  conic_surface_clusters *clusters = &surface->clusters;
  conic_memory_release_these(surface->context, clusters->centroid, clusters->mass, clusters->size, clusters->h,
                             clusters->normal, clusters->color);
}

/* --- surfaces --- */

enum { CHUNK = 1024, CHUNKS_A_REPORT = 16 };

CONIC_DEFINE_OPTIONS(conic_surface_options, .degree = 3, .neglect = 2.0, .n_local = 32)

CONIC_DEFINE_NAMES(conic_surface_outcome_name, conic_surface_outcome, CONIC_N_SURFACE_OUTCOMES, "done", "not finite",
                   "too few neighbours", "no minimum", "ill-conditioned")

static conic_status check_surface_options(conic_context *context, const conic_surface_options *o, unsigned fields) {
  if ((unsigned)o->type > CONIC_SURFACE_APSS || (unsigned)o->plane > CONIC_PLANE_FAST ||
      (unsigned)o->weight > CONIC_WEIGHT_FLAT)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "surface: options that were not initialised");
  if (o->degree < 1 || o->degree > CONIC_SURFACE_MAX_DEGREE)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "surface: degree %d is not 1 to %d", o->degree,
                      CONIC_SURFACE_MAX_DEGREE);
  if (!(o->h >= 0.0 && o->h < 1e30) || !(o->neglect >= 1.0 && o->neglect <= 6.0))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "surface: h %g or neglect %g is out of range", o->h, o->neglect);
  if (o->n_local < 6 || o->n_local > 64 || !(o->cluster >= 0.0 && o->cluster <= 1.0))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "surface: n_local %d or cluster %g is out of range", o->n_local,
                      o->cluster);
  if (o->is_sharp && o->cluster > 0.0)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "surface: clusters have no creases");
  if (o->type == CONIC_SURFACE_APSS && !(fields & (CONIC_SPLATS_NORMALS | CONIC_SPLATS_TANGENTS)))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "surface: algebraic spheres need normals");
  return CONIC_OK;
}

void conic_surface_unit_normal(const conic_splats *points, size_t i, double normal[3]) {
  double u[3], v[3];
  for (int axis = 0; axis < 3; axis++) {
    u[axis] = (double)(points->tangent_u[0] ? points->tangent_u : points->normal)[axis][i];
    v[axis] = points->tangent_u[0] ? (double)points->tangent_v[axis][i] : 0.0;
  }
  if (points->tangent_u[0])
    conic_cross(u, v, normal);
  else
    memcpy(normal, u, sizeof u);
  conic_normalize(normal);
}

static conic_status copy_points(conic_context *context, const conic_splats *from, conic_splats *to) {
  unsigned fields = conic_splats_fields(from), kept = fields & CONIC_SPLATS_COLORS;
  if (fields & (CONIC_SPLATS_NORMALS | CONIC_SPLATS_TANGENTS))
    kept |= CONIC_SPLATS_NORMALS;
  conic_status status = conic_splats_allocate(context, from->count, kept, to);
  if (status != CONIC_OK)
    return status;
  memcpy(to->origin, from->origin, sizeof to->origin);
  for (int axis = 0; axis < 3; axis++) {
    memcpy(to->position[axis], from->position[axis], from->count * sizeof(float));
    if (kept & CONIC_SPLATS_COLORS)
      memcpy(to->color[axis], from->color[axis], from->count * sizeof(float));
  }
  for (size_t i = 0; i < from->count && (kept & CONIC_SPLATS_NORMALS); i++) {
    double normal[3];
    conic_surface_unit_normal(from, i, normal);
    for (int axis = 0; axis < 3; axis++)
      to->normal[axis][i] = (float)normal[axis];
  }
  return CONIC_OK;
}

static int allocate_slots(conic_surface *surface) {
  conic_context *context = surface->context;
  const conic_neighbours *tree = &surface->tree;
  size_t n = tree->n_slots;
  surface->h = conic_memory_allocate(context, n, sizeof(float));
  surface->mass = conic_memory_allocate_zeroed(context, n, sizeof(float));
  surface->node_reach = conic_memory_allocate(context, 2 * tree->n_leaves, sizeof(float));
  int is_whole = surface->h && surface->mass && surface->node_reach;
  for (int axis = 0; axis < 3; axis++) {
    if (surface->points.normal[0])
      is_whole &= (surface->normal[axis] = conic_memory_allocate_zeroed(context, n, sizeof(float))) != NULL;
    if (surface->points.color[0])
      is_whole &= (surface->color[axis] = conic_memory_allocate_zeroed(context, n, sizeof(float))) != NULL;
  }
  return is_whole;
}

/* Coincident points are one slot, which has their weight together, and their mean colour and normal. */
static void fill_slots(conic_surface *surface) {
  const conic_neighbours *tree = &surface->tree;
  for (size_t i = 0; i < tree->n_points; i++) {
    uint32_t slot = tree->slot_of_point[i];
    if (slot == CONIC_NO_SLOT)
      continue;
    float share = 1.0f / ++surface->mass[slot];
    for (int axis = 0; axis < 3; axis++) {
      if (surface->normal[axis])
        surface->normal[axis][slot] += (surface->points.normal[axis][i] - surface->normal[axis][slot]) * share;
      if (surface->color[axis])
        surface->color[axis][slot] += (surface->points.color[axis][i] - surface->color[axis][slot]) * share;
    }
  }
}

/* A slot's own scale, with which its n_local-th neighbour lies at the neglect distance. */
static void find_local_h(void *data, size_t i_item) {
  conic_surface *surface = data;
  const conic_neighbours *tree = &surface->tree;
  size_t end = (i_item + 1) * CHUNK < tree->n_slots ? (i_item + 1) * CHUNK : tree->n_slots;
  uint32_t slots[64];
  double distances2[64];
  conic_neighbours_around around = {0};
  for (size_t slot = i_item * CHUNK; slot < end; slot++) {
    size_t n = conic_neighbours_of_slot(tree, slot, (size_t)surface->options.n_local, &around, slots, distances2);
    surface->h[slot] = n ? (float)(sqrt(distances2[n - 1]) / surface->options.neglect) : 0.0f;
  }
}

static void find_median_h(conic_surface *surface) {
  size_t n = surface->tree.n_slots;
  surface->median_h = (double)conic_float_of_rank(surface->h, n, (n - 1) / 2);
}

/* The least float that is at least a double. */
static float float_above(double value) {
  float rounded = (float)value;
  return (double)rounded < value ? rounded * (1.0f + 0x1p-22f) : rounded;
}

static void find_node_reach(conic_surface *surface) {
  const conic_neighbours *tree = &surface->tree;
  for (size_t i = 2 * tree->n_leaves - 1; i-- > 0;) {
    float reach = 0.0f;
    if (i >= tree->n_leaves - 1) {
      size_t i_leaf = i - (tree->n_leaves - 1);
      for (size_t slot = conic_neighbours_leaf_begin(tree, i_leaf);
           slot < conic_neighbours_leaf_begin(tree, i_leaf + 1); slot++) {
        float own = float_above((double)surface->h[slot] * surface->options.neglect);
        reach = own > reach ? own : reach;
      }
    } else {
      float left = surface->node_reach[2 * i + 1], right = surface->node_reach[2 * i + 2];
      reach = left > right ? left : right;
    }
    surface->node_reach[i] = reach;
  }
}

static conic_status find_scales(conic_surface *surface) {
  size_t n = surface->tree.n_slots;
  conic_team_loop loop = conic_team_loop_of("scales", 0.0, 1.0, n, CHUNK, CHUNKS_A_REPORT, find_local_h, surface);
  loop.columns[0] = (conic_team_column){surface->h, sizeof *surface->h};
  conic_status status = CONIC_OK;
  if (surface->options.h > 0.0)
    for (size_t slot = 0; slot < n; slot++)
      surface->h[slot] = (float)surface->options.h;
  else
    status = conic_team_runs(surface->context, &loop);
  if (status == CONIC_OK)
    find_median_h(surface);
  find_node_reach(surface);
  return status;
}

static conic_status prepare_surface(conic_surface *surface, const conic_splats *points) {
  conic_context *context = surface->context;
  conic_status status = copy_points(context, points, &surface->points);
  if (status == CONIC_OK)
    status =
        conic_neighbours_build(context, (const float *const *)surface->points.position, points->count, &surface->tree);
  if (status == CONIC_OK && surface->tree.n_slots == 0)
    status = conic_fail(context, CONIC_ERROR_INPUT, "surface: no point is finite");
  if (status == CONIC_OK && surface->tree.n_slots >= CONIC_CLUSTER_BIT)
    status = conic_fail(context, CONIC_ERROR_ARGUMENT, "surface: more than 2147483648 points");
  if (status == CONIC_OK && !allocate_slots(surface))
    status = CONIC_ERROR_MEMORY;
  if (status != CONIC_OK)
    return status;
  fill_slots(surface);
  status = find_scales(surface);
  if (status == CONIC_OK && surface->options.cluster > 0.0)
    status = clusters_create(surface);
  if (status == CONIC_OK && surface->options.is_sharp)
    status = conic_creases_find(surface);
  return status;
}

conic_status conic_surface_create(conic_context *context, const conic_splats *points,
                                  const conic_surface_options *given, conic_surface **surface) {
  conic_surface_options own, *options = &own;
  *surface = NULL;
  conic_surface_options_init(options);
  if ((given && !conic_options_take(options, given)) || !conic_is_zero(own.reserved, sizeof own.reserved))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "surface: the options were not initialised");
  conic_status status = conic_splats_check(context, "surface", points);
  if (status == CONIC_OK)
    status = check_surface_options(context, options, conic_splats_fields(points));
  if (status != CONIC_OK)
    return status;
  conic_isa isa;
  status = conic_isa_choose(context, options->isa, &isa);
  if (status != CONIC_OK)
    return status;
  conic_surface *made = conic_memory_allocate_zeroed(context, 1, sizeof *made);
  if (!made)
    return CONIC_ERROR_MEMORY;
  made->context = context;
  made->options = *options;
  conic_surface_loops_init(&made->loops, isa);
  made->weighing.weight = options->weight;
  made->weighing.end = options->neglect * options->neglect;
  made->weighing.edge = conic_weight_exp(made->weighing.end);
  conic_splats close;
  float *block;
  status = conic_splats_enter(context, "surface", points, &close, &block);
  if (status == CONIC_OK)
    status = prepare_surface(made, &close);
  conic_memory_release(context, block);
  if (status == CONIC_OK)
    *surface = made;
  else
    conic_surface_destroy(made);
  return status;
}

void conic_surface_destroy(conic_surface *surface) {
  if (!surface)
    return;
  conic_context *context = surface->context;
  clusters_release(surface);
  conic_creases_release(surface);
  for (int axis = 0; axis < 3; axis++)
    conic_memory_release_these(context, surface->normal[axis], surface->color[axis]);
  conic_memory_release_these(context, surface->node_reach, surface->mass, surface->h);
  conic_neighbours_release(context, &surface->tree);
  conic_splats_release(context, &surface->points);
  conic_memory_release(context, surface);
}

double conic_surface_scale(const conic_surface *surface, const double r[3]) {
  uint32_t slot;
  double distance2;
  if (surface->options.h > 0.0)
    return surface->options.h;
  conic_neighbours_nearest(&surface->tree, r, CONIC_NO_SLOT, 1, HUGE_VAL, &slot, &distance2);
  return (double)surface->h[slot];
}
