/* Which splats of a set are where on the ground: lists of splats by the square that holds their centre. */
#ifndef CONIC_TOP_BINS_H
#define CONIC_TOP_BINS_H

#include "conic/splats.h"

/* Zeroed: empty. */
typedef struct conic_top_bins {
  double low[2], edge; /* where the squares begin, and the length of an edge: world units */
  size_t n_columns, n_rows;
  size_t *starts;    /* of each square, row after row; then of the splats that reach farther than half a square */
  uint32_t *members; /* ascending in each list */
  uint32_t *found;   /* room for the results of a query */
  size_t found_room;
} conic_top_bins;

/* Makes lists with squares of an edge of at least `edge`. Splats that are not finite are in none. Errors: MEMORY. */
conic_status conic_top_bins_make(conic_context *context, const conic_splats *splats, float cutoff, double edge,
                                 conic_top_bins *bins);
void conic_top_bins_release(conic_context *context, conic_top_bins *bins);

/* Finds the splats that may reach into a box no larger than a square, in ascending order: bins->found holds them until
 * the next call. Errors: MEMORY. */
conic_status conic_top_bins_find(conic_context *context, conic_top_bins *bins, const double low[2],
                                 const double high[2], size_t *n);

#endif
