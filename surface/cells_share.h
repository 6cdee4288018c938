/* Which points of which cells a process of a team projects. */
#ifndef CONIC_CELLS_SHARE_H
#define CONIC_CELLS_SHARE_H

#include "core/base/team.h"
#include "surface/cells.h"

/* Of a cell's points, by the order of its tree: those from `first` on and before `end`. */
typedef struct conic_cell_part {
  uint64_t first, end;
  double from, to; /* of this process's work: what is done before it and after */
  int is_kept;     /* the process needs the cell's points: it or a neighbour has such points */
} conic_cell_part;

typedef struct conic_cells_share {
  const conic_team *team;  /* null: all is this process's */
  conic_cell_part *parts;  /* by cell */
  uint64_t n_kept, n_most; /* points of the cells that are kept, and of those with own ones */
} conic_cells_share;

/* Shares out cells that are sorted, as long as each process's may take, and gives those that are kept their places
 * among all that are. Errors: MEMORY. */
conic_status conic_cells_share_out(conic_cells *cells, const conic_team *team, conic_cells_share *share);
void conic_cells_share_end(conic_context *context, conic_cells_share *share);

#endif
