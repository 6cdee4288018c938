#include "surface/cells_share.h"

#include "core/base/memory.h"

/* The cost of a point without its neighbours' cost, which is the number of points in its part. */
static const double POINT_COST = 300.0;

static int count_set_bits(uint64_t bits) {
  int n = 0;
  for (; bits; bits &= bits - 1)
    n++;
  return n;
}

/* The time that a cell may take: the more of its points share a part, the more neighbours they have. */
static double cell_cost(const conic_cell *cell) {
  double a_part = (double)cell->count / (double)count_set_bits(cell->parts);
  return (double)cell->count * (a_part + POINT_COST);
}

/* How many of a cell's points come before `place` in the row of all work; the cell's part of the row begins at
 * `begin`. */
static uint64_t points_before(const conic_cell *cell, double begin, double cost, double place) {
  double share = (place - begin) / cost;
  return share <= 0.0 ? 0 : share >= 1.0 ? cell->count : (uint64_t)(share * (double)cell->count);
}

static void divide_cells(const conic_cells *cells, conic_cells_share *share) {
  double total = 0.0, begin = 0.0;
  int index = share->team ? share->team->index : 0, count = share->team ? share->team->count : 1;
  for (size_t i = 0; i < cells->n; i++)
    total += cell_cost(&cells->cells[i]);
  double from = total * ((double)index / (double)count), to = total * ((double)(index + 1) / (double)count);
  for (size_t i = 0; i < cells->n; i++) {
    const conic_cell *cell = &cells->cells[i];
    conic_cell_part *part = &share->parts[i];
    double cost = cell_cost(cell);
    part->first = index == 0 ? 0 : points_before(cell, begin, cost, from);
    part->end = index + 1 == count ? cell->count : points_before(cell, begin, cost, to);
    part->from = begin > from ? (begin - from) / (to - from) : 0.0;
    begin += cost;
    part->to = begin < to ? (begin - from) / (to - from) : 1.0;
  }
}

static void keep_neighbours(const conic_cells *cells, conic_cells_share *share, size_t i_cell) {
  for (int i = 0; i < CONIC_CELL_NEIGHBOURS; i++) {
    const conic_cell *other = conic_cells_neighbour(cells, &cells->cells[i_cell], i);
    if (other)
      share->parts[other - cells->cells].is_kept = 1;
  }
}

conic_status conic_cells_share_out(conic_cells *cells, const conic_team *team, conic_cells_share *share) {
  *share = (conic_cells_share){.team = team};
  share->parts = conic_memory_allocate_zeroed(cells->context, cells->n, sizeof *share->parts);
  if (!share->parts)
    return CONIC_ERROR_MEMORY;
  divide_cells(cells, share);
  for (size_t i = 0; i < cells->n; i++)
    if (share->parts[i].first < share->parts[i].end) {
      share->n_most += cells->cells[i].count;
      keep_neighbours(cells, share, i);
    }
  for (size_t i = 0; i < cells->n; i++)
    if (share->parts[i].is_kept) {
      cells->cells[i].start = share->n_kept;
      share->n_kept += cells->cells[i].count;
    }
  return CONIC_OK;
}

void conic_cells_share_end(conic_context *context, conic_cells_share *share) {
  conic_memory_release(context, share->parts);
}
