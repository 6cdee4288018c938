/* A surface's own points, projected. */
#ifndef CONIC_OWN_POINTS_H
#define CONIC_OWN_POINTS_H

#include "surface/mls_surface.h"

/* Which of a surface's slots are wanted: of those of its first n_points points, in the order of the slots, those from
 * number `first` on and before `end`, leaf by leaf: a leaf's go by the number of its first. */
typedef struct conic_own_range {
  uint64_t n_points, first, end;
} conic_own_range;

/* By slot, from `begin` on and before `end`; the others' entries mean nothing. What is not DONE has its old position.
 */
typedef struct conic_own_points {
  size_t begin, end;
  conic_splats points; /* with the normals and colours that the samples have */
  double *moved2;      /* the squared distance that each was moved */
  uint32_t *n_neighbours;
  uint8_t *outcomes;
  uint8_t *are_merged; /* lies between two sheets that the polynomial takes for one */
  size_t n_evaluations;
} conic_own_points;

/* Projects the slots that are wanted, or where that is null all. The progress of "project" goes from `from` to `to`.
 * Errors: MEMORY, CANCELLED; *own is then empty. */
conic_status conic_own_points_project(const conic_surface *surface, const conic_own_range *wanted, double from,
                                      double to, conic_own_points *own);
void conic_own_points_release(conic_context *context, conic_own_points *own);

#endif
