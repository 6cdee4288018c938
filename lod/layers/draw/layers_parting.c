/* A picture split into windows that few enough splats meet. */
#include "lod/layers/draw/layers_spill.h"

/* No more cells than this along an axis, where the picture is not very long. */
enum { MOST_CELLS = 256 };

typedef struct window_plan {
  const conic_layers_parting *asked;
  conic_layers_windows *w;
  double *sums; /* of the cells above and to the left of a corner: how many splats are there */
} window_plan;

double conic_layers_place_weight(const conic_layers_place *place) {
  double n = (double)place->n_splats;
  return place->state == CONIC_PLACE_SHOWN ? n : place->state == CONIC_PLACE_GRAZING ? n / 16.0 + 1.0 : 0.0;
}

void conic_layers_windows_release(conic_context *context, conic_layers_windows *windows) {
  conic_memory_release_these(context, windows->windows, windows->window_of);
}

/* The first pixel of a row of cells; of the one behind the last, where the picture ends. */
static int cell_top(const conic_layers_windows *w, int row) {
  int y = w->part.y_begin + row / w->rows_a_band * w->band_rows + row % w->rows_a_band * w->cell;
  return y < w->part.y_end ? y : w->part.y_end;
}

static void choose_cells(const conic_layers_parting *asked, conic_layers_windows *w) {
  int step = CONIC_WINDOW_STEP;
  while (step % asked->samples)
    step += CONIC_WINDOW_STEP;
  int width = asked->part.x_end - asked->part.x_begin, height = asked->part.y_end - asked->part.y_begin;
  int longer = width > height ? width : height;
  *w = (conic_layers_windows){.part = asked->part, .band_rows = asked->band_rows < height ? asked->band_rows : height};
  w->cell = (longer / (step * MOST_CELLS) + 1) * step;
  w->n_columns = (width + w->cell - 1) / w->cell;
  w->rows_a_band = (w->band_rows + w->cell - 1) / w->cell;
  w->n_rows = conic_layers_cell_row(w, asked->part.y_end - 1) + 1;
}

/* How much of the pixels from `begin` to before `end` lies between low and high. */
static double share_between(int begin, int end, int low, int high) {
  int from = begin > low ? begin : low, to = end < high ? end : high;
  return from < to ? (double)(to - from) / (double)(end - begin) : 0.0;
}

static double *corner_of(const window_plan *p, int column, int row) {
  return &p->sums[(size_t)row * (size_t)(p->w->n_columns + 1) + (size_t)column];
}

/* Spreads a place's splats over the cells that it may meet. */
static void spread_place(const window_plan *p, const conic_layers_place *place) {
  const conic_layers_windows *w = p->w;
  conic_window pixels = conic_layers_fine_pixels(place, p->asked->samples), in = conic_window_meet(&w->part, &pixels);
  double weight = conic_layers_place_weight(place);
  if (in.x_begin >= in.x_end || in.y_begin >= in.y_end || weight == 0.0)
    return;
  int last_row = conic_layers_cell_row(w, in.y_end - 1), last_column = conic_layers_cell_column(w, in.x_end - 1);
  for (int row = conic_layers_cell_row(w, in.y_begin); row <= last_row; row++) {
    double in_row = weight * share_between(pixels.y_begin, pixels.y_end, cell_top(w, row), cell_top(w, row + 1));
    for (int column = conic_layers_cell_column(w, in.x_begin); column <= last_column; column++) {
      int left = w->part.x_begin + column * w->cell;
      *corner_of(p, column + 1, row + 1) += in_row * share_between(pixels.x_begin, pixels.x_end, left, left + w->cell);
    }
  }
}

static double sum_of(const window_plan *p, const conic_window *c) {
  return *corner_of(p, c->x_end, c->y_end) - *corner_of(p, c->x_begin, c->y_end) - *corner_of(p, c->x_end, c->y_begin) +
         *corner_of(p, c->x_begin, c->y_begin);
}

