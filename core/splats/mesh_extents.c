/* Ellipses of a mesh's vertices. The corners of a vertex's share of a triangle are the vertex, the middles of its two
 * edges and the triangle's middle; an ellipse around these for all the triangles of a vertex covers its share of the
 * surface, and all ellipses together cover all of it. */
#include <math.h>
#include <string.h>

#include "core/base/memory.h"
#include "core/base/message.h"
#include "core/base/vectors.h"
#include "core/splats/ellipse.h"
#include "core/splats/estimate.h"

/* The cosine from which on a face is steep in a vertex's tangent plane: 60°. */
#define STEEP 0.5

/* The triangles of vertex i are triangles[starts[i] … starts[i + 1]), in the order of the file. */
typedef struct incidence {
  conic_estimate *estimate;
  size_t *starts;
  uint32_t *triangles;
  double (*normals)[3]; /* of each vertex: unit, or not finite where it has no face */
} incidence;

/* A triangle as seen from one of its vertices. */
typedef struct vertex_triangle {
  size_t vertices[3]; /* this one, the next, the one after it */
  double edges[2][3]; /* to the next vertex and to the one after it */
  double cross[3];    /* of the edges: along the normal, twice the area long */
  double cross2;
} vertex_triangle;

/* Returns 0 for a triangle without area. */
static int view_corner(const conic_model *model, const uint32_t triangle[3], size_t vertex, vertex_triangle *c) {
  int at = triangle[0] == vertex ? 0 : triangle[1] == vertex ? 1 : 2;
  for (int i = 0; i < 3; i++)
    c->vertices[i] = triangle[(at + i) % 3];
  for (int i = 0; i < 2; i++)
    for (int axis = 0; axis < 3; axis++)
      c->edges[i][axis] = (double)model->points.position[axis][triangle[(at + 1 + i) % 3]] -
                          (double)model->points.position[axis][vertex];
  conic_cross(c->edges[0], c->edges[1], c->cross);
  c->cross2 = conic_dot(c->cross, c->cross);
  return c->cross2 > 0.0 && c->cross2 * 0.0 == 0.0;
}

/* The faces' normals, each weighted by sine over the product of the edges' lengths: exact on a sphere (Max 1999), and
 * no angle is needed. */
static int normal_of_vertex(const incidence *in, size_t vertex, double normal[3]) {
  const conic_model *model = in->estimate->model;
  double sum[3] = {0.0, 0.0, 0.0};
  vertex_triangle c;
  for (size_t i = in->starts[vertex]; i < in->starts[vertex + 1]; i++)
    if (view_corner(model, model->triangles[in->triangles[i]], vertex, &c)) {
      double weight = 1.0 / (conic_dot(c.edges[0], c.edges[0]) * conic_dot(c.edges[1], c.edges[1]));
      for (int axis = 0; axis < 3; axis++)
        sum[axis] += c.cross[axis] * weight;
    }
  double length = conic_length(sum);
  for (int axis = 0; axis < 3; axis++)
    normal[axis] = sum[axis] / length;
  return length > 0.0 && length * 0.0 == 0.0;
}

/* Where the tip of `d` comes to lie in the tangent plane (u, v). Along the face's normal, so that what is seen straight
 * on the face is covered; from a face steeper than 60° as if it had 60°; or else straight down. */
static void meet_plane(const vertex_triangle *c, const double d[3], const double normal[3], const double u[3],
                       const double v[3], int is_straight, double met[2]) {
  double length = sqrt(c->cross2), cosine = conic_dot(c->cross, normal) / length, way = 0.0;
  double sign = cosine < 0.0 ? -1.0 : 1.0;
  if (!is_straight)
    way = conic_dot(d, normal) / (cosine * sign > STEEP ? cosine : sign * STEEP) / length;
  met[0] = conic_dot(d, u) - way * conic_dot(c->cross, u);
  met[1] = conic_dot(d, v) - way * conic_dot(c->cross, v);
}

static int is_steep(const incidence *in, const vertex_triangle *c, int i) {
  return fabs(conic_dot(c->cross, in->normals[c->vertices[i]])) < STEEP * sqrt(c->cross2);
}

enum { MAX_SUPPORT = 5 };

/* What the vertex's ellipse must cover for this triangle, in its tangent plane. Where the triangle is steep for a
 * vertex (the tip of a horn), the share of that vertex goes to the others, and its own ellipse only closes the end. */
static int view_support(const incidence *in, const vertex_triangle *c, const double u[3], const double v[3],
                        double support[MAX_SUPPORT][2]) {
  const double *normal = in->normals[c->vertices[0]];
  int steep[3] = {is_steep(in, c, 0), is_steep(in, c, 1), is_steep(in, c, 2)}, n = 3;
  int is_straight = steep[0] && !(steep[1] && steep[2]);
  double middle[3], halves[2][3];
  for (int axis = 0; axis < 3; axis++) {
    halves[0][axis] = 0.5 * c->edges[0][axis];
    halves[1][axis] = 0.5 * c->edges[1][axis];
    middle[axis] = (c->edges[0][axis] + c->edges[1][axis]) / 3.0;
  }
  meet_plane(c, halves[0], normal, u, v, is_straight, support[0]);
  meet_plane(c, halves[1], normal, u, v, is_straight, support[1]);
  meet_plane(c, middle, normal, u, v, is_straight, support[2]);
  for (int i = 0; i < 2; i++)
    if (!steep[0] && steep[1 + i])
      meet_plane(c, c->edges[i], normal, u, v, 0, support[n++]);
  return n;
}

