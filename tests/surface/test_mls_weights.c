/* The plane's sums and their derivatives against differences, the weights, and the least spread. */
#include "core/base/eigen.h"
#include "core/base/gaussian.h"
#include "surface/least_spread.h"
#include "tests/support/bent_sheet.h"
#include "tests/support/check.h"

enum { MOST = 100 };

static conic_near allocate(void) {
  conic_near near = {0};
  for (int axis = 0; axis < 3; axis++) {
    near.offset[axis] = malloc(MOST * sizeof(double));
    near.normal[axis] = malloc(MOST * sizeof(double));
  }
  near.mass = malloc(MOST * sizeof(double));
  near.inverse_h2 = malloc(MOST * sizeof(double));
  near.weights = malloc(MOST * sizeof(double));
  near.columns = malloc(MOST * CONIC_MAX_COLUMNS * sizeof(double));
  return near;
}

static void release(conic_near *near) {
  for (int axis = 0; axis < 3; axis++) {
    free(near->offset[axis]);
    free(near->normal[axis]);
  }
  free(near->mass);
  free(near->inverse_h2);
  free(near->weights);
  free(near->columns);
}

/* n tilted by a and b, t moved; the plane's sums there. */
static void sums_at(conic_near *near, const conic_weighing *weighing, double a, double b, double t, double *sums) {
  double tilted[3][3], length = sqrt(1.0 + a * a + b * b), along = 0.0, length2 = 0.0;
  for (int axis = 0; axis < 3; axis++) {
    tilted[2][axis] =
        (bent_sheet_frame[2][axis] + a * bent_sheet_frame[0][axis] + b * bent_sheet_frame[1][axis]) / length;
    along += tilted[2][axis] * bent_sheet_frame[0][axis];
  }
  for (int axis = 0; axis < 3; axis++) {
    tilted[0][axis] = bent_sheet_frame[0][axis] - along * tilted[2][axis];
    length2 += tilted[0][axis] * tilted[0][axis];
  }
  for (int axis = 0; axis < 3; axis++)
    tilted[0][axis] /= sqrt(length2);
  for (int axis = 0; axis < 3; axis++) {
    int next = (axis + 1) % 3, last = (axis + 2) % 3;
    tilted[1][axis] = tilted[2][next] * tilted[0][last] - tilted[2][last] * tilted[0][next];
  }
  conic_surface_loops loops;
  conic_surface_loops_init(&loops, CONIC_ISA_SCALAR);
  loops.plane(near, weighing, tilted, t, sums);
}

/* The derivative by t is Eq. 6 as corrected (docs/notes/errata.md): with the printed sign and exponent this fails.
 */
static void check_derivatives(void) {
  conic_near near = allocate();
  const double t = 0.15, d = 1e-5;
  bent_sheet_fill(&near, 40, 5);
  for (int weight = CONIC_WEIGHT_GAUSS; weight <= CONIC_WEIGHT_FLAT; weight++) {
    conic_weighing weighing = bent_sheet_weighing((conic_surface_weight)weight, 2.0);
    double here[CONIC_N_PLANE_SUMS], low[3][CONIC_N_PLANE_SUMS], high[3][CONIC_N_PLANE_SUMS];
    sums_at(&near, &weighing, 0.0, 0.0, t, here);
    for (int k = 0; k < 3; k++) {
      sums_at(&near, &weighing, k == 0 ? -d : 0.0, k == 1 ? -d : 0.0, k == 2 ? t - d : t, low[k]);
      sums_at(&near, &weighing, k == 0 ? d : 0.0, k == 1 ? d : 0.0, k == 2 ? t + d : t, high[k]);
    }
    CHECK_NEAR(-2.0 * here[2], (high[2][11] - low[2][11]) / (2.0 * d), 1e-7); /* Eq. 6 */
    static const int slopes[3][3] = {{3, 4, 6}, {4, 5, 7}, {8, 9, 10}};       /* of G_a, G_b, K by a, b, t */
    for (int row = 0; row < 3; row++)
      for (int k = 0; k < 3; k++)
        CHECK_NEAR(here[slopes[row][k]], (high[k][row] - low[k][row]) / (2.0 * d), 1e-6);
  }
  release(&near);
}

