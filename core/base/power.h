/* Logarithms, powers and cube roots in double with the same bits on every machine; C libraries differ. Only + − × ÷ and
 * changes of the exponent are used. */
#pragma once

/* ln v for a finite v > 0, with an absolute or relative error of 1e-15, whichever is larger. */
double conic_logarithm(double v);

/* base^exponent for a finite base ≥ 0 and a finite exponent > 0; relative error under 2e-15·(1 + |exponent·ln base|).
 */
double conic_power(double base, double exponent);

/* The cube root of v > 0, up to 1e60; relative error under 1e-15. */
double conic_cube_root(double v);

/* A positive number whose logarithm is about 1/n of v's: a start for Newton's iteration. */
double conic_root_guess(double v, int n);
