/* From the limbs that several processes have grown to one tree: branches go from one process to the next to be joined,
 * and the first gets the list of all nodes. */
#ifndef CONIC_LAYERS_CROWN_H
#define CONIC_LAYERS_CROWN_H

#include "lod/layers/build/layers_chunks.h"

/* Joins the limbs of all. `limbs` are the own ones, *n of them, which it takes over, and limb_ends[i] how many nodes
 * there are in the forest when limb i has grown. Afterwards the first process's forest has all nodes. Collective, also
 * for a process whose `status` is a failure. Errors: MEMORY, IO, CANCELLED. */
conic_status conic_layers_crown_join(const conic_layers_shares *shares, conic_status status,
                                     conic_layers_worker *worker, conic_layers_shelf *shelf,
                                     struct conic_layers_waiting *waiting, conic_layers_branch **limbs, size_t *n,
                                     const uint64_t *limb_ends, conic_layers_forest *forest);

/* What workers have counted, of all; fine where the team is null. Collective. Errors: MEMORY. */
conic_status conic_layers_crown_add_up(const conic_team *team, conic_layers_worker *worker,
                                       conic_layers_forest *forest);

#endif
