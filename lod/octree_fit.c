#include "lod/octree_fit.h"

#include <math.h>
#include <string.h>

#include "core/eigen.h"
#include "core/ellipse.h"
#include "core/memory.h"
#include "core/message.h"
#include "core/threads.h"
#include "lod/octree_kernels.h"
#include "raster/lanes.h"

/* Subtrees up to this size are fitted side by side; the leaves of the nodes above are scanned in such chunks. */
static const size_t task_leaves = 32768, chunk_leaves = 8192;

/* An outline is held by the polygon of 16 corners around it: eight, and eight opposite. */
enum { CORNERS = 8 };
static const double corners_x[CORNERS] = {
    1.0195911582083184,  0.9419794021690183,  0.7209598220069479, 0.3901806440322565, 0.0,
    -0.3901806440322565, -0.7209598220069479, -0.9419794021690183};
static const double corners_y[CORNERS] = {0.0,
                                          0.3901806440322565,
                                          0.7209598220069479,
                                          0.9419794021690183,
                                          1.0195911582083184,
                                          0.9419794021690183,
                                          0.7209598220069479,
                                          0.3901806440322565};

/* Up to so many leaves, ratios are tried: the more there are, the better the covariance's fits. */
enum { FEW_LEAVES = 16 };

/* A node's error is so many times the height of its leaves' outlines over its plane, and so much of its size. */
static const double height_weight = 2.0, size_weight = 0.25;

/* Ellipses may be narrower than a splat that is estimated (core/estimate.h), for they bound and do not guess. */
static const double least_ratio = 0.1;

typedef struct fit_task {
  uint32_t i_node;
  conic_moments result;
} fit_task;

