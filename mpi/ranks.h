/* The processes of an MPI job. ranks.c alone sees mpi.h.
 *
 * A thread of rank 0 gives out units and takes what is handed over, while rank 0 computes like all others: no rank is a
 * mere master. Waiting is asleep, so that ranks may be more than cores. What MPI itself finds wrong ends all ranks.
 * "Collective" functions are called by all ranks in the same order, each by one thread. */
#ifndef CONIC_RANKS_H
#define CONIC_RANKS_H

#include <stddef.h>
#include <stdint.h>

/* Begins and ends; without MPI's consent to threads ends all ranks with a message. */
void ranks_begin(int *argc, char ***argv);
void ranks_end(void);

int ranks_index(void);
int ranks_count(void);
/* How many of the ranks are on this rank's machine, itself among them. Collective. */
int ranks_on_machine(void);
/* "Open MPI v4.1.4 …", one line. */
void ranks_library(char *text, size_t room);

/* Past the last unit. */
#define RANKS_NO_UNIT UINT64_MAX

/* Called on rank 0, one call at a time. */
typedef void ranks_take(void *cookie, int from, void *bytes, size_t n_bytes);

/* Collective: ranks_next gives the units from 0 to before `n` from now on, each to one rank, and ranks_hand hands to
 * `take` of rank 0, which may be null. The last ranks_agree must have come after all units and hands before. */
void ranks_share(uint64_t n, ranks_take *take, void *cookie);
uint64_t ranks_next(void);
/* Nobody is given any more. */
void ranks_stop(void);
/* On rank 0: units from `end` on are not given yet, and who wants one waits. */
void ranks_allow(uint64_t end);
/* Hands bytes to rank 0; they may change when it returns. Any number of them: they go in pieces, and up to HANDS_ROOM
 * (mpi/hands.h) while the rank goes on. */
void ranks_hand(const void *bytes, size_t n_bytes);

/* Collective: the greatest code of all ranks, and in `message` the text of the first rank that has it. What was handed
 * before has been taken after it. */
int ranks_agree(int code, char *message, size_t room);
/* Collective: rank 0's bytes come to all. */
void ranks_broadcast(void *bytes, size_t n_bytes);
/* Collective: on rank 0 the bytes of all ranks in their order, to be freed by the caller, and their number each in
 * `sizes`; null elsewhere, and without memory. */
void *ranks_gather(const void *bytes, size_t n_bytes, size_t *sizes);
/* From one rank to another, which calls ranks_receive: the caller frees what it returns. */
void ranks_send(int to, const void *bytes, size_t n_bytes);
void *ranks_receive(int from, size_t *n_bytes);
/* Collective. */
void ranks_barrier(void);

/* What this rank has sent and received, and how long it has waited for others. */
typedef struct ranks_traffic {
  uint64_t sent_bytes, received_bytes;
  double waited_seconds;
} ranks_traffic;

ranks_traffic ranks_traffic_now(void);

#endif
