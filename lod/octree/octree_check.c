/* Whether an octree keeps what its numbers promise. */

#include "core/base/vectors.h"
#include "lod/octree/octree_nodes.h"

static const size_t chunk_nodes = 256;

/* What floats lose between the finding of a bound and its use. */
static const double hair = 1e-5;

typedef struct checking {
  const conic_octree *octree;
  conic_octree_defects *chunks;
} checking;

static void vector_of(const float values[3], double v[3]) {
  for (int axis = 0; axis < 3; axis++)
    v[axis] = (double)values[axis];
}

/* How far the ellipse c + x·a + y·b, x² + y² = 1, reaches from the origin: the least bound that Lagrange's function
 * gives, |c|² + m + Σ pᵢ²/(m - qᵢ) over the eigenvalues qᵢ of the axes' products, m above both; it is convex in m. */
static double farthest(const double c[2], const double a[2], const double b[2]) {
  double aa = a[0] * a[0] + a[1] * a[1], bb = b[0] * b[0] + b[1] * b[1], ab = a[0] * b[0] + a[1] * b[1];
  double cc = c[0] * c[0] + c[1] * c[1], ca = c[0] * a[0] + c[1] * a[1], cb = c[0] * b[0] + c[1] * b[1];
  double half = 0.5 * (aa - bb), root = sqrt(half * half + ab * ab), q = 0.5 * (aa + bb) + root;
  double low = q, high = q + sqrt(ca * ca + cb * cb) + 1e-30; /* the derivative is not below 0 there */
  for (int step = 0; step < 60; step++) {
    double m = 0.5 * (low + high), determinant = (m - aa) * (m - bb) - ab * ab;
    double x = ((m - bb) * ca + ab * cb) / determinant, y = (ab * ca + (m - aa) * cb) / determinant;
    if (x * x + y * y > 1.0 || !(determinant > 0.0))
      low = m;
    else
      high = m;
  }
  double determinant = (high - aa) * (high - bb) - ab * ab;
  double x = ((high - bb) * ca + ab * cb) / determinant, y = (ab * ca + (high - aa) * cb) / determinant;
  double bound2 = determinant > 0.0 ? cc + high + (ca * x + cb * y) : cc + high;
  return sqrt(bound2 > 0.0 ? bound2 : 0.0);
}

enum { OUT_OF_ELLIPSE = 1, OUT_OF_SPHERE = 2, OUT_OF_CONE = 4, OUT_OF_ERROR = 8 };

/* The same of a dot, a ball of this radius at p from the node's position; c is where that is in its ellipse. */
static int check_dot(const conic_octree *octree, size_t i, double radius, const double c[2], const double p[3]) {
  double n[3], v[3], cutoff = octree->scale.cutoff;
  conic_vector_at(octree->normal, i, n);
  vector_of(octree->drawn[i].tangent_v, v);
  int broken = sqrt(c[0] * c[0] + c[1] * c[1]) + radius / conic_length(v) <= cutoff * (1.0 + hair) ? 0 : OUT_OF_ELLIPSE;
  if (!(conic_length(p) + 2.0 * radius <= (double)octree->radius[i] * (1.0 + hair)))
    broken |= OUT_OF_SPHERE;
  if (!((double)octree->cone[i] <= hair))
    broken |= OUT_OF_CONE;
  if (!(fabs(conic_dot(p, n)) + radius <= (double)octree->error[i] * (1.0 + hair)))
    broken |= OUT_OF_ERROR;
  return broken;
}

