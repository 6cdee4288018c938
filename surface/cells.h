/* The cells of a lattice that hold points, and how many. */
#pragma once

#include "core/base/base.h"
#include "core/base/team.h"

typedef struct conic_cell {
  int32_t at[3];
  uint64_t count;  /* points in it */
  uint64_t start;  /* where its points begin among all, cell by cell */
  uint64_t filled; /* points put there so far */
  uint64_t parts;  /* as bits: which of its 4 × 4 × 4 parts hold points */
} conic_cell;

typedef struct conic_cells {
  conic_context *context;
  double side;
  conic_cell *cells; /* sorted by x, y, z by conic_cells_sort */
  size_t n, room;
  uint32_t *table; /* a hash table: 1 + number of a cell; 0: empty */
  size_t table_size;
} conic_cells;

/* Errors: MEMORY. */
conic_status conic_cells_begin(conic_context *context, double side, conic_cells *cells);
void conic_cells_end(conic_cells *cells);

/* The cell of a place; returns 0 where the place is not finite, or the cell's number does not fit. */
int conic_cells_locate(const conic_cells *cells, const float place[3], int32_t at[3]);

/* The cell at these numbers; null: none. */
conic_cell *conic_cells_find(const conic_cells *cells, const int32_t at[3]);

/* Counts a point of that cell at a place. Errors: MEMORY. */
conic_status conic_cells_count(conic_cells *cells, const int32_t at[3], const float place[3]);

/* Sorts the cells, and gives each its place among all points. */
void conic_cells_sort(conic_cells *cells);

/* A cell's neighbours: 27, of which the cell itself is the first; null where there is none. */
enum { CONIC_CELL_NEIGHBOURS = 27 };
const conic_cell *conic_cells_neighbour(const conic_cells *cells, const conic_cell *cell, int i);

/* Which points of which cells each process of a team projects. */

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
