/* Sine, cosine, tangent in double with the same bits on every machine; C libraries differ. The error is at most 1 ulp
 * of 1 for |x| up to 1e5 radians; only + − × ÷ are used. NaN and infinity give NaN. */
#pragma once

#define CONIC_PI 3.14159265358979323846

double conic_sin(double x_rad);
double conic_cos(double x_rad);
double conic_tan(double x_rad);
/* The angle of (x, y), from -π to π; 0 of (0, 0). Off by 1e-14 at most; √, too, is used. */
double conic_angle(double y, double x);

static inline double conic_radians(double degrees) {
  return degrees * (CONIC_PI / 180.0);
}
