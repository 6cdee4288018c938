/* Splats as 2D and 3D Gaussian splatting store them: logarithmic scales, quaternions, logits, harmonics. */
#pragma once

/* e^x with the same bits on every machine; relative error under 4e-16, 0 below -745.2, infinity above 709.8. */
double conic_gaussian_exp(double x);

/* 1 / (1 + e^-x). */
double conic_gaussian_opacity(double logit);

/* The linear colour of the constant spherical harmonic's coefficient, at least 0. */
double conic_gaussian_color(double harmonic);

/* Tangent axes of an ellipsoid (n_scales 3: the two longer axes; the shortest is the normal, the first of equals) or of
 * an ellipse (2: the first two). `rotation` is a quaternion w, x, y, z of any length; a zero one gives zero axes. */
void conic_gaussian_axes(const double log_scales[3], int n_scales, const double rotation[4], double tangent_u[3],
                         double tangent_v[3]);
