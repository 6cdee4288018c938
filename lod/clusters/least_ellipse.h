/* The smallest ellipse about points of a plane. */
#ifndef CONIC_LEAST_ELLIPSE_H
#define CONIC_LEAST_ELLIPSE_H

enum { CONIC_LEAST_ELLIPSE_POINTS = 8 };

/* The centre, and the shape as a covariance xx, xy, yy of any factor, of an ellipse about the points that is nearly the
 * smallest; n_points is 1 to CONIC_LEAST_ELLIPSE_POINTS. How large it is, the points themselves must say. */
void conic_least_ellipse(const double (*points)[2], int n_points, double center[2], double covariance[3]);

#endif