/* Which bounds of node i leaf k breaks. Comparisons are such that what is not a number breaks them. */
static int check_leaf(const conic_octree *octree, size_t i, size_t k) {
  const conic_splats *leaves = &octree->leaves;
  const conic_drawn_node *node = &octree->drawn[i];
  double cutoff = octree->scale.cutoff, center[3], at[3], p[3], n[3], node_u[3], node_v[3], u[3], v[3], facing[3];
  int broken = 0;
  vector_of(node->position, center);
  vector_of(node->tangent_u, node_u);
  vector_of(node->tangent_v, node_v);
  conic_vector_at(octree->normal, i, n);
  conic_vector_at(leaves->position, k, at);
  conic_vector_at(leaves->tangent_u, k, u);
  conic_vector_at(leaves->tangent_v, k, v);
  conic_subtract(at, center, p);
  conic_cross(u, v, facing);
  /* In units of the node's axes, in which its outline is a circle of the cutoff. */
  double scale_u = 1.0 / conic_dot(node_u, node_u), scale_v = 1.0 / conic_dot(node_v, node_v);
  const double c[2] = {conic_dot(p, node_u) * scale_u, conic_dot(p, node_v) * scale_v};
  const double a[2] = {cutoff * conic_dot(u, node_u) * scale_u, cutoff * conic_dot(u, node_v) * scale_v};
  const double b[2] = {cutoff * conic_dot(v, node_u) * scale_u, cutoff * conic_dot(v, node_v) * scale_v};
  double out = farthest(c, a, b);
  if (!(out <= cutoff * (1.0 + hair)))
    broken |= OUT_OF_ELLIPSE;
  double uu = conic_dot(u, u), vv = conic_dot(v, v), uv = conic_dot(u, v);
  double longest = sqrt(0.5 * (uu + vv + sqrt((uu - vv) * (uu - vv) + 4.0 * uv * uv)));
  if (!(conic_length(p) + cutoff * longest <= (double)octree->radius[i] * (1.0 + hair)))
    broken |= OUT_OF_SPHERE;
  if (!(conic_dot(facing, n) >= ((double)octree->cone[i] - hair) * conic_length(facing)))
    broken |= OUT_OF_CONE;
  double uz = conic_dot(u, n), vz = conic_dot(v, n), height = fabs(conic_dot(p, n)) + cutoff * sqrt(uz * uz + vz * vz);
  if (!(height <= (double)octree->error[i] * (1.0 + hair)))
    broken |= OUT_OF_ERROR;
  double radius = conic_octree_dot_radius(octree, k);
  return radius > 0.0 ? check_dot(octree, i, radius, c, p) : broken;
}

static void check_node(const conic_octree *octree, size_t i, conic_octree_defects *found) {
  double u[3];
  vector_of(octree->drawn[i].tangent_u, u);
  double reach = octree->scale.cutoff * conic_length(u), radius = (double)octree->radius[i];
  int broken = reach <= radius * (1.0 + hair) ? 0 : OUT_OF_SPHERE;
  if (!((double)octree->error[i] <= 2.0 * radius * (1.0 + hair)))
    broken |= OUT_OF_ERROR;
  for (size_t k = octree->first_leaf[i]; k < octree->first_leaf[octree->end[i]]; k++)
    broken |= check_leaf(octree, i, k);
  found->ellipses += (broken & OUT_OF_ELLIPSE) != 0;
  found->spheres += (broken & OUT_OF_SPHERE) != 0;
  found->cones += (broken & OUT_OF_CONE) != 0;
  found->errors += (broken & OUT_OF_ERROR) != 0;
}

static void check_task(void *data, size_t i_chunk) {
  const checking *job = data;
  size_t begin = i_chunk * chunk_nodes, end = begin + chunk_nodes, n = job->octree->n_nodes;
  memset(&job->chunks[i_chunk], 0, sizeof *job->chunks);
  for (size_t i = begin; i < end && i < n; i++)
    check_node(job->octree, i, &job->chunks[i_chunk]);
}

/* Leaves that must be there to be drawn, and are not. */
static size_t count_lost(const conic_octree *octree) {
  size_t n = 0;
  for (size_t i = 0; i < octree->n_leaves; i++) {
    double p[3], u[3], v[3], facing[3];
    conic_vector_at(octree->leaves.position, i, p);
    conic_vector_at(octree->leaves.tangent_u, i, u);
    conic_vector_at(octree->leaves.tangent_v, i, v);
    conic_cross(u, v, facing);
    n += !(conic_dot(p, p) * 0.0 == 0.0 && conic_dot(facing, facing) > 0.0);
  }
  return n;
}

conic_status conic_octree_check(conic_octree *octree, conic_octree_defects *defects) {
  size_t n_chunks = (octree->n_nodes + chunk_nodes - 1) / chunk_nodes;
  checking job = {octree, conic_memory_allocate(octree->context, n_chunks, sizeof *job.chunks)};
  memset(defects, 0, sizeof *defects);
  if (!job.chunks)
    return CONIC_ERROR_MEMORY;
  conic_status status = conic_octree_decode(octree);
  if (status != CONIC_OK) {
    conic_memory_release(octree->context, job.chunks);
    return status;
  }
  status = conic_parallel_told(octree->context, "check", 0.0, 1.0, n_chunks, check_task, &job);
  for (size_t i = 0; i < n_chunks && status == CONIC_OK; i++) {
    defects->ellipses += job.chunks[i].ellipses;
    defects->spheres += job.chunks[i].spheres;
    defects->cones += job.chunks[i].cones;
    defects->errors += job.chunks[i].errors;
  }
  defects->splats = count_lost(octree);
  conic_memory_release(octree->context, job.chunks);
  return status;
}