static conic_window pixels_of_cells(const conic_layers_windows *w, const conic_window *c) {
  int x_end = w->part.x_begin + c->x_end * w->cell;
  return (conic_window){w->part.x_begin + c->x_begin * w->cell, x_end < w->part.x_end ? x_end : w->part.x_end,
                        cell_top(w, c->y_begin), cell_top(w, c->y_end)};
}

/* Those about the window reach into it. */
static int is_small(const window_plan *p, const conic_window *c) {
  conic_window pixels = pixels_of_cells(p->w, c);
  double width = (double)(pixels.x_end - pixels.x_begin), height = (double)(pixels.y_end - pixels.y_begin);
  double growth = (1.0 + 2.0 * p->asked->margin_px / width) * (1.0 + 2.0 * p->asked->margin_px / height);
  return growth * sum_of(p, c) <= p->asked->most && (p->asked->samples == 1 || width * height <= p->asked->most_pixels);
}

/* Halves the longer side, so that each half has as many splats, about. */
static void halve_cells(const window_plan *p, conic_window *first, conic_window *second) {
  int is_along_x = first->x_end - first->x_begin >= first->y_end - first->y_begin;
  double half = 0.5 * sum_of(p, first);
  *second = *first;
  int *end = is_along_x ? &first->x_end : &first->y_end, last = *end;
  for (*end = (is_along_x ? first->x_begin : first->y_begin) + 1; *end < last - 1 && sum_of(p, first) < half;)
    ++*end;
  *(is_along_x ? &second->x_begin : &second->y_begin) = *end;
}

static conic_status add_window(const window_plan *p, const conic_window *c) {
  conic_layers_windows *w = p->w;
  const conic_window pixels = pixels_of_cells(w, c);
  for (int row = c->y_begin; row < c->y_end; row++)
    for (int column = c->x_begin; column < c->x_end; column++)
      w->window_of[(size_t)row * (size_t)w->n_columns + (size_t)column] = (uint32_t)w->n_windows;
  return conic_memory_append(p->asked->layers->context, &w->windows, &w->n_windows, &w->windows_room, &pixels,
                             sizeof pixels);
}

static conic_status part_cells(const window_plan *p, conic_window all) {
  conic_window open[64];
  int n_open = 1;
  conic_status status = CONIC_OK;
  open[0] = all;
  while (n_open > 0 && status == CONIC_OK) {
    conic_window *c = &open[n_open - 1];
    int is_one = c->x_end - c->x_begin == 1 && c->y_end - c->y_begin == 1;
    if (is_one || n_open == 64 || is_small(p, c)) {
      status = add_window(p, c);
      n_open--;
    } else {
      conic_window second;
      halve_cells(p, c, &second);
      open[n_open] = *c;
      open[n_open++ - 1] = second;
    }
  }
  return status;
}

conic_status conic_layers_windows_plan(const conic_layers_parting *parting, conic_layers_windows *windows) {
  conic_context *context = parting->layers->context;
  window_plan p = {.asked = parting, .w = windows};
  choose_cells(parting, windows);
  size_t n_cells = (size_t)windows->n_columns * (size_t)windows->n_rows;
  size_t n_corners = (size_t)(windows->n_columns + 1) * (size_t)(windows->n_rows + 1);
  conic_status status =
      conic_memory_allocate_these(context, CONIC_ROOM(windows->window_of, n_cells), CONIC_ZEROED(p.sums, n_corners));
  if (status == CONIC_OK) {
    for (size_t i = 0; i < p.asked->cut->n; i++)
      spread_place(&p, &p.asked->cut->places[i]);
    for (int row = 1; row <= p.w->n_rows; row++)
      for (int column = 1; column <= p.w->n_columns; column++)
        *corner_of(&p, column, row) +=
            *corner_of(&p, column - 1, row) + *corner_of(&p, column, row - 1) - *corner_of(&p, column - 1, row - 1);
  }
  for (int row = 0; row < windows->n_rows && status == CONIC_OK; row += windows->rows_a_band) {
    int end = row + windows->rows_a_band;
    status = part_cells(&p, (conic_window){0, windows->n_columns, row, end < windows->n_rows ? end : windows->n_rows});
  }
  conic_memory_release(context, p.sums);
  return status;
}
