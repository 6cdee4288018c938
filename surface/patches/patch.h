/* A polynomial patch, and the grids on which it is sampled. */
#pragma once

#include "surface/mls_surface.h"

/* Where a patch ends before its disc does, at creases and borders: a line keeps a·s + b·t + c - k·(d·s + e·t)² ≥ 0,
 * with a, b, c, d, e, k. What all of them keep is drawn; with is_either, what either of the two keeps. */
enum { CONIC_MOST_FENCE_LINES = 8 };
typedef struct conic_patch_fence {
  int n_lines, is_either;
  float off; /* how far the patch is off the vertices around its own and their normals */
  float lines[CONIC_MOST_FENCE_LINES][6];
} conic_patch_fence;

/* The place (s, t) of the unit disc is at center + s·along + t·across + g(s, t)·normal, relative to the set's origin,
 * with g = Σ c_k s^i t^j in world units, k counting 1, s, t, s², st, t² …. `along` and `across` are as long as the
 * disc's radius, a mesh's as the half axes of an ellipse; the normal is on the side of their cross product. */
typedef struct conic_patch {
  float center[3], along[3], across[3], normal[3];
  float coefficients[CONIC_MAX_COEFFICIENTS];
  float radius;                   /* 0: there is no patch */
  float slope;                    /* a bound of the slope in any direction */
  float bend;                     /* ½ of the greatest second derivative by (s, t), in world units */
  float twist;                    /* ½ of the greatest third derivative, over the radius */
  float reach;                    /* no place of the patch, nor an outline of its samples, is farther from the point */
  const conic_patch_fence *fence; /* null: it ends with its disc */
} conic_patch;

/* Grids are n × n over the square about the disc; only their places within the disc are sampled. */
enum { CONIC_LEAST_GRID = 3, CONIC_GREATEST_GRID = 64 };

/* The reach of a sample's outline, in steps of its grid. √½ would just close the grid. With this and the cutoff of 1.5,
 * the sum of the weights is most even: 6 % rms, where 0.9 has 17 %, and 1.6, with twice the fragments, 5 %. */
#define CONIC_SAMPLE_OUTLINE 1.17

/* The standard deviation of the blur by these samples, for the usual kernel. */
#define CONIC_SAMPLE_BLUR 0.78

/* A part of a grid: the rows [row, row + n_rows), and columns alike. */
typedef struct conic_grid_part {
  int64_t n; /* of the whole grid */
  int64_t row, column, n_rows, n_columns;
} conic_grid_part;

static inline conic_grid_part conic_grid_whole(int n) {
  conic_grid_part part = {n, 0, 0, n, n};
  return part;
}

/* How many samples a part has within the fence, which may be null. */
size_t conic_grid_count(const conic_grid_part *part, const conic_patch_fence *fence);

/* The arrays that samples are written to. */
typedef struct conic_grid_samples {
  float *position[3], *tangent_u[3], *tangent_v[3];
  float *weight;     /* greatest in the middle of the patch, where the weights add up to 1; small at its rim */
  conic_clip *clips; /* where the patch has a fence, how that clips each sample: records without lines do not */
} conic_grid_samples;

/* Samples a part row by row. Returns how many there are. */
size_t conic_grid_sample(const conic_patch *patch, int degree, double cutoff, const conic_grid_part *part,
                         const conic_grid_samples *to);
