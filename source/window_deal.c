#include "source/window_deal.h"

#include "core/base/base.h"

/* Rough costs, in one unit: setting up and sorting a splat, a sample that it may cover, and finishing a pixel's
 * sample. */
enum { OF_SPLAT = 32, OF_SAMPLE = 1, OF_PIXEL = 4 };

/* The windows' edges divide the picture into cells, each in one window or in none. */
typedef struct cell_grid {
  size_t n[2];       /* columns, rows */
  int length[2];     /* of the picture, in samples */
  uint16_t *cell[2]; /* of each column and row of samples: its column or row of cells */
  int *first[2];     /* where each column and row of cells begins; and the end */
  uint32_t *window;  /* of each cell: its window; the number of windows: none */
} cell_grid;

/* The cells that a splat may cover, from begin to before end. */
typedef struct cells_range {
  size_t begin[2], end[2];
  int low[2], high[2]; /* in samples */
} cells_range;

/* --- the grid --- */

static int window_begin(const conic_window *window, int axis) {
  return axis ? window->y_begin : window->x_begin;
}

static int window_end(const conic_window *window, int axis) {
  return axis ? window->y_end : window->x_end;
}

static conic_status cut_into_cells(conic_context *context, const conic_dealing *d, int axis, cell_grid *grid) {
  int length = 0;
  for (size_t i = 0; i < d->n; i++)
    length = window_end(&d->list[i], axis) > length ? window_end(&d->list[i], axis) : length;
  length *= d->samples;
  grid->length[axis] = length;
  if (conic_memory_allocate_these(context, CONIC_ZEROED(grid->cell[axis], (size_t)length + 1),
                                  CONIC_ROOM(grid->first[axis], (size_t)length + 1)) != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  grid->cell[axis][0] = 1;
  for (size_t i = 0; i < d->n; i++) {
    const size_t samples = (size_t)d->samples;
    grid->cell[axis][samples * (size_t)window_begin(&d->list[i], axis)] =
        grid->cell[axis][samples * (size_t)window_end(&d->list[i], axis)] = 1;
  }
  size_t n = 0;
  for (int at = 0; at < length; at++) {
    if (grid->cell[axis][at])
      grid->first[axis][n++] = at;
    grid->cell[axis][at] = (uint16_t)(n - 1);
  }
  grid->first[axis][n] = length;
  grid->n[axis] = n;
  return CONIC_OK;
}

/* The cells from `low` to before `high` of an axis, in samples; empty where that is nothing. */
static void cells_between(const cell_grid *grid, int axis, int low, int high, cells_range *range) {
  low = low < 0 ? 0 : low;
  high = high < grid->length[axis] ? high : grid->length[axis];
  range->low[axis] = low;
  range->high[axis] = high;
  range->begin[axis] = low < high ? grid->cell[axis][low] : 0;
  range->end[axis] = low < high ? (size_t)grid->cell[axis][high - 1] + 1 : 0;
}

static conic_status name_cells(conic_context *context, const conic_dealing *d, cell_grid *grid) {
  grid->window = conic_memory_allocate(context, grid->n[0] * grid->n[1], sizeof *grid->window);
  if (!grid->window)
    return CONIC_ERROR_MEMORY;
  for (size_t k = 0; k < grid->n[0] * grid->n[1]; k++)
    grid->window[k] = (uint32_t)d->n;
  for (size_t i = 0; i < d->n; i++) {
    cells_range range;
    for (int axis = 0; axis < 2; axis++)
      cells_between(grid, axis, d->samples * window_begin(&d->list[i], axis),
                    d->samples * window_end(&d->list[i], axis), &range);
    for (size_t y = range.begin[1]; y < range.end[1]; y++)
      for (size_t x = range.begin[0]; x < range.end[0]; x++)
        grid->window[y * grid->n[0] + x] = (uint32_t)i;
  }
  return CONIC_OK;
}

static void release_grid(conic_context *context, cell_grid *grid) {
  for (int axis = 0; axis < 2; axis++)
    conic_memory_release_these(context, grid->cell[axis], grid->first[axis]);
  conic_memory_release(context, grid->window);
}

/* The caller releases the grid, on failure too. */
static conic_status begin_grid(conic_context *context, const conic_dealing *d, cell_grid *grid) {
  conic_status status = CONIC_OK;
  memset(grid, 0, sizeof *grid);
  for (int axis = 0; axis < 2 && status == CONIC_OK; axis++)
    status = cut_into_cells(context, d, axis, grid);
  return status == CONIC_OK ? name_cells(context, d, grid) : status;
}

/* Finds the cells that splat i may cover; returns whether there are any. */
static int cells_of_splat(const conic_dealing *d, const cell_grid *grid, size_t i, cells_range *range) {
  const conic_box *box = &d->boxes[i];
  if (conic_box_is_empty(box))
    return 0;
  cells_between(grid, 0, box->x_begin - d->margin, box->x_end + d->margin, range);
  cells_between(grid, 1, box->y_begin - d->margin, box->y_end + d->margin, range);
  return 1;
}

/* --- weights --- */

/* How many samples a range has in a column or row of cells. */
static uint64_t length_in_cell(const cell_grid *grid, const cells_range *range, int axis, size_t cell) {
  int low = grid->first[axis][cell], high = grid->first[axis][cell + 1];
  low = low > range->low[axis] ? low : range->low[axis];
  high = high < range->high[axis] ? high : range->high[axis];
  return (uint64_t)(high - low);
}

static void weigh_splats(const conic_dealing *d, const cell_grid *grid, uint64_t *weights) {
  cells_range range;
  for (size_t i = 0; i < d->n_splats; i++) {
    if (!cells_of_splat(d, grid, i, &range))
      continue;
    for (size_t y = range.begin[1]; y < range.end[1]; y++)
      for (size_t x = range.begin[0]; x < range.end[0]; x++)
        weights[grid->window[y * grid->n[0] + x]] +=
            OF_SPLAT + OF_SAMPLE * length_in_cell(grid, &range, 0, x) * length_in_cell(grid, &range, 1, y);
  }
}

/* --- dealing --- */

typedef struct weighed_window {
  uint64_t weight;
  size_t index;
} weighed_window;

static int compare_windows(const void *a, const void *b) {
  const weighed_window *first = a, *second = b;
  if (first->weight != second->weight)
    return first->weight < second->weight ? 1 : -1;
  return first->index < second->index ? -1 : 1;
}

/* Gives each window to the process with the least work so far: the heaviest first, so that the last ones even out the
 * rest. */
static void give_windows(const conic_dealing *d, weighed_window *windows, uint64_t *loads, int *owners) {
  owners[0] = 0;
  loads[0] = windows[0].weight;
  if (!d->is_in_order)
    qsort(windows + 1, d->n - 1, sizeof *windows, compare_windows);
  for (size_t i = 1; i < d->n; i++) {
    int least = 0;
    for (int k = 1; k < d->team->count; k++)
      least = loads[k] < loads[least] ? k : least;
    owners[windows[i].index] = least;
    loads[least] += windows[i].weight;
  }
}

static void weigh_windows(const conic_dealing *d, const uint64_t *weights, weighed_window *windows) {
  for (size_t i = 0; i < d->n; i++) {
    const conic_window *window = &d->list[i];
    uint64_t n_pixels = (uint64_t)(window->x_end - window->x_begin) * (uint64_t)(window->y_end - window->y_begin);
    windows[i] = (weighed_window){weights[i] + OF_PIXEL * (uint64_t)(d->samples * d->samples) * n_pixels, i};
  }
}

conic_status conic_windows_deal(conic_context *context, const conic_dealing *d, int *owners) {
  const conic_splats_shares all = {.team = d->team};
  cell_grid grid;
  uint64_t *weights = conic_memory_allocate_zeroed(context, d->n + 1, sizeof *weights); /* the last is for cells without
                                                                                           a window */
  uint64_t *loads = conic_memory_allocate_zeroed(context, (size_t)d->team->count, sizeof *loads);
  weighed_window *windows = conic_memory_allocate(context, d->n, sizeof *windows);
  conic_status status = begin_grid(context, d, &grid);
  status = conic_team_agree(d->team, weights && loads && windows ? status : CONIC_ERROR_MEMORY);
  if (status == CONIC_OK) {
    weigh_splats(d, &grid, weights);
    conic_shares_take_sums(&all, weights, d->n);
    weigh_windows(d, weights, windows);
    give_windows(d, windows, loads, owners);
  }
  release_grid(context, &grid);
  conic_memory_release_these(context, weights, loads, windows);
  return status;
}

/* --- whose splats --- */

/* Lists, for each process, the splats that may cover some of its windows, each once. */
typedef struct splat_lister {
  const conic_dealing *dealing;
  const cell_grid *grid;
  const int *owners;
  size_t *last;   /* of a process: 1 + the splat listed last */
  size_t *next;   /* of a process: where its next splat goes */
  uint32_t *list; /* null: only counts */
} splat_lister;

static void list_splats_once(const splat_lister *l) {
  cells_range range;
  memset(l->last, 0, (size_t)l->dealing->team->count * sizeof *l->last);
  for (size_t i = 0; i < l->dealing->n_splats; i++) {
    if (!cells_of_splat(l->dealing, l->grid, i, &range))
      continue;
    for (size_t y = range.begin[1]; y < range.end[1]; y++)
      for (size_t x = range.begin[0]; x < range.end[0]; x++) {
        uint32_t window = l->grid->window[y * l->grid->n[0] + x];
        int owner = window < l->dealing->n ? l->owners[window] : -1;
        if (owner < 0 || l->last[owner] == i + 1)
          continue;
        l->last[owner] = i + 1;
        if (l->list)
          l->list[l->next[owner]] = (uint32_t)i;
        l->next[owner]++;
      }
  }
}

static conic_status list_in_grid(conic_context *context, splat_lister *l, size_t *begin) {
  size_t count = (size_t)l->dealing->team->count;
  memset(l->next, 0, count * sizeof *l->next);
  list_splats_once(l);
  begin[0] = 0;
  for (size_t k = 0; k < count; k++) {
    begin[k + 1] = begin[k] + l->next[k];
    l->next[k] = begin[k];
  }
  l->list = conic_memory_allocate(context, begin[count], sizeof *l->list);
  if (!l->list)
    return CONIC_ERROR_MEMORY;
  list_splats_once(l);
  return CONIC_OK;
}

conic_status conic_windows_list_splats(conic_context *context, const conic_dealing *d, const int *owners, size_t *begin,
                                       uint32_t **list) {
  cell_grid grid;
  splat_lister lister = {.dealing = d, .grid = &grid, .owners = owners};
  lister.last = conic_memory_allocate(context, (size_t)d->team->count, sizeof *lister.last);
  lister.next = conic_memory_allocate(context, (size_t)d->team->count, sizeof *lister.next);
  conic_status status = begin_grid(context, d, &grid);
  if (status == CONIC_OK)
    status = lister.last && lister.next ? list_in_grid(context, &lister, begin) : CONIC_ERROR_MEMORY;
  release_grid(context, &grid);
  conic_memory_release_these(context, lister.last, lister.next);
  *list = lister.list;
  return status;
}
