/* Keeps a mesh's splats at the mesh. An ellipse in a vertex's tangent plane leaves the surface where that bends or
 * ends. Where this could be seen, the vertex becomes one splat for each of its triangles, in the triangle's plane and
 * clipped at the two edges that meet there. */

#include "core/base/triangle_distance.h"
#include "core/base/vectors.h"
#include "core/estimate/estimate.h"
#include "core/estimate/incidence.h"
#include "core/splats/ellipse.h"
#include "core/splats/splats_gather.h"

/* How far a splat may stand out, as a part of the mesh's diagonal: less than a pixel where a picture of 1024 pixels
 * shows the whole mesh. */
#define TOLERANCE 6e-4

/* The outline of a triangle's splat about one of its corners. The ellipse maps the triangle to an equilateral one; the
 * unit is a side of that. From 0.577 on the three outlines cover the triangle; up to 0.866 none crosses the opposite
 * side. */
#define CORNER_OUTLINE 0.65

/* The least ratio of such an ellipse's axes: floats hold slivers no better. */
#define LEAST_RATIO 1e-5

/* A vertex of more triangles is not checked in detail: each vertex around it would check all of them. */
enum { MOST_TRIANGLES = 64 };

/* Marks a splat that stays as it is. */
#define NO_TRIANGLE UINT32_MAX

typedef struct mesh_bounding {
  const conic_model *model;
  double cutoff, cosine, tolerance2;
  conic_incidence ring;
  uint8_t *is_off;               /* of each vertex */
  size_t n_splats;               /* after the replacement, … */
  uint32_t *sources, *triangles; /* … each with its vertex and its triangle */
} mesh_bounding;

static void read_place(const conic_splats *points, size_t i, double at[3]) {
  conic_vector_at(points->position, i, at);
}

/* Reads the corners of a triangle from `vertex` on, and its normal; returns 0 for a triangle without area. */
static int read_triangle(const conic_model *model, const uint32_t triangle[3], size_t vertex, double corners[3][3],
                         double normal[3]) {
  double edges[2][3];
  int at = triangle[0] == vertex ? 0 : triangle[1] == vertex ? 1 : 2;
  for (int i = 0; i < 3; i++)
    read_place(&model->points, triangle[(at + i) % 3], corners[i]);
  conic_subtract(corners[1], corners[0], edges[0]);
  conic_subtract(corners[2], corners[0], edges[1]);
  conic_cross(edges[0], edges[1], normal);
  return conic_normalize(normal);
}

/* --- splats off the mesh --- */

/* The triangles around a vertex; those without an area are left out. */
typedef struct triangle_fan {
  size_t n, last; /* last: the one that was near the last place */
  double corners[MOST_TRIANGLES][3][3];
} triangle_fan;

static void gather_fan(const mesh_bounding *in, size_t vertex, triangle_fan *fan) {
  size_t first = in->ring.starts[vertex], n = in->ring.starts[vertex + 1] - first;
  fan->n = n <= MOST_TRIANGLES ? n : 0;
  fan->last = 0;
  for (size_t i = 0; i < fan->n; i++)
    for (int corner = 0; corner < 3; corner++)
      read_place(&in->model->points, in->model->triangles[in->ring.triangles[first + i]][corner],
                 fan->corners[i][corner]);
}

static int is_near_fan(const mesh_bounding *in, triangle_fan *fan, const double at[3]) {
  for (size_t i = 0, k = fan->last; i < fan->n; i++, k = k + 1 < fan->n ? k + 1 : 0)
    if (conic_distance2_to_triangle(at, fan->corners[k][0], fan->corners[k][1], fan->corners[k][2]) <= in->tolerance2) {
      fan->last = k;
      return 1;
    }
  return 0;
}

/* Looks around the vertex, whose triangles are in `fan`, then around its neighbours. */
static int is_near_mesh(const mesh_bounding *in, size_t vertex, triangle_fan *fan, const double at[3]) {
  triangle_fan next;
  if (is_near_fan(in, fan, at))
    return 1;
  for (size_t i = in->ring.starts[vertex]; i < in->ring.starts[vertex + 1]; i++)
    for (int j = 0; j < 3; j++) {
      size_t other = in->model->triangles[in->ring.triangles[i]][j];
      if (other == vertex)
        continue;
      gather_fan(in, other, &next);
      if (is_near_fan(in, &next, at))
        return 1;
    }
  return 0;
}

