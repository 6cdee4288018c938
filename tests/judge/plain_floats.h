/* Float arithmetic as compilers and devices make it. A source that says a·b + c leaves open whether the product is
 * rounded by itself; one that says a + b + c is summed in another order by the next compiler, or by another author.
 * Here either is chosen: never, always, or by chance, operation by operation. Build this without contraction, so that
 * nothing else is fused. */
#pragma once

#include <math.h>
#include <stdint.h>

typedef enum plain_exp {
  PLAIN_EXP_LIBM = 0,     /* the C library's */
  PLAIN_EXP_TWO_ULP = 1,  /* off by up to 2 ulp, by chance */
  PLAIN_EXP_BY_EXP2 = 2,  /* 2^(x·log₂e), the product rounded */
  PLAIN_EXP_GRAPHICS = 3, /* the same, by a unit of 2⁻²² and no denormals: ex2.approx.ftz, __expf, GLSL's exp */
  PLAIN_N_EXPS = 4
} plain_exp;

typedef struct plain_floats {
  uint64_t state;  /* of chance */
  int fused;       /* per cent of a·b + c that round once */
  int is_shuffled; /* sums and products are formed in any order */
  int is_fast;     /* quotients and roots by approximations, to 2 ulp */
  plain_exp exp;
} plain_floats;

static inline uint32_t plain_chance(plain_floats *f, uint32_t n) {
  uint64_t x = f->state += 0x9E3779B97F4A7C15u;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
  return (uint32_t)((x ^ (x >> 31)) >> 32) % n;
}

/* a·b + c */
static inline float plain_mad(plain_floats *f, float a, float b, float c) {
  int is_fused = f->fused >= 100 || (f->fused > 0 && (int)plain_chance(f, 100) < f->fused);
  return is_fused ? fmaf(a, b, c) : a * b + c;
}

/* a·b·c */
static inline float plain_product(plain_floats *f, float a, float b, float c) {
  switch (f->is_shuffled ? plain_chance(f, 3) : 0) {
  case 0:
    return a * b * c;
  case 1:
    return a * (b * c);
  default:
    return a * c * b;
  }
}

static inline float plain_sum(plain_floats *f, float a, float b, float c) {
  switch (f->is_shuffled ? plain_chance(f, 3) : 0) {
  case 0:
    return a + b + c;
  case 1:
    return a + (b + c);
  default:
    return a + c + b;
  }
}

/* a₀b₀ + a₁b₁ + a₂b₂ + c; c is a number that is added first or last. */
static inline float plain_dot_plus(plain_floats *f, const float a[3], const float b[3], float c) {
  static const int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  const int *o = orders[f->is_shuffled ? plain_chance(f, 6) : 0];
  if (f->is_shuffled && plain_chance(f, 2))
    return plain_mad(f, a[o[2]], b[o[2]], plain_mad(f, a[o[1]], b[o[1]], plain_mad(f, a[o[0]], b[o[0]], c)));
  return plain_mad(f, a[o[2]], b[o[2]], plain_mad(f, a[o[1]], b[o[1]], a[o[0]] * b[o[0]])) + c;
}

static inline float plain_dot(plain_floats *f, const float a[3], const float b[3]) {
  return plain_dot_plus(f, a, b, 0.0f);
}

/* A float within 2 ulp of a number, by chance. */
static inline float plain_within_two_ulp(plain_floats *f, double exact) {
  float nearest = (float)exact, v = nearest;
  float ulp = nextafterf(fabsf(nearest), INFINITY) - fabsf(nearest);
  for (int steps = (int)plain_chance(f, 5) - 2; steps != 0; steps += steps < 0 ? 1 : -1)
    v = nextafterf(v, steps < 0 ? -INFINITY : INFINITY);
  return fabs((double)v - exact) <= 2.0 * (double)ulp ? v : nearest;
}

static inline float plain_divide(plain_floats *f, float a, float b) {
  return f->is_fast ? plain_within_two_ulp(f, (double)a / (double)b) : a / b;
}

static inline float plain_root(plain_floats *f, float a) {
  return f->is_fast ? plain_within_two_ulp(f, sqrt((double)a)) : sqrtf(a);
}

static inline float plain_inverse_root(plain_floats *f, float a) {
  return f->is_fast ? plain_within_two_ulp(f, 1.0 / sqrt((double)a)) : 1.0f / sqrtf(a);
}

static inline float plain_exponential(plain_floats *f, float x) {
  const float log2_of_e = 1.44269504f;
  switch (f->exp) {
  case PLAIN_EXP_TWO_ULP:
    return plain_within_two_ulp(f, exp((double)x));
  case PLAIN_EXP_BY_EXP2:
    return exp2f(x * log2_of_e);
  case PLAIN_EXP_GRAPHICS: {
    double off = ((double)plain_chance(f, 2001) - 1000.0) * 0.001 * 0x1p-22;
    float power = (float)(exp2((double)(x * log2_of_e)) * (1.0 + off));
    return power < 0x1p-126f ? 0.0f : power;
  }
  case PLAIN_EXP_LIBM:
  case PLAIN_N_EXPS: /* which is none */
    break;
  }
  return expf(x);
}

/* A compiler and a device by chance. What is not `fast` keeps to what C's own mathematics does. */
static inline plain_floats plain_floats_by_chance(uint64_t seed, int is_fast) {
  plain_floats f = {.state = seed};
  static const int shares[4] = {0, 100, 50, 90};
  f.fused = shares[plain_chance(&f, 4)];
  f.is_shuffled = plain_chance(&f, 4) != 0;
  f.is_fast = is_fast && plain_chance(&f, 2);
  f.exp = (plain_exp)plain_chance(&f, is_fast ? PLAIN_N_EXPS : PLAIN_EXP_BY_EXP2);
  return f;
}
