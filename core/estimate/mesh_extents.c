/* Ellipses of a mesh's vertices. A vertex's share of a triangle has four corners: the vertex, the middles of its two
 * edges and the triangle's middle. An ellipse around these corners for all triangles of a vertex covers its share of
 * the surface; all ellipses together cover the whole surface. */

#include "core/base/vectors.h"
#include "core/estimate/estimate.h"
#include "core/estimate/incidence.h"
#include "core/splats/ellipse.h"

/* With a lesser cosine a face is steep in a vertex's tangent plane: 60°. */
#define STEEP 0.5

typedef struct spreading {
  conic_estimate *estimate;
  conic_incidence ring;
  double (*normals)[3]; /* of each vertex: unit, or not finite for a vertex without a face */
} spreading;

/* A triangle as seen from one of its vertices. */
typedef struct vertex_triangle {
  size_t vertices[3]; /* the vertex, the next one, the one after */
  double edges[2][3]; /* to the next vertex and to the one after it */
  double cross[3];    /* of the edges: along the normal, with the length of twice the area */
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

/* The vertex's normal from its faces', each weighted by sine over the product of the edges' lengths: exact on a sphere
 * (Max 1999), without any angle. */
static int normal_of_vertex(const spreading *in, size_t vertex, double normal[3]) {
  const conic_model *model = in->estimate->model;
  double sum[3] = {0.0, 0.0, 0.0};
  vertex_triangle c;
  for (size_t i = in->ring.starts[vertex]; i < in->ring.starts[vertex + 1]; i++)
    if (view_corner(model, model->triangles[in->ring.triangles[i]], vertex, &c)) {
      double weight = 1.0 / (conic_dot(c.edges[0], c.edges[0]) * conic_dot(c.edges[1], c.edges[1]));
      for (int axis = 0; axis < 3; axis++)
        sum[axis] += c.cross[axis] * weight;
    }
  double length = conic_length(sum);
  for (int axis = 0; axis < 3; axis++)
    normal[axis] = sum[axis] / length;
  return length > 0.0 && length * 0.0 == 0.0;
}

/* Where the tip of `d` goes in the tangent plane (u, v). It goes along the face's normal, so that everything seen
 * straight on the face is covered; from a face steeper than 60° as if it had 60°; or else straight down. */
static void meet_plane(const vertex_triangle *c, const double d[3], const double normal[3], const double u[3],
                       const double v[3], int is_straight, double met[2]) {
  double length = sqrt(c->cross2), cosine = conic_dot(c->cross, normal) / length, way = 0.0;
  double sign = cosine < 0.0 ? -1.0 : 1.0;
  if (!is_straight)
    way = conic_dot(d, normal) / (cosine * sign > STEEP ? cosine : sign * STEEP) / length;
  met[0] = conic_dot(d, u) - way * conic_dot(c->cross, u);
  met[1] = conic_dot(d, v) - way * conic_dot(c->cross, v);
}

static int is_steep(const spreading *in, const vertex_triangle *c, int i) {
  return fabs(conic_dot(c->cross, in->normals[c->vertices[i]])) < STEEP * sqrt(c->cross2);
}

enum { MAX_SUPPORT = 5 };

/* What the vertex's ellipse must cover for this triangle, in its tangent plane. Where the triangle is steep for a
 * vertex (the tip of a horn), the others take over its share, and its own ellipse only closes the end. */
static int view_support(const spreading *in, const vertex_triangle *c, const double u[3], const double v[3],
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

static void spread_vertex(const spreading *in, size_t vertex) {
  const conic_model *model = in->estimate->model;
  double u[3], v[3], support[MAX_SUPPORT][2], covariance[3] = {0.0, 0.0, 0.0}, area = 0.0, greatest2 = 0.0;
  double flatness = 1.0; /* the least cosine to a face */
  float tangent_u[3], tangent_v[3];
  vertex_triangle c;
  conic_tangent_basis(in->normals[vertex], u, v);
  for (size_t i = in->ring.starts[vertex]; i < in->ring.starts[vertex + 1]; i++)
    if (view_corner(model, model->triangles[in->ring.triangles[i]], vertex, &c)) {
      int n = view_support(in, &c, u, v, support);
      for (int j = 0; j < n; j++)
        conic_ellipse_add(covariance, support[j][0], support[j][1]);
      area += sqrt(c.cross2) / 6.0;
      double cosine = fabs(conic_dot(c.cross, in->normals[vertex])) / sqrt(c.cross2);
      flatness = cosine < flatness ? cosine : flatness;
    }
  conic_ellipse ellipse = conic_ellipse_shape(covariance, CONIC_OUTLINE_RATIO);
  for (size_t i = in->ring.starts[vertex]; i < in->ring.starts[vertex + 1]; i++)
    if (view_corner(model, model->triangles[in->ring.triangles[i]], vertex, &c)) {
      int n = view_support(in, &c, u, v, support);
      for (int j = 0; j < n; j++) {
        double distance2 = support[j][0] * support[j][0] + support[j][1] * support[j][1];
        greatest2 = distance2 > greatest2 ? distance2 : greatest2;
        conic_ellipse_cover(&ellipse, support[j][0], support[j][1]);
      }
    }
  /* For blending an outline grows less where the surface is sharp and the ellipse stands out from it: no farther than
   * allowed, and at most to twice the radius that it must cover; on a fan of slivers it would grow without end. */
  double steepness = sqrt(1.0 - flatness * flatness), most = 2.0 * sqrt(greatest2);
  most = most * steepness > in->estimate->tolerance ? in->estimate->tolerance / steepness : most;
  conic_ellipse_overlap(&ellipse, area, CONIC_OUTLINE_COVER, CONIC_OUTLINE_BLEND * flatness, most);
  int is_good = conic_ellipse_axes(&ellipse, u, v, in->estimate->cutoff, tangent_u, tangent_v);
  for (int axis = 0; axis < 3; axis++) {
    in->estimate->tangent_u[axis][vertex] = tangent_u[axis];
    in->estimate->tangent_v[axis][vertex] = tangent_v[axis];
  }
  in->estimate->states[vertex] = (uint8_t)(is_good ? CONIC_POINT_FACED : CONIC_POINT_FAILED);
}

static void spread_vertices(void *data, size_t begin, size_t end) {
  const spreading *in = data;
  for (size_t vertex = begin; vertex < end; vertex++)
    if (in->estimate->states[vertex] == CONIC_POINT_RAW && in->normals[vertex][0] * 0.0 == 0.0)
      spread_vertex(in, vertex);
}

/* The normals of all vertices with a face: the file's where it has one, else the faces'. */
static void find_normals(void *data, size_t begin, size_t end) {
  const spreading *in = data;
  float *const *given = in->estimate->model->points.normal;
  for (size_t vertex = begin; vertex < end; vertex++) {
    double of_file[3];
    if (!normal_of_vertex(in, vertex, in->normals[vertex])) {
      in->normals[vertex][0] = NAN;
      continue;
    }
    if (given[0] && conic_unit_vector(given, vertex, of_file))
      memcpy(in->normals[vertex], of_file, sizeof of_file);
  }
}

conic_status conic_estimate_from_faces(conic_context *context, conic_estimate *estimate) {
  size_t n_vertices = estimate->model->points.count;
  spreading in = {.estimate = estimate};
  conic_status status = conic_incidence_create(context, estimate->model, UINT32_MAX, &in.ring);
  if (status != CONIC_OK)
    return status;
  in.normals = conic_memory_allocate(context, n_vertices, sizeof *in.normals);
  status = in.normals ? conic_slots_for(context, n_vertices, find_normals, &in, 0.0, 0.3) : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK)
    status = conic_slots_for(context, n_vertices, spread_vertices, &in, 0.3, 1.0);
  conic_memory_release(context, in.normals);
  conic_incidence_release(context, &in.ring);
  return status;
}
