#include "lod/octree/octree_fit.h"

#include "core/base/eigen.h"
#include "core/base/team_runs.h"
#include "core/base/vectors.h"
#include "lod/octree/octree_loops.h"

/* --- sums over splats: the generic homogeneous covariance of Confetti (§4.2), and averages --- */

void conic_moments_of_splat(const conic_splats *splats, size_t i, conic_moments *moments) {
  double u[3], v[3];
  memset(moments, 0, sizeof *moments);
  moments->count = 1.0;
  conic_vector_at(splats->position, i, moments->mean);
  conic_vector_at(splats->tangent_u, i, u);
  conic_vector_at(splats->tangent_v, i, v);
  conic_cross(u, v, moments->normal);
  conic_add_outer(moments->scatter, u, u);
  conic_add_outer(moments->scatter, v, v);
  double opacity = splats->opacity ? (double)splats->opacity[i] : 1.0;
  moments->area = conic_length(moments->normal);
  moments->weight = opacity > 0.0 ? opacity * moments->area : 0.0;
  for (int axis = 0; axis < 3; axis++)
    moments->color[axis] = moments->weight * (splats->color[axis] ? (double)splats->color[axis][i] : 1.0);
}

void conic_moments_merge(conic_moments *sum, const conic_moments *more) {
  double apart[3], pulled[3], count = sum->count + more->count;
  if (sum->count == 0.0) {
    *sum = *more;
    return;
  }
  /* Both translated to the mean of the union: the outer product of what parts the means. */
  for (int axis = 0; axis < 3; axis++) {
    apart[axis] = more->mean[axis] - sum->mean[axis];
    pulled[axis] = apart[axis] * (sum->count * more->count / count);
    sum->mean[axis] += apart[axis] * (more->count / count);
    sum->normal[axis] += more->normal[axis];
    sum->color[axis] += more->color[axis];
  }
  for (int i = 0; i < 6; i++)
    sum->scatter[i] += more->scatter[i];
  conic_add_outer(sum->scatter, apart, pulled);
  sum->count = count;
  sum->area += more->area;
  sum->weight += more->weight;
}

/* Subtrees up to this size are fitted side by side; the leaves of the nodes above are scanned in such chunks. */
static const size_t task_leaves = 32768, chunk_leaves = 8192;

/* A node's error is so many times the height of its leaves' outlines over its plane, and so much of its size. */
static const double height_weight = 2.0, size_weight = 0.25;

typedef struct fit_task {
  uint32_t i_node;
  conic_moments result;
} fit_task;

typedef struct fitter {
  conic_octree *octree;
  fit_task *tasks;
  size_t n_tasks, next_task;
  conic_octree_loops loops;
} fitter;

typedef struct scan {
  const fitter *fitter;
  const conic_node_frame *frame;
  size_t begin, end;
  conic_leaf_reach *chunks;
} scan;

static void scan_chunk(void *data, size_t i_chunk) {
  const scan *s = data;
  size_t begin = s->begin + i_chunk * chunk_leaves, end = begin + chunk_leaves < s->end ? begin + chunk_leaves : s->end;
  memset(&s->chunks[i_chunk], 0, sizeof *s->chunks);
  s->chunks[i_chunk].cosine = 1.0;
  s->fitter->loops.add_reach(&s->fitter->octree->leaves, begin, end, s->fitter->octree->scale.cutoff, s->frame,
                             &s->chunks[i_chunk]);
}

/* The same for many leaves: chunk by chunk, side by side. Greatest and least do not ask for an order. */
static conic_status scan_leaves(const fitter *f, size_t begin, size_t end, const conic_node_frame *frame,
                                conic_leaf_reach *reach) {
  size_t n_chunks = (end - begin + chunk_leaves - 1) / chunk_leaves;
  conic_context *context = f->octree->context;
  scan s = {f, frame, begin, end, NULL};
  conic_status status = conic_progress(context, "octree", 0.6);
  if (status != CONIC_OK)
    return status;
  s.chunks = conic_memory_allocate(context, n_chunks, sizeof *s.chunks);
  if (!s.chunks)
    return CONIC_ERROR_MEMORY;
  conic_parallel_for(context, n_chunks, scan_chunk, &s);
  for (size_t i = 0; i < n_chunks; i++) {
    const conic_leaf_reach *more = &s.chunks[i];
    reach->reach = more->reach > reach->reach ? more->reach : reach->reach;
    reach->radius = more->radius > reach->radius ? more->radius : reach->radius;
    reach->height = more->height > reach->height ? more->height : reach->height;
    reach->cosine = more->cosine < reach->cosine ? more->cosine : reach->cosine;
  }
  conic_memory_release(context, s.chunks);
  return CONIC_OK;
}

