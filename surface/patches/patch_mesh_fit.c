/* Patches through a mesh's vertices: about each side of a vertex, the polynomial through it and across its normal that
 * comes nearest to the vertices around it and to their normals, and where it ends. */

#include "core/base/vectors.h"
#include "core/splats/ellipse.h"
#include "surface/patches/patch_mesh.h"

/* The coefficients from x² on: of degree 2, and of degree 3. */
enum { N_SQUARES = 3, N_CUBES = 7 };

/* A patch covers the vertex's share of its triangles, enlarged by this, so that neighbours blend; and the outlines of
 * its samples reach farther by this. */
static const double OVERLAP = 1.2, OVERHANG = 1.4;

/* The least ratio of a patch's axes. */
static const double LEAST_RATIO = 0.01;

/* A polynomial may be steeper at its rim than the mesh's normals are around it by this factor, and by this. */
static const double MOST_OVERSHOOT = 2.0, FREE_SLOPE = 0.1;

/* A crease has a direction where the sine of the angle between its normals is as great. */
static const double LEAST_CREASE = 0.1;

/* A crease's curve is one no farther than so many lengths of its edge. */
static const double MOST_WIDTH = 1.5;

typedef struct vertex_fit {
  const conic_patch_mesh *mesh;
  size_t begin, end;            /* the side's corners */
  double frame[3][3], radii[2]; /* of the patch's ellipse; the first radius is the polynomial's unit of length */
  double greatest_slope;
  double sums[N_CUBES][N_CUBES + 1]; /* the normal equations, … */
  double sum2;                       /* … and the squares of what they are for */
} vertex_fit;

static void see(const vertex_fit *fit, const double d[3], double seen[3]) {
  for (int i = 0; i < 3; i++)
    seen[i] = conic_dot(fit->frame[i], d);
}

/* What the vertex has of a triangle: up to the middles of two edges and of the triangle. */
static void see_share(const vertex_fit *fit, size_t i, conic_patch_corner *c, double seen[2][3], double share[3][2]) {
  conic_patch_mesh_corner(fit->mesh, fit->mesh->corners[i], c);
  see(fit, c->offsets[1], seen[0]);
  see(fit, c->offsets[2], seen[1]);
  for (int axis = 0; axis < 2; axis++) {
    share[0][axis] = 0.5 * seen[0][axis];
    share[1][axis] = 0.5 * seen[1][axis];
    share[2][axis] = (seen[0][axis] + seen[1][axis]) / 3.0;
  }
}

/* Lays the ellipse over the vertex's shares of its triangles. Returns 0 where these have no extent. */
static int lay_ellipse(vertex_fit *fit) {
  double covariance[3] = {0.0, 0.0, 0.0}, seen[2][3], share[3][2];
  float axes[2][3];
  conic_patch_corner c;
  for (size_t i = fit->begin; i < fit->end; i++) {
    see_share(fit, i, &c, seen, share);
    for (int k = 0; k < 3; k++)
      conic_ellipse_add(covariance, share[k][0], share[k][1]);
  }
  conic_ellipse ellipse = conic_ellipse_shape(covariance, LEAST_RATIO);
  for (size_t i = fit->begin; i < fit->end; i++) {
    see_share(fit, i, &c, seen, share);
    for (int k = 0; k < 3; k++)
      conic_ellipse_cover(&ellipse, share[k][0], share[k][1]);
  }
  ellipse.reach *= OVERLAP;
  fit->radii[0] = ellipse.reach;
  fit->radii[1] = ellipse.reach * ellipse.ratio;
  if (!conic_ellipse_axes(&ellipse, fit->frame[0], fit->frame[1], 1.0, axes[0], axes[1]))
    return 0;
  for (int i = 0; i < 6; i++)
    fit->frame[i / 3][i % 3] = (double)axes[i / 3][i % 3];
  return conic_normalize(fit->frame[0]) && conic_normalize(fit->frame[1]);
}

/* --- where the patch ends --- */

static void add_line(const vertex_fit *fit, conic_patch_fence *fence, const double across[2], double off,
                     const double along[2], double bend) {
  float *line = fence->lines[fence->n_lines++];
  for (int i = 0; i < 2; i++) {
    line[i] = (float)(fit->radii[i] * across[i]);
    line[3 + i] = (float)(fit->radii[i] * along[i]);
  }
  line[2] = (float)off;
  line[5] = (float)bend;
}

/* The direction of the crease along the edge to the other end `slot`, which is `edge` in the patch's plane. It is the
 * edge's along a border, where the other end has no patches, and where the patch is far wider than the edge is long. */
