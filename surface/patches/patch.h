/* A polynomial patch, and the grids that it is sampled on. */
#ifndef CONIC_PATCH_H
#define CONIC_PATCH_H

#include <stddef.h>
#include <stdint.h>

#include "surface/mls_surface.h"

/* The place (s, t) of the unit disc is at center + s·along + t·across + g(s, t)·normal, relative to the set's origin,
 * with g = Σ c_k s^i t^j in world units, k counting 1, s, t, s², st, t² … `along` and `across` are as long as the
 * disc's radius, and normal is on the side of their cross product. */
typedef struct conic_patch {
  float center[3], along[3], across[3], normal[3];
  float coefficients[CONIC_MAX_COEFFICIENTS];
  float radius; /* 0: there is no patch */
  float slope;  /* the greatest there may be, in any direction */
  float bend;   /* ½ of the greatest second derivative by (s, t), in world units */
  float twist;  /* ½ of the greatest third one, over the radius */
  float reach;  /* no place of the patch, nor its samples' outlines, are farther from the point itself */
} conic_patch;

/* Grids are square, n × n over the square about the disc, and hold those of their places that lie in the disc. */
enum { CONIC_LEAST_GRID = 3, CONIC_GREATEST_GRID = 64 };

/* Outlines of samples reach so far, in steps of their grid. √½ would just close it; here, with the cutoff of 1.5, what
 * they weigh together is most even: 6 % rms, where 0.9 has 17 % and 1.6, at twice the fragments, 5 %. */
#define CONIC_SAMPLE_OUTLINE 1.17

/* The standard deviation of what is made of them, for the usual kernel. */
#define CONIC_SAMPLE_BLUR 0.78

/* Part of a grid: the rows [row, row + n_rows) and the columns likewise. */
typedef struct conic_grid_part {
  int64_t n; /* of the whole grid */
  int64_t row, column, n_rows, n_columns;
} conic_grid_part;

static inline conic_grid_part conic_grid_whole(int n) {
  conic_grid_part part = {n, 0, 0, n, n};
  return part;
}

/* How many samples lie in it. */
size_t conic_grid_count(const conic_grid_part *part);

/* Where samples are written to. */
typedef struct conic_grid_samples {
  float *position[3], *tangent_u[3], *tangent_v[3];
  float *weight; /* greatest in the middle of the patch, where they add up to 1; little at its rim */
} conic_grid_samples;

/* Samples a part row by row. Returns how many there are. */
size_t conic_grid_sample(const conic_patch *patch, int degree, double cutoff, const conic_grid_part *part,
                         const conic_grid_samples *to);

#endif
