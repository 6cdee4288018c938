#include "lod/octree_fit.h"

#include <math.h>
#include <string.h>

#include "core/eigen.h"
#include "core/ellipse.h"
#include "core/memory.h"
#include "core/message.h"
#include "core/threads.h"

/* Subtrees up to this size are fitted side by side; the leaves of the nodes above are scanned in such chunks. */
static const size_t task_leaves = 32768, chunk_leaves = 8192;

/* Up to so many leaves a node's error is found from them, beyond from its children and their errors. */
enum { DIRECT_LEAVES = 16 };

/* Ellipses may be narrower than a splat that is estimated (core/estimate.h), for they bound and do not guess. */
static const double least_ratio = 0.1;

/* What a node hands to the one above. */
typedef struct fitted {
  conic_moments moments;
  conic_octree_disc disc;
} fitted;

typedef struct fit_task {
  uint32_t i_node;
  fitted result;
} fit_task;

typedef struct fitter {
  conic_octree *octree;
  conic_disc_samples samples;
  fit_task *tasks;
  size_t n_tasks, next_task;
} fitter;

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* In the plane, stretched so that the node's ellipse is a circle: the leaf's centre, and its outline's greatest half
 * axis, which is the greater singular value. */
static void add_reach(double x, double y, const double u[2], const double v[2], double cutoff,
                      conic_leaf_reach *reach) {
  double square = x * x + y * y, sum = u[0] * u[0] + u[1] * u[1] + v[0] * v[0] + v[1] * v[1];
  if (2.0 * (square + cutoff * cutoff * sum) <= reach->reach * reach->reach)
    return; /* well inside: (a + b)² ≤ 2(a² + b²) */
  double determinant = u[0] * v[1] - u[1] * v[0], discriminant = sum * sum - 4.0 * determinant * determinant;
  double major = sqrt(0.5 * (sum + sqrt(discriminant > 0.0 ? discriminant : 0.0)));
  double out = sqrt(square) + cutoff * major;
  reach->reach = out > reach->reach ? out : reach->reach;
}

static void add_radius(const double p[3], const double u[3], const double v[3], double cutoff,
                       conic_leaf_reach *reach) {
  double square = dot(p, p), uu = dot(u, u), vv = dot(v, v);
  if (2.0 * (square + cutoff * cutoff * (uu + vv)) <= reach->radius * reach->radius)
    return;
  double uv = dot(u, v), longest2 = 0.5 * (uu + vv + sqrt((uu - vv) * (uu - vv) + 4.0 * uv * uv));
  double radius = sqrt(square) + cutoff * sqrt(longest2);
  reach->radius = radius > reach->radius ? radius : reach->radius;
}

static void add_height(double z, double uz, double vz, double cutoff, conic_leaf_reach *reach) {
  double square = cutoff * cutoff * (uz * uz + vz * vz);
  if (2.0 * (z * z + square) <= reach->height * reach->height)
    return;
  double height = fabs(z) + sqrt(square);
  reach->height = height > reach->height ? height : reach->height;
}