/* Whether sixteen places on the outline are all at the mesh, as its middle is. */
static int is_at_mesh(const mesh_bounding *in, size_t vertex) {
  static const double circle[4][2] = {{1.0, 0.0},
                                      {0.92387953251128674, 0.38268343236508977},
                                      {0.70710678118654752, 0.70710678118654752},
                                      {0.38268343236508977, 0.92387953251128674}};
  const conic_splats *points = &in->model->points;
  triangle_fan fan;
  gather_fan(in, vertex, &fan);
  for (int i = 0; i < 16; i++) {
    double c = circle[i % 4][0], s = circle[i % 4][1], at[3];
    const double turns[4][2] = {{c, s}, {-s, c}, {-c, -s}, {s, -c}};
    double u = in->cutoff * turns[i / 4][0], v = in->cutoff * turns[i / 4][1];
    for (int axis = 0; axis < 3; axis++)
      at[axis] = (double)points->position[axis][vertex] + u * (double)points->tangent_u[axis][vertex] +
                 v * (double)points->tangent_v[axis][vertex];
    if (!is_near_mesh(in, vertex, &fan, at))
      return 0;
  }
  return 1;
}

static int has_edge_in_common(const uint32_t a[3], const uint32_t b[3]) {
  int n_common = 0;
  for (int i = 0; i < 9; i++)
    n_common += a[i / 3] == b[i % 3];
  return n_common >= 2;
}

static int is_on_crease(const mesh_bounding *in, size_t vertex) {
  double corners[3][3], normals[MOST_TRIANGLES][3];
  size_t first = in->ring.starts[vertex], n = in->ring.starts[vertex + 1] - first;
  const uint32_t *list = in->ring.triangles + first;
  for (size_t i = 0; i < n && in->cosine > -1.0; i++) {
    read_triangle(in->model, in->model->triangles[list[i]], vertex, corners, normals[i]);
    for (size_t j = 0; j < i; j++)
      if (has_edge_in_common(in->model->triangles[list[i]], in->model->triangles[list[j]]) &&
          conic_dot(normals[i], normals[j]) < in->cosine)
        return 1;
  }
  return 0;
}

static void find_off(void *data, size_t begin, size_t end) {
  const mesh_bounding *in = data;
  for (size_t i = begin; i < end; i++) {
    size_t n = in->ring.starts[i + 1] - in->ring.starts[i];
    int is_drawn = n > 0 && in->model->points.tangent_u[0][i] * 0.0f == 0.0f;
    in->is_off[i] = is_drawn && (n > MOST_TRIANGLES || is_on_crease(in, i) || !is_at_mesh(in, i));
  }
}

/* --- their replacement --- */

/* The line through the centre along `edge`, keeping the side of `inside`, in units of the axes. */
static void lay_line(const double u[3], const double v[3], const double edge[3], const double inside[3],
                     float line[3]) {
  double uu = conic_dot(u, u), vv = conic_dot(v, v);
  double a = -conic_dot(edge, v) / vv, b = conic_dot(edge, u) / uu;
  double length = sqrt(a * a + b * b);
  double sign = a * conic_dot(inside, u) / uu + b * conic_dot(inside, v) / vv < 0.0 ? -1.0 : 1.0;
  line[0] = (float)(sign * a / length);
  line[1] = (float)(sign * b / length);
  line[2] = 0.0f;
}

/* Splat `i`, at the triangle's first corner, gets the axes, lines and normal for the triangle. */
static void lay_corner(const mesh_bounding *in, size_t i, conic_splats *points, conic_clip *clip) {
  static const double root_third = 0.57735026918962576;
  double corners[3][3], edges[2][3], normal[3], u[3], v[3], covariance[3] = {0.0, 0.0, 0.0};
  float axes[2][3];
  read_triangle(in->model, in->model->triangles[in->triangles[i]], in->sources[i], corners, normal);
  conic_tangent_basis(normal, u, v);
  conic_subtract(corners[1], corners[0], edges[0]);
  conic_subtract(corners[2], corners[0], edges[1]);
  /* Conjugate half axes of the ellipse that is the unit circle where the triangle is equilateral. */
  double first[2] = {conic_dot(edges[0], u), conic_dot(edges[0], v)}, second[2];
  second[0] = root_third * (2.0 * conic_dot(edges[1], u) - first[0]);
  second[1] = root_third * (2.0 * conic_dot(edges[1], v) - first[1]);
  conic_ellipse_add(covariance, first[0], first[1]);
  conic_ellipse_add(covariance, second[0], second[1]);
  conic_ellipse ellipse = conic_ellipse_shape(covariance, LEAST_RATIO);
  double along[2] = {first[0] * ellipse.major[0] + first[1] * ellipse.major[1],
                     second[0] * ellipse.major[0] + second[1] * ellipse.major[1]};
  ellipse.reach = CORNER_OUTLINE * sqrt(along[0] * along[0] + along[1] * along[1]);
  conic_ellipse_axes(&ellipse, u, v, in->cutoff, axes[0], axes[1]);
  for (int axis = 0; axis < 3; axis++) {
    u[axis] = (double)(points->tangent_u[axis][i] = axes[0][axis]);
    v[axis] = (double)(points->tangent_v[axis][i] = axes[1][axis]);
    if (points->normal[0])
      points->normal[axis][i] = (float)normal[axis];
  }
  *clip = (conic_clip){.splat = (uint32_t)i, .n_lines = 2, .operation = CONIC_CLIP_AND};
  lay_line(u, v, edges[0], edges[1], clip->lines[0]);
  lay_line(u, v, edges[1], edges[0], clip->lines[1]);
}

