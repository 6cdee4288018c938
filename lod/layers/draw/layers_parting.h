/* A picture split into windows that few enough splats meet. */
#ifndef CONIC_LAYERS_PARTING_H
#define CONIC_LAYERS_PARTING_H

#include "lod/layers/draw/layers_cut.h"

/* What is split: a picture, or a part of it, that is drawn in bands of band_rows rows, each by a camera of its own. On
 * a side, it has `samples` times as many pixels as the cut's sights tell of. */
typedef struct conic_layers_parting {
  const conic_layers *layers;
  const conic_layers_cut *cut;
  conic_window part; /* from the begin of a band to the end of one, or within one */
  int band_rows, samples;
  double most_pixels; /* of a window, with more than one sample a pixel; a window has a cell at least */
  double most;        /* splats that may meet a window, if each place's are spread evenly */
  double margin_px;   /* how far from its middle a splat is taken to reach */
} conic_layers_parting;

/* Windows have whole cells. Zero before the first use. */
typedef struct conic_layers_windows {
  conic_window part;
  int band_rows; /* from the part's first on */
  int cell;      /* the edge, in pixels: a multiple of CONIC_WINDOW_STEP and of the samples */
  int n_columns, n_rows, rows_a_band;
  conic_window *windows; /* each within a band */
  uint32_t *window_of;   /* a cell */
  size_t n_windows, windows_room;
} conic_layers_windows;

/* Errors: MEMORY. */
conic_status conic_layers_windows_plan(const conic_layers_parting *parting, conic_layers_windows *windows);
void conic_layers_windows_release(conic_context *context, conic_layers_windows *windows);

/* About how many splats a place gives; a grazing one gives few. */
double conic_layers_place_weight(const conic_layers *layers, const conic_layers_place *place);

/* The row of cells that has the part's row of pixels. */
static inline int conic_layers_cell_row(const conic_layers_windows *w, int y) {
  y -= w->part.y_begin;
  return y / w->band_rows * w->rows_a_band + y % w->band_rows / w->cell;
}

/* The column of cells that has the part's column of pixels. */
static inline int conic_layers_cell_column(const conic_layers_windows *w, int x) {
  return (x - w->part.x_begin) / w->cell;
}

#endif