static void find_direction(const vertex_fit *fit, size_t vertex, uint32_t slot, const double edge[3], double along[2]) {
  const conic_patch_mesh *mesh = fit->mesh;
  double length2 = edge[0] * edge[0] + edge[1] * edge[1], seen[3];
  conic_patch_corner c;
  along[0] = edge[0] / sqrt(length2);
  along[1] = edge[1] / sqrt(length2);
  for (size_t i = mesh->starts[vertex]; i < mesh->starts[vertex + 1]; i++) {
    if ((i >= fit->begin && i < fit->end) || !conic_patch_mesh_corner(mesh, mesh->corners[i], &c) ||
        (c.slots[1] != slot && c.slots[2] != slot))
      continue;
    see(fit, c.normals[0], seen); /* this side's normal is the third axis */
    double sine = sqrt(seen[0] * seen[0] + seen[1] * seen[1]),
           sign = seen[0] * edge[1] < seen[1] * edge[0] ? -1.0 : 1.0;
    double on = sign * (seen[0] * edge[1] - seen[1] * edge[0]) / sine;
    double wide[2] = {fit->radii[0] * seen[1] / sine, fit->radii[1] * seen[0] / sine};
    if (sine >= LEAST_CREASE && 2.0 * on * on >= length2 && mesh->n_sides[slot] &&
        wide[0] * wide[0] + wide[1] * wide[1] <= MOST_WIDTH * MOST_WIDTH * on * on) {
      along[0] = -sign * seen[1] / sine;
      along[1] = sign * seen[0] / sine;
    }
    return;
  }
}

/* Lays a curve through the vertex and the other end of a crease's or a border's edge. */
static void lay_ray(const vertex_fit *fit, size_t vertex, uint32_t corner, int k, conic_patch_fence *fence,
                    double along[2]) {
  conic_patch_corner c;
  double edge[3], inside[3];
  conic_patch_mesh_corner(fit->mesh, corner, &c);
  see(fit, c.offsets[k], edge);
  see(fit, c.offsets[3 - k], inside);
  find_direction(fit, vertex, c.slots[k], edge, along);
  double sign = along[0] * inside[1] < along[1] * inside[0] ? -1.0 : 1.0;
  const double across[2] = {-sign * along[1], sign * along[0]};
  double on = edge[0] * along[0] + edge[1] * along[1], off = edge[0] * across[0] + edge[1] * across[1];
  add_line(fit, fence, across, 0.0, along, off / (on * on));
}

/* The outer edges beside a vertex on a crease or a border, over which the patch would reach. Returns 0 where lines
 * cannot keep it from there, or would cut off some of the vertex's share. */
static int lay_outer_edges(const vertex_fit *fit, conic_patch_fence *fence) {
  static const double straight[2] = {0.0, 0.0};
  double seen[2][3], share[3][2];
  conic_patch_corner c;
  int n_rays = fence->n_lines;
  for (size_t i = fit->begin; i < fit->end; i++) {
    see_share(fit, i, &c, seen, share);
    if (fit->mesh->is_smooth[c.slots[1]] && fit->mesh->is_smooth[c.slots[2]])
      continue;
    double across[2] = {seen[0][1] - seen[1][1], seen[1][0] - seen[0][0]};
    double off = -(across[0] * seen[0][0] + across[1] * seen[0][1]), sign = off < 0.0 ? -1.0 : 1.0;
    double reach[2] = {across[0] * fit->radii[0], across[1] * fit->radii[1]};
    if (OVERHANG * OVERHANG * (reach[0] * reach[0] + reach[1] * reach[1]) <= off * off)
      continue;
    across[0] *= sign;
    across[1] *= sign;
    if (fence->is_either || fence->n_lines == CONIC_MOST_FENCE_LINES)
      return 0;
    add_line(fit, fence, across, sign * off, straight, 0.0);
  }
  for (size_t i = fit->begin; i < fit->end && fence->n_lines > n_rays; i++) {
    see_share(fit, i, &c, seen, share);
    for (int k = 0; k < 3 * fence->n_lines; k++) {
      const float *line = fence->lines[k / 3];
      if (k / 3 >= n_rays && (double)line[0] / fit->radii[0] * share[k % 3][0] +
                                     (double)line[1] / fit->radii[1] * share[k % 3][1] + (double)line[2] <
                                 0.0)
        return 0;
    }
  }
  return 1;
}

static int lay_fence(const vertex_fit *fit, size_t vertex, conic_patch_fence *fence) {
  uint32_t rays[2];
  int others[2], n_rays = conic_patch_mesh_bound_side(fit->mesh, fit->begin, fit->end, rays, others);
  double along[2][2];
  memset(fence, 0, sizeof *fence);
  for (int i = 0; i < n_rays; i++)
    lay_ray(fit, vertex, rays[i], others[i], fence, along[i]);
  if (n_rays == 2) { /* a side of over 180° is what either keeps */
    double to[2] = {along[1][0] / fit->radii[0], along[1][1] / fit->radii[1]};
    fence->is_either = (double)fence->lines[0][0] * to[0] + (double)fence->lines[0][1] * to[1] < -0.05;
  }
  return lay_outer_edges(fit, fence);
}

