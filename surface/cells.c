#include "surface/cells.h"

enum { FIRST_ROOM = 256 };

conic_status conic_cells_begin(conic_context *context, double side, conic_cells *cells) {
  memset(cells, 0, sizeof *cells);
  cells->context = context;
  cells->side = side;
  cells->room = FIRST_ROOM;
  cells->table_size = 4 * (size_t)FIRST_ROOM;
  return conic_memory_allocate_these(context, CONIC_ROOM(cells->cells, cells->room),
                                     CONIC_ZEROED(cells->table, cells->table_size));
}

void conic_cells_end(conic_cells *cells) {
  if (!cells->context)
    return;
  conic_memory_release_these(cells->context, cells->cells, cells->table);
  memset(cells, 0, sizeof *cells);
}

int conic_cells_locate(const conic_cells *cells, const float place[3], int32_t at[3]) {
  for (int axis = 0; axis < 3; axis++) {
    double number = floor((double)place[axis] / cells->side);
    if (!(fabs(number) < 0x1p30))
      return 0;
    at[axis] = (int32_t)number;
  }
  return 1;
}

/* The cell's place in the table, or the first free place for it. */
static size_t look_up(const conic_cells *cells, const int32_t at[3]) {
  uint64_t hash = (uint32_t)at[0];
  for (int axis = 1; axis < 3; axis++)
    hash = (hash ^ (hash >> 29)) * UINT64_C(0xbf58476d1ce4e5b9) + (uint32_t)at[axis];
  hash = (hash ^ (hash >> 32)) * UINT64_C(0x94d049bb133111eb);
  size_t i = (size_t)(hash >> 20) & (cells->table_size - 1);
  while (cells->table[i] && memcmp(cells->cells[cells->table[i] - 1].at, at, 3 * sizeof at[0]) != 0)
    i = (i + 1) & (cells->table_size - 1);
  return i;
}

conic_cell *conic_cells_find(const conic_cells *cells, const int32_t at[3]) {
  uint32_t entry = cells->table[look_up(cells, at)];
  return entry ? &cells->cells[entry - 1] : NULL;
}

static void fill_table(conic_cells *cells) {
  memset(cells->table, 0, cells->table_size * sizeof *cells->table);
  for (size_t i = 0; i < cells->n; i++)
    cells->table[look_up(cells, cells->cells[i].at)] = (uint32_t)(i + 1);
}

static conic_status grow(conic_cells *cells) {
  uint32_t *table = conic_memory_allocate(cells->context, 2 * cells->table_size, sizeof *table);
  conic_status status =
      table ? conic_memory_grow(cells->context, &cells->cells, cells->n, 2 * cells->room, sizeof *cells->cells)
            : CONIC_ERROR_MEMORY;
  if (status != CONIC_OK) {
    conic_memory_release(cells->context, table);
    return status;
  }
  conic_memory_release(cells->context, cells->table);
  cells->table = table;
  cells->table_size *= 2;
  cells->room *= 2;
  fill_table(cells);
  return CONIC_OK;
}

/* The number of the part that holds a place. */
static int part_of_cell(const conic_cells *cells, const int32_t at[3], const float place[3]) {
  int number = 0;
  for (int axis = 0; axis < 3; axis++) {
    int i = (int)(4.0 * ((double)place[axis] / cells->side - (double)at[axis]));
    number = 4 * number + (i < 3 ? i : 3);
  }
  return number;
}

conic_status conic_cells_count(conic_cells *cells, const int32_t at[3], const float place[3]) {
  uint32_t entry = cells->table[look_up(cells, at)];
  if (!entry) {
    if (cells->n == cells->room) {
      conic_status status = grow(cells);
      if (status != CONIC_OK)
        return status;
    }
    conic_cell *cell = &cells->cells[cells->n++];
    memset(cell, 0, sizeof *cell);
    memcpy(cell->at, at, sizeof cell->at);
    cells->table[look_up(cells, at)] = entry = (uint32_t)cells->n;
  }
  cells->cells[entry - 1].count++;
  cells->cells[entry - 1].parts |= UINT64_C(1) << part_of_cell(cells, at, place);
  return CONIC_OK;
}

static int compare_cells(const void *a, const void *b) {
  const conic_cell *first = a, *second = b;
  for (int axis = 0; axis < 3; axis++)
    if (first->at[axis] != second->at[axis])
      return first->at[axis] < second->at[axis] ? -1 : 1;
  return 0;
}

void conic_cells_sort(conic_cells *cells) {
  uint64_t start = 0;
  qsort(cells->cells, cells->n, sizeof *cells->cells, compare_cells);
  for (size_t i = 0; i < cells->n; i++) {
    cells->cells[i].start = start;
    start += cells->cells[i].count;
  }
  fill_table(cells);
}

const conic_cell *conic_cells_neighbour(const conic_cells *cells, const conic_cell *cell, int i) {
  int32_t at[3], step = i;
  if (i == 0)
    return cell;
  step = i <= 13 ? i - 1 : i; /* the middle one of 27 is the cell itself */
  for (int axis = 2; axis >= 0; axis--, step /= 3)
    at[axis] = cell->at[axis] + step % 3 - 1;
  return conic_cells_find(cells, at);
}

/* --- shares --- */

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