static void spread_vertex(const incidence *in, size_t vertex) {
  const conic_model *model = in->estimate->model;
  double u[3], v[3], support[MAX_SUPPORT][2], covariance[3] = {0.0, 0.0, 0.0}, area = 0.0, greatest2 = 0.0;
  double flatness = 1.0; /* the least cosine to a face */
  float tangent_u[3], tangent_v[3];
  vertex_triangle c;
  conic_tangent_basis(in->normals[vertex], u, v);
  for (size_t i = in->starts[vertex]; i < in->starts[vertex + 1]; i++)
    if (view_corner(model, model->triangles[in->triangles[i]], vertex, &c)) {
      int n = view_support(in, &c, u, v, support);
      for (int j = 0; j < n; j++)
        conic_ellipse_add(covariance, support[j][0], support[j][1]);
      area += sqrt(c.cross2) / 6.0;
      double cosine = fabs(conic_dot(c.cross, in->normals[vertex])) / sqrt(c.cross2);
      flatness = cosine < flatness ? cosine : flatness;
    }
  conic_ellipse ellipse = conic_ellipse_shape(covariance, CONIC_OUTLINE_RATIO);
  for (size_t i = in->starts[vertex]; i < in->starts[vertex + 1]; i++)
    if (view_corner(model, model->triangles[in->triangles[i]], vertex, &c)) {
      int n = view_support(in, &c, u, v, support);
      for (int j = 0; j < n; j++) {
        double distance2 = support[j][0] * support[j][0] + support[j][1] * support[j][1];
        greatest2 = distance2 > greatest2 ? distance2 : greatest2;
        conic_ellipse_cover(&ellipse, support[j][0], support[j][1]);
      }
    }
  /* For blending an outline grows less where the surface is sharp and the ellipse stands out from it; and to twice what
   * it must cover at most: on a fan of slivers it would grow without end. */
  conic_ellipse_overlap(&ellipse, area, CONIC_OUTLINE_COVER, CONIC_OUTLINE_BLEND * flatness, 2.0 * sqrt(greatest2));
  int is_good = conic_ellipse_axes(&ellipse, u, v, in->estimate->cutoff, tangent_u, tangent_v);
  for (int axis = 0; axis < 3; axis++) {
    in->estimate->tangent_u[axis][vertex] = tangent_u[axis];
    in->estimate->tangent_v[axis][vertex] = tangent_v[axis];
  }
  in->estimate->states[vertex] = (uint8_t)(is_good ? CONIC_POINT_FACED : CONIC_POINT_FAILED);
}

static void spread_vertices(void *data, size_t begin, size_t end) {
  const incidence *in = data;
  for (size_t vertex = begin; vertex < end; vertex++)
    if (in->estimate->states[vertex] == CONIC_POINT_RAW && in->normals[vertex][0] * 0.0 == 0.0)
      spread_vertex(in, vertex);
}

/* The normals of all vertices with a face: of the file where it has one, else of the faces. */
static void find_normals(void *data, size_t begin, size_t end) {
  const incidence *in = data;
  float *const *given = in->estimate->model->points.normal;
  for (size_t vertex = begin; vertex < end; vertex++) {
    double of_file[3];
    if (!normal_of_vertex(in, vertex, in->normals[vertex])) {
      in->normals[vertex][0] = NAN;
      continue;
    }
    if (given[0] && conic_unit_vector(given[0][vertex], given[1][vertex], given[2][vertex], of_file))
      memcpy(in->normals[vertex], of_file, sizeof of_file);
  }
}

static conic_status check_triangles(conic_context *context, const conic_model *model) {
  if (model->n_triangles > UINT32_MAX)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "%zu triangles are too many", model->n_triangles);
  for (size_t i = 0; i < model->n_triangles; i++)
    for (int j = 0; j < 3; j++)
      if (model->triangles[i][j] >= model->points.count)
        return conic_fail(context, CONIC_ERROR_ARGUMENT, "triangle %zu has the vertex %zu, but there are only %zu", i,
                          (size_t)model->triangles[i][j], model->points.count);
  return CONIC_OK;
}

/* A counting sort of the triangles' corners by vertex. starts[i + 1] is first where the next one of vertex i goes. */
static void fill_incidence(const conic_model *model, incidence *in) {
  for (size_t i = 0; i < model->n_triangles; i++)
    for (int j = 0; j < 3; j++)
      in->starts[model->triangles[i][j] + 2]++;
  for (size_t vertex = 0; vertex < model->points.count; vertex++)
    in->starts[vertex + 2] += in->starts[vertex + 1];
  for (size_t i = 0; i < model->n_triangles; i++)
    for (int j = 0; j < 3; j++)
      in->triangles[in->starts[model->triangles[i][j] + 1]++] = (uint32_t)i;
}

conic_status conic_estimate_from_faces(conic_context *context, conic_estimate *estimate) {
  const conic_model *model = estimate->model;
  conic_status status = check_triangles(context, model);
  if (status != CONIC_OK)
    return status;
  incidence in = {estimate, conic_memory_allocate_zeroed(context, model->points.count + 2, sizeof *in.starts),
                  conic_memory_allocate(context, model->n_triangles, 3 * sizeof *in.triangles),
                  conic_memory_allocate(context, model->points.count, sizeof *in.normals)};
  status = CONIC_ERROR_MEMORY;
  if (in.starts && in.triangles && in.normals) {
    fill_incidence(model, &in);
    status = conic_slots_for(context, model->points.count, find_normals, &in, 0.0, 0.3);
  }
  if (status == CONIC_OK)
    status = conic_slots_for(context, model->points.count, spread_vertices, &in, 0.3, 1.0);
  conic_memory_release(context, in.normals);
  conic_memory_release(context, in.triangles);
  conic_memory_release(context, in.starts);
  return status;
}
