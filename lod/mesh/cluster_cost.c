/* Sums that describe a set of faces, and add up when two sets become one; and the cost of making them one (HQP §3.2.2).
 * All lengths are in units of the longest side of the mesh's box, about its middle. */
#include "lod/mesh/mesh_clusters.h"

#include "core/base/eigen.h"
#include "core/base/trigonometry.h"
#include "core/base/vectors.h"

conic_unit_box conic_unit_box_of(const conic_mesh *mesh, const conic_adjacency *adjacency) {
  double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, longest = 0.0;
  conic_unit_box box = {{0.0, 0.0, 0.0}, 1.0};
  for (size_t i = 0; i < mesh->n_faces; i++)
    for (int corner = 0; corner < 3 && adjacency->side[i]; corner++) {
      double at[3];
      conic_mesh_corner(mesh, i, corner, at);
      conic_widen_box(low, high, at);
    }
  for (int axis = 0; axis < 3 && low[0] <= high[0]; axis++) {
    box.middle[axis] = 0.5 * (low[axis] + high[axis]);
    longest = high[axis] - low[axis] > longest ? high[axis] - low[axis] : longest;
  }
  if (longest > 0.0)
    box.scale = 1.0 / longest;
  return box;
}

static void add_outer(double sums[6], const double v[3], double weight) {
  const double weighted[3] = {weight * v[0], weight * v[1], weight * v[2]};
  conic_add_outer(sums, weighted, v);
}

conic_face_sums conic_face_sums_of(const conic_mesh *mesh, const conic_adjacency *adjacency, const conic_unit_box *box,
                                   size_t i_face) {
  conic_face_sums sums;
  double at[3][3], edges[3][3], cross[3], corners[3] = {0.0, 0.0, 0.0};
  memset(&sums, 0, sizeof sums);
  for (int corner = 0; corner < 3; corner++) {
    conic_mesh_corner(mesh, i_face, corner, at[corner]);
    for (int axis = 0; axis < 3; axis++) {
      at[corner][axis] = (at[corner][axis] - box->middle[axis]) * box->scale;
      corners[axis] += at[corner][axis];
    }
  }
  for (int corner = 0; corner < 3; corner++) {
    for (int axis = 0; axis < 3; axis++)
      edges[corner][axis] = at[(corner + 1) % 3][axis] - at[corner][axis];
    sums.outline += conic_length(edges[corner]);
  }
  conic_cross(edges[0], edges[1], cross);
  double length = conic_length(cross);
  if (!(length > 0.0))
    return sums;
  sums.area = 0.5 * length;
  for (int axis = 0; axis < 3; axis++) {
    cross[axis] *= (double)adjacency->side[i_face] / length;
    sums.first[axis] = sums.area * corners[axis] / 3.0;
    sums.normal[axis] = sums.area * cross[axis];
  }
  /* ∫ x xᵀ over a triangle: area/12 · (Σ v vᵀ + (Σ v)(Σ v)ᵀ). */
  for (int corner = 0; corner < 3; corner++)
    add_outer(sums.second, at[corner], sums.area / 12.0);
  add_outer(sums.second, corners, sums.area / 12.0);
  add_outer(sums.normals, cross, sums.area);
  return sums;
}

conic_face_sums conic_face_sums_join(const conic_face_sums *a, const conic_face_sums *b, double shared) {
  conic_face_sums sums;
  sums.area = a->area + b->area;
  for (int i = 0; i < 3; i++) {
    sums.first[i] = a->first[i] + b->first[i];
    sums.normal[i] = a->normal[i] + b->normal[i];
  }
  for (int i = 0; i < 6; i++) {
    sums.second[i] = a->second[i] + b->second[i];
    sums.normals[i] = a->normals[i] + b->normals[i];
  }
  sums.outline = (a->outline + b->outline) - 2.0 * shared;
  return sums;
}

/* The covariance about the mean, the mean in `mean`. */
static void covariance_of(const conic_face_sums *sums, double mean[3], double covariance[6]) {
  double over = 1.0 / sums->area;
  for (int i = 0; i < 3; i++)
    mean[i] = sums->first[i] * over;
  for (int i = 0; i < 6; i++)
    covariance[i] = sums->second[i] * over;
  add_outer(covariance, mean, -1.0);
}

/* nᵀ M n of a symmetric matrix. */
static double form(const double m[6], const double n[3]) {
  return (m[0] * n[0] * n[0] + m[3] * n[1] * n[1] + m[5] * n[2] * n[2]) +
         2.0 * (m[1] * n[0] * n[1] + m[2] * n[0] * n[2] + m[4] * n[1] * n[2]);
}

void conic_face_sums_plane(const conic_face_sums *sums, double normal[3], double *d) {
  static const double open = 1e-9; /* eigenvalues that differ by less say nothing of a direction */
  double mean[3] = {0.0, 0.0, 0.0}, covariance[6] = {0}, values[3] = {0}, vectors[3][3] = {{0}};
  double length = conic_length(sums->normal);
  if (sums->area > 0.0) {
    covariance_of(sums, mean, covariance);
    conic_eigen3(covariance, values, vectors);
  }
  int is_open = !(values[1] - values[2] > open * values[0]);
  double sign = conic_dot(vectors[2], sums->normal) < 0.0 ? -1.0 : 1.0;
  for (int axis = 0; axis < 3; axis++)
    normal[axis] = !is_open       ? sign * vectors[2][axis]
                   : length > 0.0 ? sums->normal[axis] / length
                                  : (double)(axis == 2);
  *d = -conic_dot(normal, mean);
}

double conic_face_sums_raggedness(const conic_face_sums *sums) {
  return sums->area > 0.0 ? sums->outline * sums->outline / (4.0 * CONIC_PI * sums->area) : HUGE_VAL;
}

static double shape_of(const conic_face_sums *a, const conic_face_sums *b, const conic_face_sums *both) {
  double before_a = conic_face_sums_raggedness(a), before_b = conic_face_sums_raggedness(b);
  double before = before_a > before_b ? before_a : before_b, after = conic_face_sums_raggedness(both);
  if (!(before < HUGE_VAL))
    return -1.0;
  if (!(after > 0.0)) /* a closed surface has no outline */
    return -1.0;
  double shape = (after - before) / after;
  return shape > -1.0 ? shape : -1.0;
}

conic_joining_cost conic_joining_cost_without_plane(const conic_face_sums *a, const conic_face_sums *b, double shared,
                                                    double largest_area, conic_face_sums *both) {
  conic_joining_cost cost = {0.0, 0.0, 0.0, 0.0};
  *both = conic_face_sums_join(a, b, shared);
  if (!(both->area > 0.0))
    return cost;
  cost.shape = shape_of(a, b, both);
  cost.size = both->area / largest_area;
  return cost;
}

void conic_joining_cost_add_plane(const conic_face_sums *both, conic_joining_cost *cost) {
  double normal[3], d;
  if (!(both->area > 0.0))
    return;
  conic_face_sums_plane(both, normal, &d);
  double fit = (form(both->second, normal) + 2.0 * d * conic_dot(normal, both->first)) / both->area + d * d;
  double direction = 1.0 + (form(both->normals, normal) - 2.0 * conic_dot(normal, both->normal)) / both->area;
  cost->fit = fit > 0.0 ? fit : 0.0;
  cost->direction = direction > 0.0 ? direction : 0.0;
}
