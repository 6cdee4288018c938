/* Loops whose items a team shares. Its processes do the same with their contexts, on the same data, so that each can do
 * some of a loop's items and get from the others what those made. */
#ifndef CONIC_TEAM_RUNS_H
#define CONIC_TEAM_RUNS_H

#include <stdint.h>

#include "core/base/team.h"
#include "core/base/threads.h"

/* From now on the context's work is shared with the team, which stays where it is; null: no longer. Returns whom it was
 * shared with before. */
const conic_team *conic_context_join(conic_context *context, const conic_team *team);

/* Collective, at the end of what is shared, whatever came of it: as conic_team_agree, of the context's team. From then
 * on nothing is shared. Between the two whoever fails may leave at any place: it comes here, and the others learn of it
 * at the next collective function. */
conic_status conic_context_part(conic_context *context, conic_status status);

/* Where items leave what they make. */
typedef struct conic_team_column {
  void *values; /* null: there is none */
  size_t value_bytes;
  const uint32_t *places; /* where value i stands; null: at i */
  int is_by_item;         /* each item makes one value, whatever it makes of the others */
} conic_team_column;

enum { CONIC_TEAM_COLUMNS = 16 };

typedef struct conic_team_loop {
  const char *name; /* of the progress, between two fractions, */
  double from, to;
  size_t n_items, n_a_run; /* which is reported before so many items; 0: before each, as conic_parallel_told does */
  conic_task *task;
  void *data;
  /* Each item makes so many values of every column, the last one those that are left of all, and changes nothing else
   * that is looked at later. Where items make different numbers, `first_of` gives an item's first, and of n_items their
   * number. */
  size_t n_an_item, n_values;
  size_t (*first_of)(const void *data, size_t i_item);
  conic_team_column columns[CONIC_TEAM_COLUMNS];
} conic_team_loop;

/* The loop over n_values that make up items of n_an_item each, without columns yet. */
static inline conic_team_loop conic_team_loop_of(const char *name, double from, double to, size_t n_values,
                                                 size_t n_an_item, size_t n_a_run, conic_task *task, void *data) {
  size_t n_items = (n_values + n_an_item - 1) / n_an_item;
  return (conic_team_loop){
      name, from, to, n_items, n_a_run, task, data, n_an_item, n_values, NULL, {{NULL, 0, NULL, 0}}};
}

/* conic_parallel_runs or conic_parallel_told, which is all of it where the context has no team. Else collective: each
 * process does some of the items, and all then have all values. Errors: CANCELLED, MEMORY. */
conic_status conic_team_runs(conic_context *context, const conic_team_loop *loop);

/* Collective: makes it the sum of what all have. Errors: CANCELLED. */
conic_status conic_team_total(conic_context *context, size_t *count);

#endif
