/* What is gathered to be drawn: splats, their numbers in the file, and the pieces of clouds that they come from. */
#ifndef CONIC_LAYERS_SET_H
#define CONIC_LAYERS_SET_H

#include "lod/layers/draw/layers_scene.h"

/* What a cloud has in a place of the cut. */
typedef struct conic_layers_piece {
  uint32_t cloud, i_place;
  uint32_t first, end;  /* its samples */
  uint32_t n_chosen;    /* of these, to be drawn: in the set, from `at` on */
  uint32_t n_turned;    /* facing away, and culled */
  uint32_t n_elsewhere; /* meeting no pixel of the part that is gathered for */
  size_t at;
} conic_layers_piece;

/* Splats to draw. Zero before the first use; the memory is kept from set to set. */
struct conic_layers_set {
  conic_splats splats;
  uint32_t *ids;             /* number of each in the file */
  conic_layers_lines *lines; /* of each, where the file has some */
  size_t room;               /* of all three */
  size_t clips_room;
  float *arrays;                    /* conic_layers_set_arrays, each of `room` */
  struct conic_point_values *named; /* the splats' values, where some are kept */
  conic_layers_piece *pieces;       /* those of the last clouds in memory, in the order of the file */
  size_t n_pieces, pieces_room;
  uint64_t n_chosen, n_turned; /* of all pieces since gathering began */
  int is_cut_short;            /* there were more splats than asked for at most */
};
typedef struct conic_layers_set conic_layers_set;

/* Bytes that drawing takes for a splat of a set, with those in the set and with room to grow. */
enum { CONIC_LAYERS_SPLAT_BYTES = 176 };

/* Empties the set, and names the values that its splats are to have. Errors: MEMORY. */
conic_status conic_layers_set_begin(const conic_layers *layers, conic_layers_set *set);

/* How many arrays of floats the splats of a set have. */
size_t conic_layers_set_arrays(const conic_layers *layers);

/* Room for `count` splats, of which `used` are kept. Errors: MEMORY. */
conic_status conic_layers_set_reserve(const conic_layers *layers, conic_layers_set *set, size_t used, size_t count);

/* Makes records of the splats' clip lines, now that all splats are there. Errors: MEMORY. */
conic_status conic_layers_set_list_lines(const conic_layers *layers, conic_layers_set *set);

void conic_layers_set_release(conic_context *context, conic_layers_set *set);

#endif
