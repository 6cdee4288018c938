/* Which splats of a set lie where on the ground: lists of them by the square that their centre is in. */
#ifndef CONIC_TOP_BINS_H
#define CONIC_TOP_BINS_H

#include "conic/splats.h"

/* Zero: made of nothing. */
typedef struct conic_top_bins {
  double low[2], edge; /* where the squares begin, and how long they are: world units */
  size_t n_columns, n_rows;
  size_t *starts;    /* of each square, row after row, and then of the splats that reach farther than half a square */
  uint32_t *members; /* ascending in each list */
  uint32_t *found;   /* room for what is looked for */
  size_t found_room;
} conic_top_bins;

/* Squares of an edge of at least `edge`. Splats that are not finite are in none. Errors: MEMORY. */
conic_status conic_top_bins_make(conic_context *context, const conic_splats *splats, float cutoff, double edge,
                                 conic_top_bins *bins);
void conic_top_bins_release(conic_context *context, conic_top_bins *bins);

/* The splats that may reach into a box, which is no larger than a square, ascending: bins->found has them until the
 * next call. Errors: MEMORY. */
conic_status conic_top_bins_find(conic_context *context, conic_top_bins *bins, const double low[2],
                                 const double high[2], size_t *n);

#endif