/* --- the polynomial --- */

/* Adds the equation Σ c_k row_k = value. */
static void add_equation(vertex_fit *fit, const double row[N_CUBES], double value) {
  for (int i = 0; i < N_CUBES; i++) {
    for (int j = 0; j < N_CUBES; j++)
      fit->sums[i][j] += row[i] * row[j];
    fit->sums[i][N_CUBES] += row[i] * value;
  }
  fit->sum2 += value * value;
}

/* The polynomial has the height and the slopes of a vertex around. */
static void add_vertex(vertex_fit *fit, const double offset[3], const double normal[3]) {
  double d[3], n[3];
  see(fit, offset, d);
  see(fit, normal, n);
  double x = d[0] / fit->radii[0], y = d[1] / fit->radii[0], slopes[2] = {-n[0] / n[2], -n[1] / n[2]};
  const double heights[N_CUBES] = {x * x, x * y, y * y, x * x * x, x * x * y, x * y * y, y * y * y};
  const double along[N_CUBES] = {2.0 * x, y, 0.0, 3.0 * x * x, 2.0 * x * y, y * y, 0.0};
  const double across[N_CUBES] = {0.0, x, 2.0 * y, 0.0, x * x, 2.0 * x * y, 3.0 * y * y};
  add_equation(fit, heights, d[2] / fit->radii[0]);
  add_equation(fit, along, slopes[0]);
  add_equation(fit, across, slopes[1]);
  double slope = sqrt(slopes[0] * slopes[0] + slopes[1] * slopes[1]);
  fit->greatest_slope = slope > fit->greatest_slope ? slope : fit->greatest_slope;
}

/* Solves for the first n coefficients; what the equations leave open stays near 0. */
static void solve(const vertex_fit *fit, int n, double *coefficients) {
  double a[N_CUBES][N_CUBES + 1], trace = 0.0;
  memcpy(a, fit->sums, sizeof a);
  for (int i = 0; i < n; i++)
    trace += a[i][i];
  for (int i = 0; i < n; i++)
    a[i][i] += 1e-9 * trace;
  for (int i = 0; i < n; i++)
    for (int row = i + 1; row < n; row++) {
      double factor = a[row][i] / a[i][i];
      for (int j = i; j <= N_CUBES; j++)
        a[row][j] -= factor * a[i][j];
    }
  for (int i = n - 1; i >= 0; i--) {
    double sum = a[i][N_CUBES];
    for (int j = i + 1; j < n; j++)
      sum -= a[i][j] * coefficients[j];
    coefficients[i] = sum / a[i][i];
  }
}

int conic_patch_mesh_fit(const conic_patch_mesh *mesh, size_t vertex, size_t begin, size_t end, int degree,
                         conic_fit *to, double radii[2], conic_patch_fence *fence) {
  vertex_fit fit = {.mesh = mesh, .begin = begin, .end = end};
  conic_patch_corner c;
  conic_patch_mesh_corner(mesh, mesh->corners[begin], &c);
  memcpy(fit.frame[2], c.normals[0], sizeof fit.frame[2]);
  conic_tangent_basis(fit.frame[2], fit.frame[0], fit.frame[1]);
  if (!lay_ellipse(&fit) || !lay_fence(&fit, vertex, fence))
    return 0;
  for (size_t i = begin; i < end; i++) {
    conic_patch_mesh_corner(mesh, mesh->corners[i], &c);
    for (int k = 1; k < 3; k++)
      add_vertex(&fit, c.offsets[k], c.normals[k]);
  }
  memset(to, 0, sizeof *to);
  memcpy(to->frame, fit.frame, sizeof to->frame);
  memcpy(radii, fit.radii, sizeof fit.radii);
  for (int most = degree < 3 ? degree : 3; most > 0; most--) {
    memset(to->coefficients, 0, sizeof to->coefficients);
    if (most > 1)
      solve(&fit, most == 2 ? N_SQUARES : N_CUBES, to->coefficients + 3);
    if (conic_fit_steepest(to, degree, 1.0, radii[1] / radii[0]) <= MOST_OVERSHOOT * fit.greatest_slope + FREE_SLOPE) {
      for (int k = 0; k < N_CUBES; k++)
        fit.sum2 -= to->coefficients[3 + k] * fit.sums[k][N_CUBES];
      fence->off = (float)(radii[0] * sqrt(fit.sum2 > 0.0 ? fit.sum2 / (double)(6 * (end - begin)) : 0.0));
      return 1;
    }
  }
  return 0;
}
