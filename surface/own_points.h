/* A surface's own points, projected. */
#ifndef CONIC_OWN_POINTS_H
#define CONIC_OWN_POINTS_H

#include "surface/mls_surface.h"

/* By slot. What is not DONE has its old position. */
typedef struct conic_own_points {
  conic_splats points; /* with the normals and colours that the samples have */
  double *moved2;      /* the squared distance that each was moved */
  uint32_t *n_neighbours;
  uint8_t *outcomes;
  uint8_t *are_merged; /* lies between two sheets that the polynomial takes for one */
  size_t n_evaluations;
} conic_own_points;

/* Projects the slots of the first n_wanted points; the others' entries mean nothing. The progress of "project" goes
 * from `begin` to `end`. Errors: MEMORY, CANCELLED; *own is then empty. */
conic_status conic_own_points_project(const conic_surface *surface, size_t n_wanted, double begin, double end,
                                      conic_own_points *own);
void conic_own_points_release(conic_context *context, conic_own_points *own);

#endif
