/* Projects a surface's own points. */
#pragma once

#include "surface/mls_surface.h"

/* The wanted slots: among those of the surface's first n_points points, in the order of the slots, number `first` to
 * before `end`. Leaves are taken whole: a leaf counts by the number of its first slot. */
typedef struct conic_own_range {
  uint64_t n_points, first, end;
} conic_own_range;

/* Results by slot, from `begin` to before `end`; other entries mean nothing. A point that is not DONE keeps its old
 * position. */
typedef struct conic_own_points {
  size_t begin, end;
  conic_splats points; /* with normals and colours if the samples have them */
  double *moved2;      /* the squared distance by which each was moved */
  uint32_t *n_neighbours;
  uint8_t *outcomes;
  uint8_t *are_merged; /* lies between two sheets that the polynomial takes for one */
  size_t n_evaluations;
} conic_own_points;

/* Projects the wanted slots; null: all. The progress of "project" goes from `from` to `to`. Errors: MEMORY, CANCELLED;
 * *own is then empty. */
conic_status conic_own_points_project(const conic_surface *surface, const conic_own_range *wanted, double from,
                                      double to, conic_own_points *own);
void conic_own_points_release(conic_context *context, conic_own_points *own);
