/* Several processes that make one thing together: a team. Whoever makes the team says how bytes get from one process to
 * another: the program over MPI, or threads of a test. */
#pragma once

#include <stdint.h>

#include "conic/context.h"
#include "core/base/clock.h"

typedef struct conic_team {
  int index, count;
  void *data; /* of whoever made the team; every function gets it */

  /* Between two processes: messages arrive in the order in which they were sent. Sending may wait until the other
   * receives. `release` frees received bytes. */
  void (*send)(void *data, int to, const void *bytes, size_t n_bytes);
  void *(*receive)(void *data, int from, size_t *n_bytes);
  void (*release)(void *data, void *bytes);

  /* Collective: every process calls it in the same order. Returns the bytes of all processes, one after the other;
   * sizes[i] are those of process i. `release` frees them. */
  void *(*collect)(void *data, const void *bytes, size_t n_bytes, size_t *sizes);

  /* Notes that this process has done a part of the work since the moment `from`. The name stays valid; `number` is what
   * the work grows with. Null: not noted. */
  void (*note)(void *data, const char *name, conic_moment from, uint64_t number);

  /* None of these fails: without memory for received bytes, whoever made the team ends all of it. */
} conic_team;

/* The most processes in a team. */
enum { CONIC_MOST_IN_TEAM = 1 << 12 };

/* Collective; returns `status` where the team is null. OK if all processes have OK. Else a process that failed keeps
 * its own status, and the others get CANCELLED, without a message. */
conic_status conic_team_status(const conic_team *team, conic_status status);

/* The same, by which who reads a caller's code alone sees that OK means its own OK, too. */
static inline conic_status conic_team_agree(const conic_team *team, conic_status status) {
  conic_status of_all = conic_team_status(team, status);
  return status != CONIC_OK ? status : of_all;
}

/* Collective: gathers n_bytes of each process side by side, for which `all` has room; it may be `bytes`. Returns how
 * many bytes they are together. */
size_t conic_team_collect(const conic_team *team, const void *bytes, size_t n_bytes, void *all);

/* The partner of this process in round `round` of `count`; it may be itself. Over all rounds every process meets every
 * other. */
static inline int conic_team_partner(const conic_team *team, int round) {
  return (round - team->index + team->count) % team->count;
}

/* Calls `note`, if there is one, and returns the present moment; the team may be null. */
conic_moment conic_team_note(const conic_team *team, const char *name, conic_moment from, uint64_t number);

/* Sends to a partner, which does the same at the same time, and receives what it sends. */
void *conic_team_swap(const conic_team *team, int partner, const void *bytes, size_t n_bytes, size_t *n_received);
