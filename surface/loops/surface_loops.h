/* The sums over a point's neighbours, which take most of a projection's time; once in plain C and once in vectors.
 *
 * Every sum has eight partial sums: neighbour i is added to number i mod 8, and these are added as ((0 + 4) + (2 + 6))
 * + ((1 + 5) + (3 + 7)). So vectors of any width give the plain loop's bits. */
#pragma once

#include "conic/surface.h"
#include "core/base/base.h"
#include "core/lanes/instruction_sets.h"

#define CONIC_NEAR_LANES 8

/* The coefficients of degree 4; and with the right-hand side. */
#define CONIC_MAX_COEFFICIENTS 15
#define CONIC_MAX_COLUMNS (CONIC_MAX_COEFFICIENTS + 1)

/* The neighbours of a point r, relative to it: arrays of n_padded, a multiple of eight; the last ones have mass 0. */
typedef struct conic_near {
  size_t n, n_padded, capacity;
  double *offset[3];
  double *mass;
  double *inverse_h2;
  double *normal[3]; /* null if the surface does not need them */
  double *weights;   /* as the last `moments` or `sphere` left them */
  double *columns;   /* CONIC_MAX_COLUMNS of n_padded */
  uint32_t *sources; /* slots, or clusters */
} conic_near;

/* θ as a function of s = d² / h². */
typedef struct conic_weighing {
  conic_surface_weight weight;
  double end;  /* neglect², where θ becomes 0 */
  double edge; /* exp(-end) */
} conic_weighing;

enum { CONIC_MOMENT_COUNT = 10, CONIC_N_MOMENTS = 11 };
enum { CONIC_N_PLANE_SUMS = 12 };
enum { CONIC_N_SPHERE_SUMS = 10 };

typedef struct conic_surface_loops {
  /* Makes those of `all`, whose offsets are places and whose inverse_h2 are scales, the neighbours of r that are nearer
   * to it than `neglect` scales of theirs and the margin, without the source `except`. A scale that is NaN is near
   * nothing; one of 0 has the inverse 0. */
  void (*select)(const conic_near *all, const double r[3], double neglect, double margin, uint32_t except,
                 conic_near *near);
  /* Fills in the weights about q (relative to r), and sums of w, w·d (3) and w·d·dᵀ (xx xy xz yy yz zz), d being
   * relative to q, and the number of neighbours with weight. */
  void (*moments)(conic_near *near, const conic_weighing *weighing, const double q[3], double sums[CONIC_N_MOMENTS]);
  /* For the plane through q = t·n, with n the frame's third row, sums the functions that must vanish: G, the derivative
   * of the energy by tilts of n with q and the weights fixed, and K, -½ of its derivative by t. Then their derivatives
   * by (a, b, t), where n tilts by a and b towards the frame's other rows and q moves with it: G_a, G_b, K, G_aa, G_ab,
   * G_bb, G_at, G_bt, K_a, K_b, K_t; last the energy. */
  void (*plane)(const conic_near *near, const conic_weighing *weighing, double frame[3][3], double t,
                double sums[CONIC_N_PLANE_SUMS]);
  /* The triangular factor of the weighted monomials over the plane, times `scale`, up to `degree`, with the heights as
   * the last column, by modified Gram-Schmidt. upper[j][k] for k > j; norms2[j] is the squared rest of column j,
   * before2[j] that of the whole column. */
  void (*factor)(conic_near *near, double frame[3][3], double t, double scale, int degree,
                 double upper[CONIC_MAX_COLUMNS][CONIC_MAX_COLUMNS], double norms2[CONIC_MAX_COLUMNS],
                 double before2[CONIC_MAX_COLUMNS]);
  /* Fills in the weights about q, and sums of w, w·d (3), w·n (3), w·d·d and w·d·n, d being relative to q, and the
   * number of neighbours with weight. */
  void (*sphere)(conic_near *near, const conic_weighing *weighing, const double q[3], double sums[CONIC_N_SPHERE_SUMS]);
} conic_surface_loops;

CONIC_DECLARE_LOOPS(conic_surface_loops);

/* Monomials up to the degree. */
static inline int conic_n_coefficients(int degree) {
  return (degree + 1) * (degree + 2) / 2;
}
