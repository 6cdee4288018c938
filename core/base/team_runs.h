/* Loops whose items a team shares. Its processes run the same work with their own contexts, on the same data. Each does
 * some of a loop's items and gets the values of the others' items from them. */
#pragma once

#include "core/base/team.h"
#include "core/base/threads.h"

/* From now on the team, which must stay, shares the context's work; null: no team does. Returns the team before. */
const conic_team *conic_context_join(conic_context *context, const conic_team *team);

/* Collective: ends the sharing, with success or failure, and agrees on a status as conic_team_agree of the context's
 * team. Between joining and this call, a process that fails may leave at any place and come here; the others learn of
 * it at the next collective function. */
conic_status conic_context_part(conic_context *context, conic_status status);

/* Where items leave their values. */
typedef struct conic_team_column {
  void *values; /* null: there is none */
  size_t value_bytes;
  const uint32_t *places; /* the places of the values; null: value i is at i */
  int is_by_item;         /* each item makes one value here, however many it makes in the other columns */
} conic_team_column;

enum { CONIC_TEAM_COLUMNS = 16 };

typedef struct conic_team_loop {
  const char *name; /* of the progress, which runs between two fractions … */
  double from, to;
  size_t n_items, n_a_run; /* … and is reported before every n_a_run items; 0: before each item, as in
                              conic_parallel_told */
  conic_task task;
  void *data;
  /* Each item makes n_an_item values of every column, the last item the remaining ones of n_values, and changes nothing
   * else that is used later. Where items make different numbers, first_of(data, i) is the first value of item i, and
   * first_of(data, n_items) the number of all. */
  size_t n_an_item, n_values;
  size_t (*first_of)(const void *data, size_t i_item);
  conic_team_column columns[CONIC_TEAM_COLUMNS];
} conic_team_loop;

/* A loop over n_values, n_an_item in each item, without columns yet. */
#define conic_team_loop_of(name, from, to, n_values, n_an_item, n_a_run, task, data)                                   \
  conic_team_loop_make(name, from, to, n_values, n_an_item, n_a_run, CONIC_TASK(task), data)
static inline conic_team_loop conic_team_loop_make(const char *name, double from, double to, size_t n_values,
                                                   size_t n_an_item, size_t n_a_run, conic_task task, void *data) {
  size_t n_items = (n_values + n_an_item - 1) / n_an_item;
  return (conic_team_loop){
      name, from, to, n_items, n_a_run, task, data, n_an_item, n_values, NULL, {{NULL, 0, NULL, 0}}};
}

/* conic_parallel_runs or conic_parallel_told, and nothing more where the context has no team. With a team it is
 * collective: each process does some of the items, and in the end all have all values. Errors: CANCELLED, MEMORY. */
conic_status conic_team_runs(conic_context *context, const conic_team_loop *loop);

/* Collective: replaces *count by the sum over all processes. Errors: CANCELLED. */
conic_status conic_team_total(conic_context *context, size_t *count);