/* Widens the reach by the dots among the leaves. A dot is a ball to its node, for it faces every camera, and it leans
 * until it is twice as long in depth, which only the sphere has to hold. No cone of normals holds those of a dot: one
 * of half a turn keeps its node from being culled, and from counting for less where it is seen from its side. */
static void add_dots(const conic_octree *octree, size_t begin, size_t end, const conic_node_frame *frame,
                     conic_leaf_reach *reach) {
  const conic_splats *leaves = &octree->leaves;
  for (size_t i = begin; i < end; i++) {
    double p[3], radius = conic_octree_dot_radius(octree, i);
    if (radius == 0.0)
      continue;
    conic_vector_at(leaves->position, i, p);
    conic_subtract(p, frame->position, p);
    double x = conic_dot(p, frame->u), y = conic_dot(p, frame->v), z = conic_dot(p, frame->n);
    reach->reach = fmax(reach->reach, sqrt(x * x + y * y / (frame->ratio * frame->ratio)) + radius / frame->ratio);
    reach->radius = fmax(reach->radius, conic_length(p) + 2.0 * radius);
    reach->height = fmax(reach->height, fabs(z) + radius);
    reach->cosine = fmin(reach->cosine, 0.0);
  }
}

void conic_moments_facing(const conic_moments *moments, double normal[3]) {
  double values[3], vectors[3][3];
  if (conic_dot(moments->normal, moments->normal) > 1e-4 * moments->area * moments->area) {
    memcpy(normal, moments->normal, 3 * sizeof *normal);
    return;
  }
  conic_eigen3(moments->scatter, values, vectors);
  memcpy(normal, vectors[2], 3 * sizeof *normal);
}

conic_ellipse conic_moments_shape(const conic_moments *moments, const double u[3], const double v[3]) {
  const double covariance[3] = {conic_quadratic_form(moments->scatter, u, u),
                                conic_quadratic_form(moments->scatter, u, v),
                                conic_quadratic_form(moments->scatter, v, v)};
  return conic_ellipse_shape(covariance, CONIC_LEAST_NODE_RATIO);
}

/* Where the node is, and how its ellipse lies: the covariance in the tangent plane (Confetti Eq. 3, §4.3). */
static void choose_frame(const fitter *f, const conic_moments *moments, size_t begin, size_t end, uint8_t *code,
                         conic_node_frame *frame) {
  const conic_octree *octree = f->octree;
  double normal[3], u[3], v[3], n[3], first[3];
  conic_vector_at(octree->leaves.position, begin, first);
  conic_moments_facing(moments, normal);
  conic_code_place(&octree->scale, moments->mean, first, code);
  conic_code_facing(normal, code);
  conic_code_basis(code, u, v, n);
  conic_ellipse shape = conic_moments_shape(moments, u, v);
  if (end - begin <= CONIC_FEW_LEAVES)
    shape.ratio = f->loops.choose_ratio(&octree->leaves, begin, end, octree->scale.cutoff, moments->mean, u, v, &shape,
                                        CONIC_LEAST_NODE_RATIO);
  conic_code_axes(shape.major[0], shape.major[1], shape.ratio, code);
  conic_code_frame_in(&octree->scale, first, code, u, v, n, frame);
}

static void choose_color(const conic_octree *octree, const conic_moments *moments, double reach, double ratio,
                         uint8_t *code) {
  double color[3], major = reach / octree->scale.cutoff, opacity = moments->weight / (major * major * ratio);
  for (int channel = 0; channel < 3; channel++)
    color[channel] = moments->weight > 0.0 ? moments->color[channel] / moments->weight : 0.0;
  conic_code_color(&octree->scale, color, opacity, code);
}

