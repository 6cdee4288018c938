/* Which places of a layered point cloud a picture shows, and how fine: the cut through its tree. */
#pragma once

#include "lod/layers/draw/layers_scene.h"
#include "lod/layers/draw/layers_view.h"

/* Whether two nodes have one place. Where these stand side by side, they split samples that coincide, and what lies
 * above both is drawn once. */
static inline int conic_layers_is_same_place(const conic_layers_entry *a, const conic_layers_entry *b) {
  return a->key == b->key && a->depth == b->depth;
}

/* How much of a place is drawn. */
typedef enum conic_place_state {
  CONIC_PLACE_SHOWN,
  CONIC_PLACE_GRAZING, /* hidden, but for splats whose planes are within `offset` of the eye */
  CONIC_PLACE_HIDDEN
} conic_place_state;

typedef struct conic_layers_place {
  uint32_t node;
  uint32_t stand_ins; /* the cloud that is drawn in place of its samples; 0: none */
  uint32_t n_splats;  /* that are drawn */
  conic_place_state state;
  double offset;
  conic_layers_sight sight;
} conic_layers_place;

/* The bounds of what is drawn of a place. */
static inline const conic_layers_entry *conic_layers_place_entry(const conic_layers *layers,
                                                                 const conic_layers_place *place) {
  return &layers->entries[place->stand_ins ? place->stand_ins : place->node];
}

/* The pixels that a place may cover in a picture of n × as many, a side. */
static inline conic_window conic_layers_fine_pixels(const conic_layers_place *place, int n) {
  const conic_window *in = &place->sight.pixels;
  return (conic_window){n * in->x_begin, n * in->x_end, n * in->y_begin, n * in->y_end};
}

/* Places in the order of their keys. Zero before the first use; the memory is kept. */
typedef struct conic_layers_cut {
  conic_layers_place *places;
  conic_layers_turned *turned; /* a place: its samples that face away and are to be culled; null: none are */
  size_t n, room, turned_room;
  uint64_t n_splats;  /* of all places together */
  uint64_t n_coarser; /* places that were to be finer */
  double coarser_px;  /* the greatest error among them */
  uint64_t n_root;    /* so many samples are drawn where the root is the only place; 0: all of them */
} conic_layers_cut;

typedef struct conic_layers_wish {
  double error_px;
  int most_levels;            /* 0: all */
  const unsigned char *is_in; /* a cloud: whether it can be used; null: all can */
  uint64_t n_root;            /* as in a cut */
  int may_stand_in;           /* coarse places are drawn as their stand-ins, */
  int prefers_stand_ins;      /* wherever samples would be no finer than the leaves' stand-ins */
} conic_layers_wish;

/* Finds the cut. On the way down from the root it takes, of what is in sight, the first node whose error is at most the
 * one asked for, or below which a cloud is missing. Errors: MEMORY. */
conic_status conic_layers_find_cut(const conic_layers *layers, const conic_layers_view *view,
                                   const conic_layers_wish *wish, conic_layers_cut *cut);

/* Finds the least error for which a cut like this has no more than `budget` splats. Where the root alone has more, the
 * error is infinite, and *n_root how many of its samples are to be drawn then; else that is 0, for all of the cut's.
 * Errors: MEMORY. */
conic_status conic_layers_fit_budget(const conic_layers *layers, const conic_layers_view *view,
                                     const conic_layers_wish *wish, uint64_t budget, double *error_px,
                                     uint64_t *n_root);

void conic_layers_cut_release(conic_context *context, conic_layers_cut *cut);

/* Marks the clouds that a place needs: its own and all above it, or its stand-ins. Returns how many were not marked
 * before. */
size_t conic_layers_mark_needed(const conic_layers *layers, const conic_layers_place *place, unsigned char *needed);

/* Finds the clouds that are needed for the cut's places in the states up to `last`: needed[c] becomes 1 for them, and 0
 * for all others. Returns how many there are. */
size_t conic_layers_needed(const conic_layers *layers, const conic_layers_cut *cut, conic_place_state last,
                           unsigned char *needed);
