/* The smallest ellipse about points of a plane. */
#ifndef CONIC_LEAST_ELLIPSE_H
#define CONIC_LEAST_ELLIPSE_H

enum { CONIC_LEAST_ELLIPSE_POINTS = 8 };

/* Finds nearly the smallest ellipse about the points, 1 to CONIC_LEAST_ELLIPSE_POINTS: its centre, and its shape as a
 * covariance xx, xy, yy up to a factor. How large it is, the points themselves must say. */
void conic_least_ellipse(const double (*points)[2], int n_points, double center[2], double covariance[3]);

#endif
