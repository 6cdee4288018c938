/* Which points of which cells each process of a team projects. */
#ifndef CONIC_CELLS_SHARE_H
#define CONIC_CELLS_SHARE_H

#include "core/base/team.h"
#include "surface/cells.h"

/* Some points of a cell: from `first` to before `end` in the order of its tree. */
typedef struct conic_cell_part {
  uint64_t first, end;
  double from, to; /* of this process: the shares of the cell's work before it and up to its end */
  int is_kept;     /* the process needs the cell's points, because it projects some of them or of a neighbour's */
} conic_cell_part;

typedef struct conic_cells_share {
  const conic_team *team;  /* null: this process does all */
  conic_cell_part *parts;  /* by cell */
  uint64_t n_kept, n_most; /* n_kept: points of the kept cells; n_most: points of the cells with own points */
} conic_cells_share;

/* Shares out sorted cells so that all processes take about as long, and gives the kept cells their places among all
 * kept points. Errors: MEMORY. */
conic_status conic_cells_share_out(conic_cells *cells, const conic_team *team, conic_cells_share *share);
void conic_cells_share_end(conic_context *context, conic_cells_share *share);

#endif
