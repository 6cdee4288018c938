/* The context's thread pool. */
#pragma once

#include "conic/context.h"

/* What does item `i_item`. One that keeps something for each thread is told which it is on: `i_thread` is below
 * conic_context_threads and no two items at a time share one. */
typedef void conic_item_task(void *data, size_t i_item);
typedef void conic_thread_task(void *data, size_t i_item, int i_thread);

/* One of the two, and CONIC_TASK, which makes it of either's name. */
typedef struct conic_task {
  conic_item_task *of_item;
  conic_thread_task *of_thread;
} conic_task;

static inline conic_task conic_task_of_item(conic_item_task *task) {
  return (conic_task){.of_item = task};
}

static inline conic_task conic_task_of_thread(conic_thread_task *task) {
  return (conic_task){.of_thread = task};
}

static inline conic_task conic_task_itself(conic_task task) {
  return task;
}

#define CONIC_TASK(task)                                                                                               \
  _Generic((task), conic_item_task *                                                                                   \
           : conic_task_of_item, conic_thread_task *                                                                   \
           : conic_task_of_thread, conic_task                                                                          \
           : conic_task_itself)(task)

static inline void conic_task_do(conic_task task, void *data, size_t i_item, int i_thread) {
  if (task.of_item)
    task.of_item(data, i_item);
  else
    task.of_thread(data, i_item, i_thread);
}

/* Calls `task` once for each of n_items, in any order, on all threads, and returns when all are done. Items should
 * be coarse (a tile, a chunk of splats). What they compute must not depend on which thread runs them. Cannot fail; must
 * not be called from inside a task. */
#define conic_parallel_for(context, n_items, task, data) conic_parallel_region(context, #task, n_items, task, data)
#define conic_parallel_region(context, name, n_items, task, data)                                                      \
  conic_parallel_do(context, name, n_items, CONIC_TASK(task), data)
void conic_parallel_do(conic_context *context, const char *name, size_t n_items, conic_task task, void *data);

/* conic_parallel_for for work that a user may want to stop: in runs of `n_a_run` items. The progress of `name` is
 * reported before each run, between the two fractions. Errors: CANCELLED. */
#define conic_parallel_runs(context, name, from, to, n_items, n_a_run, task, data)                                     \
  conic_parallel_do_runs(context, name, from, to, n_items, n_a_run, CONIC_TASK(task), data)
conic_status conic_parallel_do_runs(conic_context *context, const char *name, double from, double to, size_t n_items,
                                    size_t n_a_run, conic_task task, void *data);

/* conic_parallel_for for items that take long each: before each of its items, the calling thread reports the progress
 * of `name`, between the two fractions. If that cancels, no thread begins another item. Errors: CANCELLED. */
#define conic_parallel_told(context, name, from, to, n_items, task, data)                                              \
  conic_parallel_do_told(context, name, from, to, n_items, CONIC_TASK(task), data)
conic_status conic_parallel_do_told(conic_context *context, const char *name, double from, double to, size_t n_items,
                                    conic_task task, void *data);

/* From now on no more threads than so many work at a time, the calling one among them; below 1: all. Those beside them
 * sleep, and conic_context_threads, by which memory is laid out, stays what it is. Not within a region. */
void conic_parallel_limit(conic_context *context, int threads);
/* How many work. */
int conic_parallel_threads(const conic_context *context);

/* Is told of a region of n_items > 0 items: before its first item (n_done 0) and after each. */
typedef void conic_region_watch(void *cookie, const char *name, size_t n_items, size_t n_done);

/* From now on all work is shared out as for so many threads, but the calling thread does it, in order. The context has
 * no other thread. */
void conic_parallel_plan(conic_context *context, int threads, conic_region_watch *watch, void *cookie);