typedef struct fitter {
  conic_octree *octree;
  fit_task *tasks;
  size_t n_tasks, next_task;
} fitter;

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* In the plane, stretched so that the node's ellipse is a circle: how far the leaf's outline is from the middle. */
static void add_reach(double x, double y, const double u[2], const double v[2], double cutoff,
                      conic_leaf_reach *reach) {
  double square = x * x + y * y, sum = u[0] * u[0] + u[1] * u[1] + v[0] * v[0] + v[1] * v[1], greatest2 = 0.0;
  if (2.0 * (square + cutoff * cutoff * sum) <= reach->reach * reach->reach)
    return;             /* well inside: (a + b)² ≤ 2(a² + b²) */
  double out2[CORNERS]; /* all at once: compilers take them two by two */
  for (int k = 0; k < CORNERS; k++) {
    double a = cutoff * (corners_x[k] * u[0] + corners_y[k] * v[0]);
    double b = cutoff * (corners_x[k] * u[1] + corners_y[k] * v[1]);
    out2[k] = square + (a * a + b * b) + 2.0 * fabs(a * x + b * y);
  }
  for (int k = 0; k < CORNERS; k++)
    greatest2 = out2[k] > greatest2 ? out2[k] : greatest2;
  if (greatest2 > reach->reach * reach->reach)
    reach->reach = sqrt(greatest2);
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

static void add_leaf(const conic_splats *leaves, size_t i, double cutoff, const conic_node_frame *frame,
                     conic_leaf_reach *reach) {
  const double across = 1.0 / frame->ratio;
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

void conic_leaf_reach_add(const conic_splats *leaves, size_t begin, size_t end, double cutoff,
                          const conic_node_frame *frame, conic_leaf_reach *reach) {
  const conic_octree_kernels kernels = conic_octree_kernels_choose();
  size_t i = begin;
  for (; end - i >= CONIC_INSIDE_BATCH; i += CONIC_INSIDE_BATCH) {
    unsigned inside = kernels.find_inside(leaves, i, cutoff, frame, reach);
    for (unsigned k = 0; k < CONIC_INSIDE_BATCH; k++)
      if ((inside >> k & 1u) == 0)
        add_leaf(leaves, i + k, cutoff, frame, reach);
  }
  for (; i < end; i++)
    add_leaf(leaves, i, cutoff, frame, reach);
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

/* The greatest square of a corner's distance, across the axis stretched. */
static float greatest_reach2(const float *x2, const float *y2, int n, float across2) {
  lanes greatest = lanes_of(0.0f);
  float all[CONIC_LANES];
  for (int i = 0; i < n; i += CONIC_LANES)
    greatest = lanes_max(lanes_load(x2 + i) + lanes_load(y2 + i) * across2, greatest);
  lanes_store(all, greatest);
  for (int k = 1; k < CONIC_LANES; k++)
    all[0] = all[k] > all[0] ? all[k] : all[0];
  return all[0];
}

/* The ratio whose ellipse around the outlines of a few leaves is the smallest: those near the covariance's are tried.
 * `major` is the direction of the longer axis in u, v. */
static double choose_ratio(const conic_octree *octree, size_t begin, size_t end, const double place[3],
                           const double u[3], const double v[3], const conic_ellipse *shape) {
  enum { N_RATIOS = 9 };
  static const double factors[N_RATIOS] = {0.5, 0.59, 0.68, 0.77, 0.86, 1.0, 1.15, 1.3, 1.5};
  const double cutoff = octree->scale.cutoff;
  float x2[2 * CORNERS * FEW_LEAVES], y2[2 * CORNERS * FEW_LEAVES], best_area = HUGE_VALF;
  double best = shape->ratio;
  int n = 0;
  for (size_t i = begin; i < end; i++) {
    double flat[3][2];
    for (int part = 0; part < 3; part++) {
      double vector[3];
      for (int axis = 0; axis < 3; axis++)
        vector[axis] = part == 0   ? (double)octree->leaves.position[axis][i] - place[axis]
                       : part == 1 ? (double)octree->leaves.tangent_u[axis][i]
                                   : (double)octree->leaves.tangent_v[axis][i];
      double along_u = dot(vector, u), along_v = dot(vector, v);
      flat[part][0] = shape->major[0] * along_u + shape->major[1] * along_v;
      flat[part][1] = shape->major[0] * along_v - shape->major[1] * along_u;
    }
    for (int sign = -1; sign <= 1; sign += 2)
      for (int k = 0; k < CORNERS; k++, n++) {
        double x = flat[0][0] + sign * cutoff * (corners_x[k] * flat[1][0] + corners_y[k] * flat[2][0]);
        double y = flat[0][1] + sign * cutoff * (corners_x[k] * flat[1][1] + corners_y[k] * flat[2][1]);
        x2[n] = (float)(x * x);
        y2[n] = (float)(y * y);
      }
  }
  for (int i = 0; i < N_RATIOS; i++) {
    double ratio = factors[i] * shape->ratio;
    ratio = ratio > 1.0 ? 1.0 : ratio < least_ratio ? least_ratio : ratio;
    float area = (float)ratio * greatest_reach2(x2, y2, n, (float)(1.0 / (ratio * ratio)));
    if (area < best_area) {
      best_area = area;
      best = ratio;
    }
  }
  return best;
}

static double quadratic(const double m[6], const double a[3], const double b[3]) {
  return a[0] * (m[0] * b[0] + m[1] * b[1] + m[2] * b[2]) + a[1] * (m[1] * b[0] + m[3] * b[1] + m[4] * b[2]) +
         a[2] * (m[2] * b[0] + m[4] * b[1] + m[5] * b[2]);
}

/* Where the node is, and how its ellipse lies: the covariance in the tangent plane (Confetti Eq. 3, §4.3). */
static void choose_frame(const conic_octree *octree, const conic_moments *moments, size_t begin, size_t end,
                         uint8_t *code, conic_node_frame *frame) {
  double normal[3], u[3], v[3], n[3], first[3];
  conic_octree_place(octree, begin, first);
  find_normal(moments, normal);
  conic_code_place(&octree->scale, moments->mean, first, code);
  conic_code_facing(normal, code);
  conic_code_basis(code, u, v, n);
  const double covariance[3] = {quadratic(moments->scatter, u, u), quadratic(moments->scatter, u, v),
                                quadratic(moments->scatter, v, v)};
  conic_ellipse shape = conic_ellipse_shape(covariance, least_ratio);
  if (end - begin <= FEW_LEAVES)
    shape.ratio = choose_ratio(octree, begin, end, moments->mean, u, v, &shape);
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

/* Fits node i to its leaves, whose sums these are. */
static conic_status fit_node(const conic_octree *octree, size_t i, const conic_moments *moments) {
  size_t begin = octree->first_leaf[i], end = octree->first_leaf[octree->end[i]];
  uint8_t *code = octree->codes + i * CONIC_NODE_BYTES;
  conic_node_frame frame;
  conic_leaf_reach reach = {.cosine = 1.0};
  conic_status status = CONIC_OK;
  choose_frame(octree, moments, begin, end, code, &frame);
  if (end - begin > task_leaves)
    status = scan_leaves(octree, begin, end, &frame, &reach);
  else
    conic_leaf_reach_add(&octree->leaves, begin, end, octree->scale.cutoff, &frame, &reach);
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
  return status == CONIC_OK ? fit_node(octree, i, moments) : status;
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
  conic_moments root;
  if (octree->n_nodes == 0)
    return CONIC_OK;
  f.n_tasks = list_tasks(octree, NULL);
  f.tasks = conic_memory_allocate(octree->context, f.n_tasks, sizeof *f.tasks);
  if (!f.tasks)
    return CONIC_ERROR_MEMORY;
  list_tasks(octree, f.tasks);
  conic_status status = conic_progress(octree->context, "octree", 0.4);
  if (status == CONIC_OK) {
    conic_parallel_for(octree->context, f.n_tasks, run_task, &f);
    status = fit_top(&f, 0, &root);
  }
  conic_memory_release(octree->context, f.tasks);
  if (status == CONIC_OK)
    status = conic_octree_find_errors(octree);
  return status == CONIC_OK ? conic_progress(octree->context, "octree", 1.0) : status;
}
