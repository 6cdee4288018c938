/* The sums over a point's neighbours: what a projection spends its time on, once in plain C and once in vectors.
 *
 * Every sum is of eight partial ones: neighbour i is added to number i mod 8, and these are added as
 * ((0 + 4) + (2 + 6)) + ((1 + 5) + (3 + 7)). So vectors of any width give the plain loop's bits. */
#ifndef CONIC_SURFACE_LOOPS_H
#define CONIC_SURFACE_LOOPS_H

#include <stddef.h>
#include <stdint.h>

#include "conic/surface.h"
#include "core/lanes/instruction_sets.h"

#define CONIC_NEAR_LANES 8

/* Coefficients of degree 4, and the right-hand side. */
#define CONIC_MAX_COEFFICIENTS 15
#define CONIC_MAX_COLUMNS (CONIC_MAX_COEFFICIENTS + 1)

/* The neighbours of one point r, relative to it; arrays of n_padded, a multiple of eight, the last ones with mass 0. */
typedef struct conic_near {
  size_t n, n_padded, capacity;
  double *offset[3];
  double *mass;
  double *inverse_h2;
  double *normal[3]; /* where the surface needs them, else null */
  double *weights;   /* of the last `moments` or `sphere` */
  double *columns;   /* CONIC_MAX_COLUMNS of n_padded */
  uint32_t *sources; /* slots, or clusters */
} conic_near;

/* θ as a function of s = d² / h². */
typedef struct conic_weighing {
  conic_surface_weight weight;
  double end;  /* neglect², where it becomes 0 */
  double edge; /* exp(-end) */
} conic_weighing;

enum { CONIC_MOMENT_COUNT = 10, CONIC_N_MOMENTS = 11 };
enum { CONIC_N_PLANE_SUMS = 12 };
enum { CONIC_N_SPHERE_SUMS = 10 };

typedef struct conic_surface_loops {
  /* Weights about q (relative to r), and the sums of w, w·d (3), w·d·dᵀ (xx xy xz yy yz zz) with d from q, and how many
   * weigh something. */
  void (*moments)(conic_near *near, const conic_weighing *weighing, const double q[3], double sums[CONIC_N_MOMENTS]);
  /* The plane through q = t·n with the frame's third row as n, and what must vanish there: G, the energy's derivative
   * by tilts of n while q and the weights stay, and K, -½ of that by t. Their derivatives by (a, b, t), where n tilts
   * by a and b towards the frame's other rows and takes q along: G_a, G_b, K, G_aa, G_ab, G_bb, G_at, G_bt, K_a, K_b,
   * K_t; the last is the energy. */
  void (*plane)(const conic_near *near, const conic_weighing *weighing, double frame[3][3], double t,
                double sums[CONIC_N_PLANE_SUMS]);
  /* The triangular factor of the weighted monomials over the plane, times `scale`, up to `degree`, and of the heights
   * as the last column, by modified Gram-Schmidt: upper[j][k] for k > j; norms2[j] of what is left of column j, and
   * before2[j] of the whole column. */
  void (*factor)(conic_near *near, double frame[3][3], double t, double scale, int degree,
                 double upper[CONIC_MAX_COLUMNS][CONIC_MAX_COLUMNS], double norms2[CONIC_MAX_COLUMNS],
                 double before2[CONIC_MAX_COLUMNS]);
  /* Weights about q, and the sums of w, w·d (3), w·n (3), w·d·d, w·d·n with d from q, and how many weigh something. */
  void (*sphere)(conic_near *near, const conic_weighing *weighing, const double q[3], double sums[CONIC_N_SPHERE_SUMS]);
} conic_surface_loops;

CONIC_DECLARE_LOOPS(conic_surface_loops);

/* Monomials up to the degree. */
static inline int conic_n_coefficients(int degree) {
  return (degree + 1) * (degree + 2) / 2;
}

#endif
