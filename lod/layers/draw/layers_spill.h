/* The splats of a picture, put aside by the windows that they may meet: gathered once, drawn window by window. */
#ifndef CONIC_LAYERS_SPILL_H
#define CONIC_LAYERS_SPILL_H

#include "core/files/pile.h"
#include "lod/layers/draw/layers_gather.h"
#include "lod/layers/draw/layers_parting.h"
#include "raster/project/projected.h"

/* A window's splats, in the order in which they came: those of the open block last. */
typedef struct conic_layers_heap {
  size_t count;
  uint64_t last_block; /* where it lies in the pile; each tells where the one before it does */
} conic_layers_heap;

/* An array of which every splat has an element. */
typedef struct conic_layers_column {
  size_t n_bytes; /* of an element */
  char *elements; /* the set's */
} conic_layers_column;

enum { CONIC_LAYERS_MOST_COLUMNS = 17 };

typedef struct conic_layers_spill {
  conic_layers *layers;
  const conic_layers_cut *cut;
  const conic_layers_view *view; /* of the picture that has the windows */
  int samples;                   /* its pixels are so much smaller than those of the cut's sights */
  const conic_layers_windows *windows;
  conic_layers_set *set;
  char *path; /* beside which the file lies */
  conic_pile pile;
  int is_open;        /* the pile is */
  size_t block_count; /* splats of a block */
  size_t splat_bytes;
  conic_layers_heap *heaps; /* a window */
  unsigned char *blocks;    /* a window: the open one; null where those too are in the pile */
  unsigned char *read;      /* a block that was read */
  size_t boxes_room, listed_room;
  conic_box *boxes; /* of the set's splats: the pixels that each may meet */
  /* Of the part that is put aside: */
  uint32_t *list; /* its splats, window by window */
  size_t *begin;  /* a window: where its own are there */
  atomic_int failed;
} conic_layers_spill;

/* `spill` names layers, cut, view, samples, windows and set; all else is zero. Of each window a block of so many splats
 * is filled, within limits, before it is written. The caller ends it, on failure too. Errors: MEMORY. */
conic_status conic_layers_spill_begin(size_t block_count, conic_layers_spill *spill);
void conic_layers_spill_end(conic_layers_spill *spill);

/* What a splat takes that is put aside. */
size_t conic_layers_spill_bytes(const conic_layers *layers);

/* Finds the boxes of the splats that the set's pieces have; of a spill that was not begun, too. Errors: MEMORY. */
conic_status conic_layers_spill_look(conic_layers_spill *spill);

/* Puts the set's splats aside. Errors: MEMORY, IO. */
conic_status conic_layers_spill_take(conic_layers_spill *spill);

/* Nothing more is put aside: gives back what that took. Errors: IO. */
conic_status conic_layers_spill_close(conic_layers_spill *spill);

/* Fills the set with what may meet a part of a window, in the order in which it came; but where that is more than
 * `most`, which is 0 for any number, *is_too_much is set, and the set is empty. Errors: MEMORY, IO. */
conic_status conic_layers_spill_load(conic_layers_spill *spill, size_t i_window, const conic_window *part, size_t most,
                                     int *is_too_much);

#endif
