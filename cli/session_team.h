/* Several processes that run one command together, each with all of its arguments, as conic-mpi's ranks do. The first
 * one, number 0, speaks for all. A command that knows teams shares out units of its work; who does which unit decides
 * no bit of what comes out.
 *
 * Collective functions are called by every process of the team in the same order. So whoever failed comes to the next
 * cli_team_agree, too, and after one that returned a failure there are no collective functions any more. */
#ifndef CONIC_SESSION_TEAM_H
#define CONIC_SESSION_TEAM_H

#include <stddef.h>
#include <stdint.h>

#include "cli/session.h"
#include "core/base/team.h"
#include "shots/executor.h"

typedef struct cli_team {
  int index, count;
  int cut_for; /* so many processes units of work are cut for: `count`, or as many as a trace is to tell of */
  int threads; /* of this process, unless --threads says otherwise: others share its machine */

  /* Collective: from now on `next` gives the units from 0 to before `n`. What `hand` is given arrives in the first
   * process's `take`, one call at a time, on any thread, until the next `agree` has returned; null: nothing is handed.
   */
  void (*share)(uint64_t n, void (*take)(void *cookie, int from, void *bytes, size_t n_bytes), void *cookie);
  /* Takes the next unit: each is given to one process; CONIC_NO_UNIT when there is none. */
  uint64_t (*next)(void);
  /* Nobody is given any more: something failed. */
  void (*stop)(void);
  /* In the first process, which may wait until later: no unit from `end` on is given yet. */
  void (*allow)(uint64_t end);
  /* Hands bytes to the first process. They may change when it returns. */
  void (*hand)(const void *bytes, size_t n_bytes);

  /* Collective: the greatest exit code of all, and the message of the first that has it, which all get. */
  int (*agree)(int exit_code, char *message, size_t room);
  /* Collective: the bytes of process 0 come to all. */
  void (*broadcast)(void *bytes, size_t n_bytes);
  /* Collective: in process 0 the bytes of all, each after those of the one before, which the caller frees; sizes[i] is
   * their number. Null elsewhere, and without memory. */
  void *(*gather)(const void *bytes, size_t n_bytes, size_t *sizes);
  /* From one to another, which calls `receive` with the sender's number; what it returns the caller frees. */
  void (*send)(int to, const void *bytes, size_t n_bytes);
  void *(*receive)(int from, size_t *n_bytes);

  /* What this process has sent and received so far, and how long it has waited for others. */
  void (*count_traffic)(uint64_t *sent_bytes, uint64_t *received_bytes, double *waited_seconds);
  /* Takes note of what this process did, between two moments. `kind` is "open" (before its units),
   * "unit", "join" (what the first does with a result) or "write", `name` "frame" or the like; both stay. */
  void (*trace)(const char *kind, const char *name, uint64_t number, conic_moment from, conic_moment to,
                uint64_t sent_bytes);
} cli_team;

/* While its thread takes what others hand over, the first process gets on more slowly, and should not be the last to
 * end. So it leaves the rest to them once there are fewer units for each than eight times the part of its time that
 * went so. That part is not known before the first results come, so it is taken to be n_processes / 64 at least. */
static inline int cli_team_leaves_rest(double n_left, int n_processes, double busy_s, double of_s) {
  double part = of_s > 0.0 ? busy_s / of_s : 0.0, least = n_processes / 64.0;
  return n_left < 8.0 * n_processes * (part > least ? part : least);
}

/* The team of this process from now on, whose messages it keeps; null: it is alone. */
void cli_team_join(cli_team *team);
/* Whether the message is not to be printed here and now: an error is printed once all have agreed, what else others
 * than the first process say is not printed. */
int cli_team_keeps(conic_log_level level, const char *message);

/* Whether there are others to share the work with. */
int cli_team_is_shared(const cli_session *session);
/* Whether this process speaks: it is alone, or the first. */
int cli_team_is_first(const cli_session *session);
/* The same processes, as what the library builds by several takes them; null where nobody shares the work. */
const conic_team *cli_team_of_library(const cli_session *session, conic_team *team);
/* What the library has noted that this process did of them. */
void cli_team_count_stages(uint64_t *n, double *seconds);
/* Does what the team's function does, if there is a team. */
void cli_team_trace(const cli_session *session, const char *kind, const char *name, uint64_t number, conic_moment from,
                    uint64_t sent_bytes);
/* Collective: the exit code of what all came to; where a process was only told that another failed, its own does not
 * count. */
int cli_team_exit(const cli_session *session, conic_status status);
/* Collective: the greatest exit code of all, whose message the first process prints; alone, the code itself. After a
 * failure it is that failure at once. */
int cli_team_agree(const cli_session *session, int exit_code);

#endif