static void add_normal(const double u[3], const double v[3], const double n[3], conic_leaf_reach *reach) {
  const double normal[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
  double along = dot(normal, n), square = dot(normal, normal);
  if (along > 0.0 && along * along > square * reach->cosine * fabs(reach->cosine))
    return;
  double cosine = along / sqrt(square);
  reach->cosine = cosine < reach->cosine ? cosine : reach->cosine;
}

void conic_leaf_reach_add(const conic_splats *leaves, size_t begin, size_t end, double cutoff,
                          const conic_node_frame *frame, conic_leaf_reach *reach) {
  const double across = 1.0 / frame->ratio;
  for (size_t i = begin; i < end; i++) {
    double p[3], u[3], v[3];
    for (int axis = 0; axis < 3; axis++) {
      p[axis] = (double)leaves->position[axis][i] - frame->position[axis];
      u[axis] = (double)leaves->tangent_u[axis][i];
      v[axis] = (double)leaves->tangent_v[axis][i];
    }
    const double flat_u[2] = {dot(u, frame->u), dot(u, frame->v) * across};
    const double flat_v[2] = {dot(v, frame->u), dot(v, frame->v) * across};
    add_reach(dot(p, frame->u), dot(p, frame->v) * across, flat_u, flat_v, cutoff, reach);
    add_radius(p, u, v, cutoff, reach);
    add_height(dot(p, frame->n), dot(u, frame->n), dot(v, frame->n), cutoff, reach);
    add_normal(u, v, frame->n, reach);
  }
}

typedef struct scan {
  const conic_octree *octree;
  const conic_node_frame *frame;
  size_t begin, end;
  conic_leaf_reach *chunks;
} scan;

static void scan_chunk(void *data, size_t i_chunk, int i_thread) {
  const scan *s = data;
  size_t begin = s->begin + i_chunk * chunk_leaves, end = begin + chunk_leaves < s->end ? begin + chunk_leaves : s->end;
  (void)i_thread;
  memset(&s->chunks[i_chunk], 0, sizeof *s->chunks);
  s->chunks[i_chunk].cosine = 1.0;
  conic_leaf_reach_add(&s->octree->leaves, begin, end, s->octree->scale.cutoff, s->frame, &s->chunks[i_chunk]);
}

/* The same for many leaves: chunk by chunk, side by side. Greatest and least do not ask for an order. */
static conic_status scan_leaves(const conic_octree *octree, size_t begin, size_t end, const conic_node_frame *frame,
                                conic_leaf_reach *reach) {
  size_t n_chunks = (end - begin + chunk_leaves - 1) / chunk_leaves;
  scan s = {octree, frame, begin, end, NULL};
  s.chunks = conic_memory_allocate(octree->context, n_chunks, sizeof *s.chunks);
  if (!s.chunks)
    return CONIC_ERROR_MEMORY;
  conic_parallel_for(octree->context, n_chunks, scan_chunk, &s);
  for (size_t i = 0; i < n_chunks; i++) {
    const conic_leaf_reach *more = &s.chunks[i];
    reach->reach = more->reach > reach->reach ? more->reach : reach->reach;
    reach->radius = more->radius > reach->radius ? more->radius : reach->radius;
    reach->height = more->height > reach->height ? more->height : reach->height;
    reach->cosine = more->cosine < reach->cosine ? more->cosine : reach->cosine;
  }
  conic_memory_release(octree->context, s.chunks);
  return CONIC_OK;
}

/* The mean normal, weighed by area; where normals cancel, the direction in which the points spread least. */
static void find_normal(const conic_moments *moments, double normal[3]) {
  double values[3], vectors[3][3];
  if (dot(moments->normal, moments->normal) > 1e-4 * moments->area * moments->area) {
    memcpy(normal, moments->normal, 3 * sizeof *normal);
    return;
  }
  conic_eigen3(moments->scatter, values, vectors);
  memcpy(normal, vectors[2], 3 * sizeof *normal);
}

static double quadratic(const double m[6], const double a[3], const double b[3]) {
  return a[0] * (m[0] * b[0] + m[1] * b[1] + m[2] * b[2]) + a[1] * (m[1] * b[0] + m[3] * b[1] + m[4] * b[2]) +
         a[2] * (m[2] * b[0] + m[4] * b[1] + m[5] * b[2]);
}

/* Where the node is, and how its ellipse lies: the covariance in the tangent plane (Confetti Eq. 3, §4.3). */
static void choose_frame(const conic_octree *octree, const conic_moments *moments, const double first[3], uint8_t *code,
                         conic_node_frame *frame) {
  double normal[3], u[3], v[3], n[3];
  find_normal(moments, normal);
  conic_code_place(&octree->scale, moments->mean, first, code);
  conic_code_facing(normal, code);
  conic_code_basis(code, u, v, n);
  const double covariance[3] = {quadratic(moments->scatter, u, u), quadratic(moments->scatter, u, v),
                                quadratic(moments->scatter, v, v)};
  conic_ellipse shape = conic_ellipse_shape(covariance, least_ratio);
  conic_code_axes(shape.major[0], shape.major[1], shape.ratio, code);
  conic_code_frame(&octree->scale, first, code, frame);
}

static void choose_color(const conic_octree *octree, const conic_moments *moments, double reach, double ratio,
                         uint8_t *code) {
  double color[3], major = reach / octree->scale.cutoff, opacity = moments->weight / (major * major * ratio);
  for (int channel = 0; channel < 3; channel++)
    color[channel] = moments->weight > 0.0 ? moments->color[channel] / moments->weight : 0.0;
  conic_code_color(&octree->scale, color, opacity, code);
}

static conic_octree_disc leaf_disc(const conic_octree *octree, size_t i) {
  conic_octree_disc disc = {.error = 0.0};
  for (int axis = 0; axis < 3; axis++) {
    disc.center[axis] = (double)octree->leaves.position[axis][i];
    disc.u[axis] = octree->scale.cutoff * (double)octree->leaves.tangent_u[axis][i];
    disc.v[axis] = octree->scale.cutoff * (double)octree->leaves.tangent_v[axis][i];
  }
  if (conic_octree_clip(octree, i)) /* what is left of it may be at its other end */
    disc.error = 2.0 * sqrt(dot(disc.u, disc.u) + dot(disc.v, disc.v));
  return disc;
}

static conic_octree_disc node_disc(const conic_node_frame *frame, double reach, double error) {
  conic_octree_disc disc = {.error = error};
  for (int axis = 0; axis < 3; axis++) {
    disc.center[axis] = frame->position[axis];
    disc.u[axis] = reach * frame->u[axis];
    disc.v[axis] = reach * frame->ratio * frame->v[axis];
  }
  return disc;
}

/* Fits node i to what its children are: `parts` has their discs, `moments` their sums. */
static conic_status fit_node(const fitter *f, size_t i, conic_octree_disc *parts, int n_parts, fitted *node) {
  const conic_octree *octree = f->octree;
  size_t begin = octree->first_leaf[i], end = octree->first_leaf[octree->end[i]];
  uint8_t *code = octree->codes + i * CONIC_NODE_BYTES;
  conic_node_frame frame;
  conic_leaf_reach reach = {.cosine = 1.0};
  double first[3];
  conic_status status = CONIC_OK;
  conic_octree_place(octree, begin, first);
  choose_frame(octree, &node->moments, first, code, &frame);
  if (end - begin > task_leaves)
    status = scan_leaves(octree, begin, end, &frame, &reach);
  else
    conic_leaf_reach_add(&octree->leaves, begin, end, octree->scale.cutoff, &frame, &reach);
  const double hair = 1.0 + 1e-6; /* axes and radii are floats when they are used */
  double major = reach.reach * hair, radius = (reach.radius > major ? reach.radius : major) * hair;
  conic_code_extent(&octree->scale, &major, &radius, code);
  conic_code_cone(reach.cosine - 1e-6, code);
  choose_color(octree, &node->moments, major, frame.ratio, code);
  if (end - begin <= DIRECT_LEAVES)
    for (n_parts = 0; n_parts < (int)(end - begin); n_parts++)
      parts[n_parts] = leaf_disc(octree, begin + (size_t)n_parts);
  double error = conic_octree_overshoot(&f->samples, &frame, major, parts, n_parts);
  /* Twice the height, since a neighbour may be as far off to the other side: what gapes between them is the error. */
  error = error > 2.0 * reach.height * hair ? error : 2.0 * reach.height * hair;
  node->disc = node_disc(&frame, major, conic_code_error(&octree->scale, error, radius, code));
  return status;
}

static conic_status fit_top(fitter *f, size_t i, fitted *node);

static conic_status fit_subtree(fitter *f, size_t i, int is_top, fitted *node) {
  const conic_octree *octree = f->octree;
  conic_octree_disc parts[DIRECT_LEAVES];
  conic_status status = CONIC_OK;
  int n_parts = 0;
  memset(&node->moments, 0, sizeof node->moments);
  for (; n_parts < conic_octree_n_direct(octree, i); n_parts++) {
    conic_moments leaf;
    conic_moments_of_splat(&octree->leaves, octree->first_leaf[i] + (size_t)n_parts, &leaf);
    conic_moments_merge(&node->moments, &leaf);
    parts[n_parts] = leaf_disc(octree, octree->first_leaf[i] + (size_t)n_parts);
  }
  for (size_t child = i + 1; child < octree->end[i] && status == CONIC_OK; child = octree->end[child]) {
    fitted below;
    status = is_top ? fit_top(f, child, &below) : fit_subtree(f, child, 0, &below);
    if (status == CONIC_OK) {
      conic_moments_merge(&node->moments, &below.moments);
      parts[n_parts++] = below.disc;
    }
  }
  return status == CONIC_OK ? fit_node(f, i, parts, n_parts, node) : status;
}

static int is_task(const conic_octree *octree, size_t i) {
  return octree->first_leaf[octree->end[i]] - octree->first_leaf[i] <= task_leaves;
}

/* Nodes above the tasks, in the same order as those were listed. */
static conic_status fit_top(fitter *f, size_t i, fitted *node) {
  if (is_task(f->octree, i)) {
    *node = f->tasks[f->next_task++].result;
    return CONIC_OK;
  }
  return fit_subtree(f, i, 1, node);
}

static void run_task(void *data, size_t i_task, int i_thread) {
  fitter *f = data;
  (void)i_thread;
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

conic_status conic_octree_fit(conic_octree *octree) {
  fitter f = {.octree = octree};
  fitted root;
  if (octree->n_nodes == 0)
    return CONIC_OK;
  f.n_tasks = list_tasks(octree, NULL);
  f.tasks = conic_memory_allocate(octree->context, f.n_tasks, sizeof *f.tasks);
  if (!f.tasks)
    return CONIC_ERROR_MEMORY;
  list_tasks(octree, f.tasks);
  conic_disc_samples_init(&f.samples);
  conic_status status = conic_progress(octree->context, "octree", 0.4);
  if (status == CONIC_OK) {
    conic_parallel_for(octree->context, f.n_tasks, run_task, &f);
    status = fit_top(&f, 0, &root);
  }
  conic_memory_release(octree->context, f.tasks);
  return status == CONIC_OK ? conic_progress(octree->context, "octree", 1.0) : status;
}
