/* What is kept of a layered cloud while it is built, so that any number of processes can go on with it after any end.
 * The folder OUT.branches has the branches that have grown, each in a file of its own, and for each process a list of
 * those that it has grown (core/files/finished.h). The parts of a list are named
 *
 *   branch KEY BITS SAMPLES     the place, and how many samples it holds
 *   axes INPUT                  what has been estimated of an input's points, which may take as long as growing
 */
#pragma once

#include "core/files/finished.h"
#include "lod/layers/build/layers_team.h"

/* A place of the tree, by its first key and how many bits of keys lie below, and how many samples it has. All samples
 * whose keys are there belong to it. */
typedef struct conic_layers_kept_branch {
  uint64_t key, n_samples;
  unsigned n_bits;
} conic_layers_kept_branch;

/* What is kept of an input, by its number, and where the line of its file is. */
typedef struct conic_layers_kept_input {
  uint64_t number;
  size_t file_at;
} conic_layers_kept_input;

typedef struct conic_layers_kept {
  conic_context *context;
  const conic_team *team;
  const char *key; /* null: nothing is kept */
  char *folder;    /* with a separator behind its name */
  size_t n_folder;
  conic_finished found; /* in all lists */
  size_t n, room;
  conic_layers_kept_branch *branches; /* that were there, whole, ascending by key; no two overlap */
  uint64_t n_samples;                 /* in these */
  size_t n_inputs, input_room;
  conic_layers_kept_input *inputs; /* of two with one number the latter counts; they may not be whole */
  FILE *stream;                    /* of this process's list */
} conic_layers_kept;

/* Finds what is kept beside PATH and can be used, the same in all processes, and begins the lists anew with it; or with
 * nothing, as `keeping` says. A null `keeping` keeps nothing. Collective. Errors: INPUT (what is there is of another
 * key, or there is nothing), MEMORY, IO, CANCELLED. */
conic_status conic_layers_kept_begin(conic_context *context, const char *path, const conic_team *team,
                                     const conic_layers_keeping *keeping, conic_layers_kept *kept);
/* Zero is allowed. */
void conic_layers_kept_end(conic_layers_kept *kept);
/* Removes all of it. Collective. */
void conic_layers_kept_remove(conic_layers_kept *kept);

/* The branch in whose place a key lies, or null. */
const conic_layers_kept_branch *conic_layers_kept_find(const conic_layers_kept *kept, uint64_t key);

/* Keeps the bytes of a branch. It comes onto the list once its file is whole. Several threads may do so. Errors:
 * MEMORY, IO. */
conic_status conic_layers_kept_add(conic_layers_kept *kept, const conic_layers_kept_branch *branch,
                                   const unsigned char *bytes, size_t n_bytes);

/* Keeps bytes of an input, in so many pieces. Opening returns a stream of what is kept of one, where it has so many
 * bytes and is whole; else null. Errors: MEMORY, IO. */
conic_status conic_layers_kept_add_input(conic_layers_kept *kept, uint64_t number,
                                         const conic_layers_kept_bytes *pieces, size_t n_pieces);
FILE *conic_layers_kept_open_input(const conic_layers_kept *kept, uint64_t number, uint64_t n_bytes);

/* The bytes of one, which the caller releases. Errors: MEMORY, IO. */
conic_status conic_layers_kept_read(const conic_layers_kept *kept, const conic_layers_kept_branch *branch,
                                    unsigned char **bytes, size_t *n_bytes);
