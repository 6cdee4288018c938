/* Several processes that make one thing together. How bytes get from one to another is somebody else's to say, as the
 * program over MPI does, or threads of a test. */
#ifndef CONIC_TEAM_H
#define CONIC_TEAM_H

#include <stddef.h>
#include <stdint.h>

#include "conic/context.h"
#include "core/base/clock.h"

typedef struct conic_team {
  int index, count;
  void *data; /* of whoever made it, which every function gets */

  /* From one to another, to which what one sends comes in the order in which it was sent. Sending may wait until the
   * other receives. What comes goes to `release`. */
  void (*send)(void *data, int to, const void *bytes, size_t n_bytes);
  void *(*receive)(void *data, int from, size_t *n_bytes);
  void (*release)(void *data, void *bytes);

  /* Collective, which is called by every process in the same order: the bytes of all, each after those of the one
   * before; sizes[i] is their number. Goes to `release`. */
  void *(*collect)(void *data, const void *bytes, size_t n_bytes, size_t *sizes);

  /* Takes note that this process has done with a part of the work, of that name, which stays, since a moment; `number`
   * is what the work grows with. Null: nobody wants to know. */
  void (*note)(void *data, const char *name, conic_moment from, uint64_t number);

  /* Where one has no memory for what comes, whoever made the team ends all of it: none of these fails. */
} conic_team;

/* The most processes that there may be. */
enum { CONIC_MOST_IN_TEAM = 1 << 12 };

/* Collective, and `status` where the team is null: OK where it is so of all; else a process whose own is not keeps its
 * own, and the others get CANCELLED, and say nothing. */
conic_status conic_team_agree(const conic_team *team, conic_status status);

/* Collective: what each has of n_bytes, and the same number of all, side by side; `all` has room for count × n_bytes.
 */
void conic_team_collect(const conic_team *team, const void *bytes, size_t n_bytes, void *all);

/* In round `round` of `count` everybody meets another, or itself: whom. Over all rounds everybody meets everybody. */
static inline int conic_team_partner(const conic_team *team, int round) {
  return (round - team->index + team->count) % team->count;
}

/* Calls `note`, if there is one, and returns the moment; fine where the team is null. */
conic_moment conic_team_note(const conic_team *team, const char *name, conic_moment from, uint64_t number);

/* Sends to a partner, who does the same at a time, and receives what it sends. */
void *conic_team_swap(const conic_team *team, int partner, const void *bytes, size_t n_bytes, size_t *n_received);

#endif
