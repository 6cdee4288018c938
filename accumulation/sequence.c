/* Sobol's sequence with the direction numbers of Joe & Kuo, "Constructing Sobol sequences with better two-dimensional
 * projections", SIAM J. Sci. Comput. 30 (2008), scrambled as Owen, "Randomly permuted (t,m,s)-nets and (t,s)-sequences"
 * (1995), with the flips of Burley, "Practical hash-based Owen scrambling", JCGT 9-4 (2020); but each flip is a hash of
 * all bits above it, so that the scramble is a nested one exactly. */
#include "accumulation/sequence.h"

#include "core/base/random.h"

/* One of 400 scrambles: the one with which edges in a pixel, out of focus and in motion came out best. */
enum { N_BITS = 32, MOST_DEGREE = 6, SCRAMBLE = 63 };

/* A primitive polynomial over two elements, its inner coefficients as bits, and the first direction numbers. */
typedef struct sobol_dimension {
  int degree;
  unsigned coefficients;
  uint32_t first[MOST_DEGREE];
} sobol_dimension;

/* In the order of our dimensions. Dimensions used as pairs are those whose projections together are good nets (Joe and
 * Kuo's dimensions 1 and 2, 3 and 4, 6 and 8, 9 and 16, 10 and 15). */
static const sobol_dimension dimensions[CONIC_N_SEQUENCE_DIMENSIONS] = {
    {0, 0, {0}},                    /* 1: the bits of the index, mirrored */
    {1, 0, {1}},                    /* 2 */
    {2, 1, {1, 3}},                 /* 3 */
    {3, 1, {1, 3, 1}},              /* 4 */
    {3, 2, {1, 1, 1}},              /* 5 */
    {4, 1, {1, 1, 3, 3}},           /* 6 */
    {5, 2, {1, 1, 5, 5, 17}},       /* 8 */
    {4, 4, {1, 3, 5, 13}},          /* 7 */
    {5, 4, {1, 1, 5, 5, 5}},        /* 9 */
    {6, 16, {1, 3, 1, 13, 27, 49}}, /* 16 */
    {5, 7, {1, 1, 7, 11, 19}},      /* 10 */
    {6, 13, {1, 1, 1, 15, 21, 21}}, /* 15 */
    {5, 11, {1, 1, 5, 1, 1}},       /* 11 */
    {6, 1, {1, 3, 3, 9, 7, 49}},    /* 14 */
    {5, 14, {1, 3, 5, 5, 31}},      /* 13 */
    {5, 13, {1, 1, 1, 3, 11}},      /* 12 */
};

/* The sum of the direction numbers that the bits of an index select, by Sobol's recurrence. */
static uint32_t sobol_point(const sobol_dimension *dimension, uint32_t index) {
  uint32_t directions[N_BITS], point = 0;
  int degree = dimension->degree;
  for (int i = 0; i < N_BITS; i++) {
    if (degree == 0) {
      directions[i] = UINT32_C(1) << (N_BITS - 1 - i);
    } else if (i < degree) {
      directions[i] = dimension->first[i] << (N_BITS - 1 - i);
    } else {
      directions[i] = directions[i - degree] ^ (directions[i - degree] >> degree);
      for (int j = 1; j < degree; j++) {
        directions[i] ^= (dimension->coefficients >> (degree - 1 - j) & 1u) * directions[i - j];
      }
    }
    point ^= (index >> i & 1u) * directions[i];
  }
  return point;
}

/* Owen's scramble: the bits above each bit decide whether it is flipped. */
static uint32_t nested_scramble(uint32_t point, uint64_t seed, int dimension) {
  uint32_t scrambled = 0;
  for (int i = 0; i < N_BITS; i++) {
    uint64_t above = UINT64_C(1) << i | (uint64_t)point >> (N_BITS - i);
    uint32_t flip = (uint32_t)(conic_random_bits(seed, above, (uint64_t)dimension) >> 63);
    scrambled = scrambled << 1 | ((point >> (N_BITS - 1 - i) & 1u) ^ flip);
  }
  return scrambled;
}

double conic_sequence_at(uint64_t i_sample, int dimension) {
  uint32_t point = sobol_point(&dimensions[dimension], (uint32_t)i_sample);
  return nested_scramble(point, SCRAMBLE + (i_sample >> N_BITS), dimension) * 0x1p-32;
}