/* An off vertex's first triangle takes its place; the others come after all vertices. */
static void list_fan_splats(mesh_bounding *in) {
  const conic_model *model = in->model;
  double corners[3][3], normal[3];
  size_t n = model->points.count;
  in->n_splats = n;
  for (size_t vertex = 0; vertex < n; vertex++) {
    in->sources[vertex] = (uint32_t)vertex;
    in->triangles[vertex] = NO_TRIANGLE;
    for (size_t i = in->ring.starts[vertex]; in->is_off[vertex] && i < in->ring.starts[vertex + 1]; i++) {
      uint32_t triangle = in->ring.triangles[i];
      if (!read_triangle(model, model->triangles[triangle], vertex, corners, normal))
        continue;
      size_t at = in->triangles[vertex] == NO_TRIANGLE ? vertex : in->n_splats++;
      in->sources[at] = (uint32_t)vertex;
      in->triangles[at] = triangle;
    }
  }
}

static conic_status make_fan_splats(conic_context *context, const mesh_bounding *in, conic_splats *made) {
  size_t n_clips = 0;
  conic_status status = conic_splats_gather(context, &in->model->points, in->sources, in->n_splats, made);
  for (size_t i = 0; i < in->n_splats; i++)
    n_clips += in->triangles[i] != NO_TRIANGLE;
  if (status != CONIC_OK || n_clips == 0)
    return status;
  made->clips = conic_memory_allocate(context, n_clips, sizeof *made->clips);
  if (!made->clips) {
    conic_splats_release(context, made);
    return CONIC_ERROR_MEMORY;
  }
  for (size_t i = 0; i < in->n_splats; i++)
    if (in->triangles[i] != NO_TRIANGLE)
      lay_corner(in, i, made, &made->clips[made->n_clips++]);
  return CONIC_OK;
}

/* Returns how many vertices have no triangle; if they are leftovers they get no splat. */
static size_t drop_leftovers(const mesh_bounding *in, conic_splats *splats) {
  const size_t *starts = in->ring.starts;
  size_t n = in->model->points.count, n_loose = 0;
  for (size_t i = 0; i < n; i++)
    n_loose += starts[i] == starts[i + 1];
  if (!conic_mesh_has_leftovers(n, n_loose))
    return 0;
  for (size_t i = 0; i < n; i++)
    for (int axis = 0; axis < 3 && starts[i] == starts[i + 1]; axis++)
      splats->tangent_u[axis][i] = splats->tangent_v[axis][i] = NAN;
  return n_loose;
}

static conic_status bound(conic_context *context, mesh_bounding *in, conic_splats *made, size_t *n_dropped) {
  size_t n = in->model->points.count, n_corners = 3 * in->model->n_triangles;
  if (conic_memory_allocate_these(context, CONIC_ROOM(in->is_off, n), CONIC_ROOM(in->sources, n + n_corners),
                                  CONIC_ROOM(in->triangles, n + n_corners)) != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  conic_status status = conic_slots_for(context, n, find_off, in, 1.0, 1.0);
  if (status != CONIC_OK)
    return status;
  list_fan_splats(in);
  status = make_fan_splats(context, in, made);
  if (status == CONIC_OK)
    *n_dropped = drop_leftovers(in, made);
  return status;
}

double conic_mesh_tolerance(conic_context *context, const conic_splats *points) {
  double low[3], high[3], diagonal[3];
  conic_splats_bounds_by(context, points, low, high);
  conic_subtract(high, low, diagonal);
  return TOLERANCE * conic_length(diagonal);
}

conic_status conic_mesh_bound(conic_context *context, double cutoff, double cosine, conic_model *model,
                              conic_repairs *repairs) {
  mesh_bounding in = {.model = model, .cutoff = cutoff, .cosine = cosine};
  conic_splats made;
  size_t n_dropped = 0;
  double tolerance = conic_mesh_tolerance(context, &model->points);
  in.tolerance2 = tolerance * tolerance;
  conic_status status = conic_incidence_create(context, model, UINT32_MAX / 4, &in.ring);
  if (status == CONIC_OK)
    status = bound(context, &in, &made, &n_dropped);
  if (status == CONIC_OK) {
    conic_splats_release(context, &model->points);
    model->points = made;
    if (repairs)
      repairs->failed += n_dropped;
  }
  conic_memory_release_these(context, in.is_off, in.sources, in.triangles);
  conic_incidence_release(context, &in.ring);
  return status;
}