/* Fits node i to its leaves, whose sums these are. */
static conic_status fit_node(const fitter *f, size_t i, const conic_moments *moments) {
  const conic_octree *octree = f->octree;
  size_t begin = octree->first_leaf[i], end = octree->first_leaf[octree->end[i]];
  uint8_t *code = octree->codes + i * CONIC_NODE_BYTES;
  conic_node_frame frame;
  conic_leaf_reach reach = {.cosine = 1.0};
  conic_status status = CONIC_OK;
  choose_frame(f, moments, begin, end, code, &frame);
  if (end - begin > task_leaves)
    status = scan_leaves(f, begin, end, &frame, &reach);
  else
    f->loops.add_reach(&octree->leaves, begin, end, octree->scale.cutoff, &frame, &reach);
  if (octree->leaves.dot)
    add_dots(octree, begin, end, &frame, &reach);
  const double hair = 1.0 + 1e-6; /* axes and radii are floats when they are used */
  double major = reach.reach * hair, radius = (reach.radius > major ? reach.radius : major) * hair;
  conic_code_extent(&octree->scale, &major, &radius, code);
  conic_code_cone(reach.cosine - 1e-6, code);
  choose_color(octree, moments, major, frame.ratio, code);
  double by_height = height_weight * reach.height * hair, by_size = size_weight * major * hair;
  conic_code_error(&octree->scale, by_height > by_size ? by_height : by_size, radius, code);
  return status;
}

static conic_status fit_top(fitter *f, size_t i, conic_moments *moments);

static conic_status fit_subtree(fitter *f, size_t i, int is_top, conic_moments *moments) {
  const conic_octree *octree = f->octree;
  conic_status status = CONIC_OK;
  memset(moments, 0, sizeof *moments);
  for (int k = 0; k < conic_octree_n_direct(octree, i); k++) {
    conic_moments leaf;
    conic_moments_of_splat(&octree->leaves, octree->first_leaf[i] + (size_t)k, &leaf);
    conic_moments_merge(moments, &leaf);
  }
  for (size_t child = i + 1; child < octree->end[i] && status == CONIC_OK; child = octree->end[child]) {
    conic_moments below;
    status = is_top ? fit_top(f, child, &below) : fit_subtree(f, child, 0, &below);
    if (status == CONIC_OK)
      conic_moments_merge(moments, &below);
  }
  return status == CONIC_OK ? fit_node(f, i, moments) : status;
}

static int is_task(const conic_octree *octree, size_t i) {
  return octree->first_leaf[octree->end[i]] - octree->first_leaf[i] <= task_leaves;
}

/* Nodes above the tasks, in the same order as those were listed. */
static conic_status fit_top(fitter *f, size_t i, conic_moments *moments) {
  if (is_task(f->octree, i)) {
    *moments = f->tasks[f->next_task++].result;
    return CONIC_OK;
  }
  return fit_subtree(f, i, 1, moments);
}

static void run_task(void *data, size_t i_task) {
  fitter *f = data;
  fit_subtree(f, f->tasks[i_task].i_node, 0, &f->tasks[i_task].result); /* too small to allocate, so it cannot fail */
}

/* Counts the tasks, or lists them. */
static size_t list_tasks(const conic_octree *octree, fit_task *tasks) {
  size_t n = 0;
  for (size_t i = 0; i < octree->n_nodes;)
    if (is_task(octree, i)) {
      if (tasks)
        tasks[n].i_node = (uint32_t)i;
      n++;
      i = octree->end[i];
    } else
      i++;
  return n;
}

static size_t first_node_of_fit(const void *data, size_t i_task) {
  const fitter *f = data;
  return i_task < f->n_tasks ? f->tasks[i_task].i_node : f->octree->n_nodes;
}

conic_status conic_octree_fit(conic_octree *octree) {
  fitter f = {.octree = octree};
  conic_moments root;
  conic_isa isa;
  conic_status status = conic_isa_choose(octree->context, CONIC_ISA_AUTO, &isa);
  if (status != CONIC_OK || octree->n_nodes == 0)
    return status;
  conic_octree_loops_init(&f.loops, isa);
  f.n_tasks = list_tasks(octree, NULL);
  f.tasks = conic_memory_allocate(octree->context, f.n_tasks, sizeof *f.tasks);
  if (!f.tasks)
    return CONIC_ERROR_MEMORY;
  list_tasks(octree, f.tasks);
  conic_team_loop loop = {"octree", 0.4, 0.6, f.n_tasks, 0, CONIC_TASK(run_task), &f, .first_of = first_node_of_fit};
  loop.columns[0] = (conic_team_column){octree->codes, CONIC_NODE_BYTES};
  loop.columns[1] = (conic_team_column){f.tasks, sizeof *f.tasks, .is_by_item = 1};
  status = conic_team_runs(octree->context, &loop);
  if (status == CONIC_OK)
    status = fit_top(&f, 0, &root);
  conic_memory_release(octree->context, f.tasks);
  if (status == CONIC_OK)
    status = conic_octree_find_errors(octree);
  return status == CONIC_OK ? conic_progress(octree->context, "octree", 1.0) : status;
}