static void check_weights(void) {
  conic_weighing gauss = bent_sheet_weighing(CONIC_WEIGHT_GAUSS, 2.0),
                 compact = bent_sheet_weighing(CONIC_WEIGHT_COMPACT, 2.0),
                 flat = bent_sheet_weighing(CONIC_WEIGHT_FLAT, 2.0);
  for (double s = 0.0; s < 36.0; s += 0.01)
    CHECK_NEAR(conic_weight_exp(s) / conic_gaussian_exp(-s), 1.0, 1e-14);
  CHECK_NEAR(conic_weight_at(&gauss, 0.0).value, 1.0 - 5.0 * exp(-4.0), 1e-14); /* less the tangent at 4 */
  CHECK(conic_weight_at(&compact, 0.0).value == 1.0 && conic_weight_at(&flat, 0.0).value == 1.0);
  CHECK_NEAR(conic_weight_at(&flat, 1.0).value, 225.0 / 256.0, 1e-15); /* (1 - 2⁻⁴)² */
  CHECK(conic_weight_at(&flat, 4.0).value == 0.0 && conic_weight_at(&flat, 1e300).value == 0.0);
  CHECK_NEAR(conic_weight_at(&flat, 4.0 - 1e-9).first, 0.0, 1e-9);
  CHECK(conic_weight_at(&gauss, 4.0).value == 0.0 && conic_weight_at(&compact, 4.0).value == 0.0);
  CHECK(conic_weight_at(&gauss, 1e300).value == 0.0 && conic_weight_at(&compact, 1e300).value == 0.0);
  /* They end smoothly. */
  CHECK_NEAR(conic_weight_at(&gauss, 4.0 - 1e-9).first, 0.0, 1e-10);
  CHECK_NEAR(conic_weight_at(&compact, 4.0 - 1e-9).first, 0.0, 1e-9);
  /* The stated bound of what the neglect distance changes: (1 + c²) e^(-c²) of the peak. */
  for (double c = 1.0; c <= 6.0; c += 0.5) {
    conic_weighing weighing = bent_sheet_weighing(CONIC_WEIGHT_GAUSS, c);
    for (double s = 0.0; s < c * c; s += 0.01)
      CHECK(fabs(conic_weight_at(&weighing, s).value - exp(-s)) <= (1.0 + c * c) * exp(-c * c) + 1e-14);
  }
}

/* The least spread by Newton's steps against Jacobi's rotations: flat, thick, thin as a thread, and alike all round. */
static void check_least_spread(void) {
  uint64_t seed = 4;
  for (int i = 0; i < 3000; i++) {
    double m[6] = {0}, frame_found[3][3], values[3], vectors[3][3], apart2 = 0.0, length2 = 0.0;
    double sizes[3] = {1.0, i % 3 == 1 ? 1e-4 : 0.7, i % 3 == 2 ? 0.69999 : 1e-3 * random_unit(&seed)};
    double scale = i % 7 ? 1.0 : 1e-14;
    for (int k = 0; k < 12; k++) {
      double p[3] = {0}, axes[3][3] = {{0.36, 0.48, -0.8}, {-0.8, 0.6, 0.0}, {0.48, 0.64, 0.6}};
      for (int j = 0; j < 3; j++) {
        double size = sizes[j] * (2.0 * random_unit(&seed) - 1.0);
        for (int axis = 0; axis < 3; axis++)
          p[axis] += size * axes[j][axis];
      }
      for (int row = 0, at = 0; row < 3; row++)
        for (int column = row; column < 3; column++)
          m[at++] += scale * p[row] * p[column];
    }
    conic_least_spread(m, frame_found);
    conic_eigen3(m, values, vectors);
    for (int axis = 0; axis < 3; axis++) {
      int next = (axis + 1) % 3, last = (axis + 2) % 3;
      double across = frame_found[2][next] * vectors[2][last] - frame_found[2][last] * vectors[2][next];
      apart2 += across * across;
      length2 += frame_found[2][axis] * frame_found[2][axis];
    }
    double gap = (values[1] - values[2]) / values[0];
    CHECK_NEAR(length2, 1.0, 1e-14);
    CHECK_NEAR(sqrt(apart2), 0.0, 1e-14 / gap); /* rounding turns a vector by so much */
    for (int j = 0; j < 2; j++) {
      double upright = 0.0, unit = 0.0;
      for (int axis = 0; axis < 3; axis++) {
        upright += frame_found[j][axis] * frame_found[2][axis];
        unit += frame_found[j][axis] * frame_found[j][axis];
      }
      CHECK_NEAR(upright, 0.0, 1e-14);
      CHECK_NEAR(unit, 1.0, 1e-13);
    }
  }
  /* Nothing to go by is no reason to fail. */
  double none[6] = {0}, ball[6] = {1, 0, 0, 1, 0, 1}, found[3][3];
  conic_least_spread(none, found);
  conic_least_spread(ball, found);
  CHECK_NEAR(found[2][0] * found[2][0] + found[2][1] * found[2][1] + found[2][2] * found[2][2], 1.0, 1e-14);
}

int main(void) {
  check_least_spread();
  check_derivatives();
  check_weights();
  return check_result();
}
