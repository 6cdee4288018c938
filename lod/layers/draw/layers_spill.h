/* The splats of a picture, gathered once, put aside by the windows that they may meet, and drawn window by window. */
#ifndef CONIC_LAYERS_SPILL_H
#define CONIC_LAYERS_SPILL_H

#include "core/files/pile.h"
#include "lod/layers/draw/layers_gather.h"
#include "lod/layers/draw/layers_parting.h"
#include "raster/project/projected.h"

/* A window's splats, in the order in which they came. The last of them are in the open block. */
typedef struct conic_layers_heap {
  size_t count;
  uint64_t last_block; /* where it lies in the pile; each says where the one before it does */
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

#endif
