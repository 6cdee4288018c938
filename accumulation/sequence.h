/* The low-discrepancy sequence that places all samples of a picture (docs/reference/accumulation.md). */
#pragma once

#include <stdint.h>

/* What the dimensions of the sequence decide. From CONIC_SEQUENCE_FREE on they are free, except for the last three. */
enum {
  CONIC_SEQUENCE_PIXEL = 0,       /* and 1: the place in the pixel, to the right and down */
  CONIC_SEQUENCE_LENS = 2,        /* and 3: the point on the lens */
  CONIC_SEQUENCE_SHUTTER = 4,     /* the time in the shutter */
  CONIC_SEQUENCE_DIRECTION = 5,   /* and 6: the direction of the sky, or the place on a light */
  CONIC_SEQUENCE_LIGHT = 7,       /* which light */
  CONIC_SEQUENCE_VIEW = 8,        /* and 9: where the pixels of gathered views lie */
  CONIC_SEQUENCE_LENS_DEPTH = 10, /* for a lens for all directions: the point's way forward */
  CONIC_SEQUENCE_FREE = 11,
  CONIC_SEQUENCE_SHADOW = 13,  /* for surfaces that let light through: which of them stop a light */
  CONIC_SEQUENCE_SURFACE = 14, /* … and which of them a pixel shows */
  CONIC_SEQUENCE_HALF = 15,    /* which half, for the estimate of the mean's error */
  CONIC_N_SEQUENCE_DIMENSIONS = 16
};

/* Dimension 0 to 15 of sample `i_sample`: in [0, 1), a multiple of 2⁻³², the same on every machine. Every run of 2ᵏ
 * samples that starts at a multiple of 2ᵏ has one sample in each 2ᵏ-th of each dimension; in the two dimensions of the
 * pixel it has one in each of the 2ᵏ equal boxes of any power-of-two shape. */
double conic_sequence_at(uint64_t i_sample, int dimension);
