/* θ, a sample's weight, and its derivatives: plain code that the vector bodies repeat operation by operation. */
#pragma once

#include "surface/loops/surface_loops.h"

/* log₂ e; 1.5·2⁵², which rounds a sum to an integer; ln 2 in two parts, so that k times the first is exact. */
#define CONIC_WEIGHT_LOG2E 0x1.71547652b82fep+0
#define CONIC_WEIGHT_ROUND 0x1.8p+52
#define CONIC_WEIGHT_LN2_HIGH 0x1.62e42fee00000p-1
#define CONIC_WEIGHT_LN2_LOW 0x1.a39ef35793c76p-33

/* Taylor's series of the exponential: for |r| < 0.347 the omitted terms are under 7e-15, 9e-15 of the least value. */
#define CONIC_EXP_2 (1.0 / 2.0)
#define CONIC_EXP_3 (1.0 / 6.0)
#define CONIC_EXP_4 (1.0 / 24.0)
#define CONIC_EXP_5 (1.0 / 120.0)
#define CONIC_EXP_6 (1.0 / 720.0)
#define CONIC_EXP_7 (1.0 / 5040.0)
#define CONIC_EXP_8 (1.0 / 40320.0)
#define CONIC_EXP_9 (1.0 / 362880.0)
#define CONIC_EXP_10 (1.0 / 3628800.0)
#define CONIC_EXP_11 (1.0 / 39916800.0)

/* The compact weight's second derivative grows without bound; below this it stays constant. */
#define CONIC_WEIGHT_LEAST 1e-30

typedef struct conic_theta {
  double value, first, second; /* derivatives by s */
} conic_theta;

/* e^-s for 0 ≤ s ≤ 700; relative error under 1e-14 (the series omits 9e-15). */
static inline double conic_weight_exp(double s) {
  double x = -s, k = x * CONIC_WEIGHT_LOG2E + CONIC_WEIGHT_ROUND;
  uint64_t k_bits, bits;
  memcpy(&k_bits, &k, sizeof k_bits);
  k = k - CONIC_WEIGHT_ROUND;
  double r = (x - k * CONIC_WEIGHT_LN2_HIGH) - k * CONIC_WEIGHT_LN2_LOW, r2 = r * r, r4 = r2 * r2;
  double a = (1.0 + r) + r2 * (CONIC_EXP_2 + CONIC_EXP_3 * r);
  double b = (CONIC_EXP_4 + CONIC_EXP_5 * r) + r2 * (CONIC_EXP_6 + CONIC_EXP_7 * r);
  double c = (CONIC_EXP_8 + CONIC_EXP_9 * r) + r2 * (CONIC_EXP_10 + CONIC_EXP_11 * r);
  double p = a + r4 * (b + r4 * c);
  memcpy(&bits, &p, sizeof bits);
  bits += k_bits << 52;
  memcpy(&p, &bits, sizeof p);
  return p;
}

static inline conic_theta conic_weight_gauss(const conic_weighing *weighing, double s) {
  conic_theta theta;
  double g = conic_weight_exp(s);
  theta.value = g - weighing->edge * ((1.0 + weighing->end) - s);
  theta.first = weighing->edge - g;
  theta.second = g;
  return theta;
}

static inline conic_theta conic_weight_compact(const conic_weighing *weighing, double s) {
  conic_theta theta;
  double z = s / weighing->end, y = sqrt(z), least = y > CONIC_WEIGHT_LEAST ? y : CONIC_WEIGHT_LEAST;
  theta.value = 1.0 - z * (3.0 - 2.0 * y);
  theta.first = (3.0 * y - 3.0) / weighing->end;
  theta.second = (1.5 / least) / (weighing->end * weighing->end);
  return theta;
}

static inline conic_theta conic_weight_flat(const conic_weighing *weighing, double s) {
  conic_theta theta;
  double inverse = 1.0 / weighing->end, z = s * inverse, z2 = z * z, u = 1.0 - z2;
  theta.value = u * u;
  theta.first = (z * u) * (-4.0 * inverse);
  theta.second = (3.0 * z2 - 1.0) * ((4.0 * inverse) * inverse);
  return theta;
}

/* θ at s; zero from `end` on. */
static inline conic_theta conic_weight_at(const conic_weighing *weighing, double s) {
  double inner = s < weighing->end ? s : weighing->end;
  conic_theta theta = weighing->weight == CONIC_WEIGHT_COMPACT ? conic_weight_compact(weighing, inner)
                      : weighing->weight == CONIC_WEIGHT_FLAT  ? conic_weight_flat(weighing, inner)
                                                               : conic_weight_gauss(weighing, inner);
  theta.value = theta.value > 0.0 && s < weighing->end ? theta.value : 0.0;
  theta.first = s < weighing->end ? theta.first : 0.0;
  theta.second = s < weighing->end ? theta.second : 0.0;
  return theta;
}
