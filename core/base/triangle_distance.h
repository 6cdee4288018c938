/* How far a point is from a triangle. */
#pragma once

/* The squared distance of p from the triangle a, b, c with its border; NaN for a triangle without area. */
double conic_distance2_to_triangle(const double p[3], const double a[3], const double b[3], const double c[3]);
