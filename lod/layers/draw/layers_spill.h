/* The splats of a picture, gathered once, put aside by the windows that they may meet, and drawn window by window. */
#pragma once

#include "core/files/pile.h"
#include "lod/layers/draw/layers_gather.h"
#include "raster/project/projected.h"

/* --- windows --- */

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
double conic_layers_place_weight(const conic_layers_place *place);

/* The row of cells that has the part's row of pixels. */
static inline int conic_layers_cell_row(const conic_layers_windows *w, int y) {
  y -= w->part.y_begin;
  return y / w->band_rows * w->rows_a_band + y % w->band_rows / w->cell;
}

/* The column of cells that has the part's column of pixels. */
static inline int conic_layers_cell_column(const conic_layers_windows *w, int x) {
  return (x - w->part.x_begin) / w->cell;
}

/* A window's splats, in the order in which they came. The last of them are in the open block. */
typedef struct conic_layers_heap {
  size_t count;
  uint64_t last_block; /* where it lies in the pile; each says where the one before it does */
} conic_layers_heap;

/* An array with an element for every splat. */
typedef struct conic_layers_column {
  size_t n_bytes; /* of an element */
  char *elements; /* the set's */
} conic_layers_column;

enum { CONIC_LAYERS_MOST_COLUMNS = 17 };

typedef struct conic_layers_spill {
  conic_layers *layers;
  const conic_layers_cut *cut;
  const conic_layers_view *view; /* of the picture that has the windows */
  int samples;                   /* so many of its pixels, a side, are one of the cut's sights' */
  const conic_layers_windows *windows;
  conic_layers_set *set;
  char *path; /* beside which the file lies */
  conic_pile pile;
  int is_open;        /* the pile is */
  size_t block_count; /* splats of a block */
  size_t splat_bytes;
  conic_layers_heap *heaps; /* a window */
  unsigned char *blocks;    /* a window: the open one; null where open ones too are in the pile */
  unsigned char *read;      /* a block that was read */
  size_t boxes_room, listed_room;
  conic_box *boxes; /* of the set's splats: the pixels that each may meet */
  /* Of the part that is put aside: */
  uint32_t *list; /* its splats, window by window */
  size_t *begin;  /* a window: where its own are there */
  atomic_int failed;
} conic_layers_spill;

/* The caller fills in layers, cut, view, samples, windows and set, and leaves all else zero. Each window has a block of
 * so many splats, within limits, that is written once it is full. The caller ends the spill, on failure too. Errors:
 * MEMORY.
 */
conic_status conic_layers_spill_begin(size_t block_count, conic_layers_spill *spill);
void conic_layers_spill_end(conic_layers_spill *spill);

/* The bytes of a splat that is put aside. */
size_t conic_layers_spill_bytes(const conic_layers *layers);

/* Finds the boxes of the splats of the set's pieces. The spill need not have begun. Errors: MEMORY. */
conic_status conic_layers_spill_look(conic_layers_spill *spill);

/* Puts the set's splats aside. Errors: MEMORY, IO. */
conic_status conic_layers_spill_take(conic_layers_spill *spill);

/* Called when nothing more is put aside: gives back the memory for that. Errors: IO. */
conic_status conic_layers_spill_close(conic_layers_spill *spill);

/* Fills the set with what may meet a part of a window, in the order in which it came. Where that is more than `most`
 * (0: any number), *is_too_much is set, and the set is empty. Errors: MEMORY, IO. */
conic_status conic_layers_spill_load(conic_layers_spill *spill, size_t i_window, const conic_window *part, size_t most,
                                     int *is_too_much);

/* --- bands --- */

typedef struct conic_layers_band_drawing {
  conic_layers *layers;
  conic_renderer *renderer;
  const conic_camera *camera;
  const conic_render_options *render; /* near_z and splat_length given */
  const conic_layers_cut *cut;
  const conic_layers_view *view;
  int samples;
  conic_transparency transparency; /* NONE where the samples keep no opacities */
  double chance;
  conic_window window;    /* the picture's pixels that the image has: all, or some within one of its bands */
  const uint32_t *chosen; /* places of the cut, ascending: those that the window may show */
  size_t n_chosen;
  const unsigned char *is_counted; /* a place of the cut: 0 where another window counts what becomes of its splats */
  conic_image *image;
  conic_layers_set *set;
  void (*is_gathered)(void *data); /* called where nothing more will be read; null: nothing */
  void *data;
  uint64_t *n_turned; /* grows by the samples that face away and were left out */
} conic_layers_band_drawing;

/* Draws the chosen places that are not hidden, in as many bands as memory asks for. *statistics become those of the
 * whole picture, whatever the bands; or, for a window, its share of them. Errors: as conic_layers_draw. */
conic_status conic_layers_draw_bands(const conic_layers_band_drawing *drawing, conic_render_statistics *statistics,
                                     int *n_bands);
