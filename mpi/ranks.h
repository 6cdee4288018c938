/* The processes of an MPI job. ranks.c alone sees mpi.h.
 *
 * A thread of rank 0 gives out units and takes what is handed over, while rank 0 computes like all others: no rank is a
 * mere master. Waiting is asleep, so that ranks may be more than cores. What MPI itself finds wrong ends all ranks.
 * "Collective" functions are called by all ranks in the same order, each by one thread. */
#pragma once

#include "shots/executor.h"

/* Begins and ends; without MPI's consent to threads ends all ranks with a message. */
void ranks_begin(int *argc, char ***argv);
void ranks_end(void);

int ranks_index(void);
int ranks_count(void);
/* How many of the ranks are on this rank's machine, itself among them. Collective. */
int ranks_on_machine(void);
/* "Open MPI v4.1.4 …", one line. */
void ranks_library(char *text, size_t room);

/* Makes the ranks the processes of a team, `executor` as whoever draws takes it, and `team` the library. What they do
 * is noted by whoever sets `did`, `trace` and `note`; `agree` is the caller's to set, which knows what statuses are as
 * codes. Any number of bytes may be handed over: they go in pieces, and up to OUTBOX_ROOM (mpi/outbox.h) while the rank
 * goes on. */
void ranks_fill(conic_executor *executor, conic_team *team);

/* Collective: on rank 0 the bytes of all ranks in their order, to be freed by the caller, and their number each in
 * `sizes`; null elsewhere, and without memory. */
void *ranks_gather(const void *bytes, size_t n_bytes, size_t *sizes);
/* Collective. */
void ranks_barrier(void);
