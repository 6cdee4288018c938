/* The clouds that several processes have packed, on their way into one file. */
#ifndef CONIC_LAYERS_MOVES_H
#define CONIC_LAYERS_MOVES_H

#include "lod/layers/build/layers_chunks.h"

/* A cloud's bytes: where they are, with whose pile that is in the upper bits, and where in the file they go. */
typedef struct conic_layers_move {
  uint64_t from, to, n_bytes;
} conic_layers_move;

typedef struct conic_layers_moving {
  conic_context *context;
  const conic_team *team;
  const char *path; /* for messages */
  const conic_pile *clouds;
  int descriptor; /* of the file */
  int is_over;    /* all that is to be told has been */
  unsigned char *bytes;
  size_t room;
} conic_layers_moving;

/* In the first process, before anything is told: under which name the file stands that all write to, and where this one
 * writes. Collective. Errors: IO (it has none). */
conic_status conic_layers_moves_begin(conic_layers_moving *moving, const char *temporary, int descriptor);

/* In the first process: what is moved next, CONIC_LAYERS_SOME_NODES at most; 0: there is no more, or, where `status` is
 * a failure, there will not be. Collective. Errors: MEMORY, IO, CANCELLED. */
conic_status conic_layers_moves_tell(conic_layers_moving *moving, conic_status status, const conic_layers_move *moves,
                                     size_t n);

/* Moves, in the others, what the first process tells of, until it is over; `status` is the first one's, which may have
 * failed before it told of anything. Collective. Errors: MEMORY, IO, CANCELLED. */
conic_status conic_layers_moves_end(conic_layers_moving *moving, conic_status status);

#endif
