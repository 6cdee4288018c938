/* The direction in which samples spread least. */
#pragma once

/* A right-handed frame whose third row is the unit eigenvector of the least eigenvalue of the covariance {xx, xy, xz,
 * yy, yz, zz}. For equal eigenvalues it is any of their eigenvectors. */
void conic_least_spread(const double covariance[6], double frame[3][3]);
