/* Eigenvalues and eigenvectors of small symmetric matrices, with the same bits everywhere. */
#pragma once

/* For [[xx, xy], [xy, yy]]: values[0] ≥ values[1], the roots of λ² - trace·λ + det = 0. `major` is the unit eigenvector
 * of values[0] with x > 0, or x = 0 and y > 0; that of values[1] is (-major[1], major[0]). For two equal values,
 * `major` is (1, 0). */
void conic_eigen2(double xx, double xy, double yy, double values[2], double major[2]);

/* For the symmetric 3 × 3 matrix {xx, xy, xz, yy, yz, zz}: values in descending order, vectors[i] the unit eigenvector
 * of values[i], its first component of greatest magnitude positive. Input that is not finite gives such output. */
void conic_eigen3(const double matrix[6], double values[3], double vectors[3][3]);
