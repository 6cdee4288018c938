/* Who of several processes grows which branch of one tree: places of about as many samples each, found from where
 * samples are, the same in every process. */
#ifndef CONIC_LAYERS_SHARES_H
#define CONIC_LAYERS_SHARES_H

#include "core/base/team.h"
#include "lod/layers/build/layers_place.h"

/* A branch that one process grows: one of the largest places of the tree that are one's alone. Branches come as a sum
 * in reverse Polish notation does. */
typedef struct conic_layers_limb {
  uint64_t key; /* of its place, or less, but more than any before it */
  int rank;
  unsigned n_joins; /* with what comes before, then */
} conic_layers_limb;

typedef struct conic_layers_shares {
  conic_context *context;
  const conic_team *team; /* null: one process grows all, as one limb */
  size_t n_cells;
  uint64_t *cells; /* the first keys of places in a row, which are all there are, ascending */
  int *owners;     /* of each */
  size_t n_limbs, limb_room;
  conic_layers_limb *limbs;
  uint64_t *own_keys; /* of the own limbs, ascending */
  size_t n_own;
} conic_layers_shares;

/* `least`: places with no more samples are not parted. Collective. Errors: MEMORY, IO, CANCELLED. */
conic_status conic_layers_shares_find(const conic_team *team, const conic_layers_placing *placing,
                                      const conic_layers_plan *plan, uint64_t least, conic_layers_shares *shares);
void conic_layers_shares_end(conic_layers_shares *shares); /* zero is allowed */

/* Who grows the place that a key lies in. */
int conic_layers_shares_owner(const conic_layers_shares *shares, uint64_t key);

#endif
