/* Who does which unit of a picture's work: rows of it, samples, or whole frames. Each process asks for the next one and
 * hands its result to the first; one that is alone gets all. Who does a unit decides no bit.
 *
 * Collective functions are called by every process in the same order. A process that fails goes on to the next `agree`;
 * after one that returned a failure no collective function is called any more. */
#pragma once

#include "core/base/base.h"
#include "core/base/team.h"

/* No unit is left. */
#define CONIC_NO_UNIT UINT64_MAX

/* Takes in the first process what one of all handed over; one call at a time, on any thread. */
typedef void conic_unit_taker(void *cookie, int from, const void *bytes, size_t n_bytes);

typedef struct conic_executor {
  void *data; /* of whoever made it; every function gets it */
  int index, count;
  int cut_for;            /* units are cut for so many processes: `count`, or as many as a trace is to tell of */
  int threads;            /* of this process, as others share its machine; 0: all of the machine's */
  const conic_team *team; /* the same processes, for what the library makes by several; null: this one is alone */

  /* Collective: from now on `next` gives the units from 0 to before `n`, and what is handed over goes to `take` until
   * the next `agree` has returned; null: nothing is handed over. */
  void (*share)(void *data, uint64_t n, conic_unit_taker *take, void *cookie);
  /* Takes the next unit, which nobody else gets; CONIC_NO_UNIT when there is none. */
  uint64_t (*next)(void *data);
  /* In the first process, which may wait with it: no unit from `end` on is given yet. */
  void (*allow)(void *data, uint64_t end);
  /* Hands bytes to the first process. They may change when it returns. */
  void (*hand)(void *data, const void *bytes, size_t n_bytes);
  /* Collective: OK where it is so of all processes; else a failure, of this one or another. Whoever says so, what was
   * handed over before has been taken, and after a failure no unit is given any more. */
  conic_status (*agree)(void *data, conic_status status);
  /* The same of any codes above 0: the greatest of all, and the message of the first process that has it, for all. */
  int (*worst)(void *data, int code, char *message, size_t room);
  /* Collective: the bytes of the first process come to all. */
  void (*broadcast)(void *data, void *bytes, size_t n_bytes);

  /* What this process has sent and received so far, and how long it has waited for others. */
  void (*count_traffic)(void *data, uint64_t *sent_bytes, uint64_t *received_bytes, double *waited_seconds);
  /* This process did a unit since a moment, and handed over so many bytes. The name stays: "window", "samples". */
  void (*did)(void *data, const char *name, uint64_t number, conic_moment since, uint64_t handed_bytes);
  /* The same of what is no unit: `kind` is "open" (before the units), "join" (what the first makes of a result). */
  void (*trace)(void *data, const char *kind, const char *name, uint64_t number, conic_moment since, uint64_t bytes);
} conic_executor;

/* One process: it gets every unit in its order, and takes what it hands over itself. */
typedef struct conic_alone {
  conic_executor executor;
  uint64_t next, end;
  conic_unit_taker *take;
  void *cookie;
} conic_alone;

/* Makes it; `alone` is to stay where it is. What its `did` and `trace` are to do may be set afterwards. */
void conic_executor_alone(conic_alone *alone);

/* Which kind of unit several processes share. */
typedef enum conic_shared_units {
  CONIC_UNITS_NONE = 0, /* one process does all */
  CONIC_UNITS_FRAMES = 1,
  CONIC_UNITS_SAMPLES = 2,
  CONIC_UNITS_WINDOWS = 3 /* pieces of one picture */
} conic_shared_units;
