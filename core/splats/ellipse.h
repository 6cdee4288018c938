/* Ellipses in tangent planes that bound given points (Confetti §4.3, with the corrections of docs/notes/errata.md).
 */
#pragma once

/* Two unit vectors that make a right-handed orthonormal basis with the unit normal: u × v = n. Stable for every n. */
void conic_tangent_basis(const double normal[3], double u[3], double v[3]);

/* An ellipse around the origin of a plane. */
typedef struct conic_ellipse {
  double major[2]; /* unit direction of the major axis */
  double ratio;    /* of the minor to the major axis, 0 to 1 */
  double reach;    /* length of the major half axis */
} conic_ellipse;

/* Adds a point to the sums xx, xy, yy about the origin. */
static inline void conic_ellipse_add(double covariance[3], double x, double y) {
  covariance[0] += x * x;
  covariance[1] += x * y;
  covariance[2] += y * y;
}

/* The directions and the ratio of that covariance (of any factor), without reach. The ratio is at least `least_ratio`,
 * which is above 0. */
conic_ellipse conic_ellipse_shape(const double covariance[3], double least_ratio);

/* Makes the ellipse just large enough for (x, y) too. */
void conic_ellipse_cover(conic_ellipse *ellipse, double x, double y);

/* The ellipse of the points' covariance that covers all of them. */
conic_ellipse conic_ellipse_bound(const double (*points)[2], int n_points, double least_ratio);

/* Where the ellipse reaches past `limit`, widens it across until it covers the points without; they lie within `limit`
 * themselves. */
void conic_ellipse_retract(conic_ellipse *ellipse, const double (*points)[2], int n_points, double limit);

/* Enlarges an ellipse that covers a cell so that it overlaps its neighbours: by the factor `cover` at least, and until
 * its area is π·blend² times the cell's, but not past `greatest_reach` for the latter's sake. */
void conic_ellipse_overlap(conic_ellipse *ellipse, double cell_area, double cover, double blend, double greatest_reach);

/* The tangent axes of the ellipse in the plane of (u, v), `sigmas` standard deviations its outline. Returns 0, and NaN
 * axes, where they are not positive and finite. */
int conic_ellipse_axes(const conic_ellipse *ellipse, const double u[3], const double v[3], double sigmas,
                       float tangent_u[3], float tangent_v[3]);
