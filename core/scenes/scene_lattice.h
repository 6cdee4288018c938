/* Even samples of a surface that has no parametrisation: the points of a cubic lattice in [-1, 1]³ that lie within half
 * a lattice spacing of it, carried onto it.
 *
 * This layer, one spacing thick, holds one lattice point per spacing² of surface, however the surface is turned. Its
 * points are numbered slab by slab; the surplus over the wanted number is dropped evenly. Only the slabs' counts are
 * kept: memory does not grow with the number of points, and any batch is found without those before it. */
#ifndef CONIC_SCENE_LATTICE_H
#define CONIC_SCENE_LATTICE_H

#include <stddef.h>
#include <stdint.h>

#include "conic/context.h"

typedef struct conic_scene_point conic_scene_point;

typedef struct conic_lattice {
  size_t n_cells;         /* along an edge of the cube; the points are the cells' centres */
  double spacing;         /* 2 / n_cells */
  uint64_t n_found;       /* points near the surface */
  uint64_t n_wanted;      /* not above n_found */
  uint64_t *found_before; /* n_cells + 1: points in the slabs before this one */
} conic_lattice;

/* Called for each point near the surface, with a start for its projection: the point itself, or a nearer place. */
typedef void conic_lattice_visit(void *cookie, const double start[3]);

/* Visits the points of slab `i_slab` (below n_cells), always in the same order. To first order they are less than half
 * a spacing from the surface, so that the layer is one spacing thick. Thread-safe. */
typedef void conic_lattice_walk(const void *surface, const conic_lattice *lattice, size_t i_slab,
                                conic_lattice_visit *visit, void *cookie);

/* Carries a start from the walk onto the surface. Thread-safe. */
typedef void conic_lattice_project(const void *surface, const double start[3], conic_scene_point *point);

/* The coordinate of the i-th cells' centres, along any axis. */
static inline double conic_lattice_coordinate(const conic_lattice *lattice, size_t i) {
  return (double)i * lattice->spacing + (0.5 * lattice->spacing - 1.0);
}

/* Finds the coarsest lattice, of at least `min_cells` cells along an edge, with at least `n_wanted` (1 to 2³² − 2)
 * points near the surface, whose area is about `area`. Reports progress. On failure nothing is left to release. Errors:
 * MEMORY, CANCELLED. */
conic_status conic_lattice_fit(conic_context *context, conic_lattice_walk *walk, const void *surface, double area,
                               uint64_t n_wanted, size_t min_cells, conic_lattice *lattice);

void conic_lattice_release(conic_context *context, conic_lattice *lattice);

/* The slabs with the kept points first … first + n − 1: *first_slab is the first; returns how many. */
size_t conic_lattice_slabs(const conic_lattice *lattice, uint64_t first, uint64_t n, size_t *first_slab);

/* How many of the first `found` points near the surface are kept. */
uint64_t conic_lattice_kept(const conic_lattice *lattice, uint64_t found);

#endif
