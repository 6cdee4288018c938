#include "core/base/threads.h"

#include <pthread.h>
#include <stdatomic.h>

#include "core/base/context_struct.h"
#include "core/base/memory.h"
#include "core/base/message.h"

typedef struct pool_worker {
  conic_pool *pool;
  int i_thread;
  pthread_t thread;
} pool_worker;

struct conic_pool {
  pthread_mutex_t mutex;
  pthread_cond_t work_ready, work_done;
  unsigned long generation; /* grows by one with each parallel_for */
  int stop;
  int n_busy; /* workers that have not finished the current generation */
  int n_workers;

  conic_task *task;
  void *data;
  size_t n_items;
  atomic_size_t next_item;

  pool_worker workers[];
};

static void do_items(conic_pool *pool, int i_thread) {
  for (;;) {
    size_t i_item = atomic_fetch_add_explicit(&pool->next_item, 1, memory_order_relaxed);
    if (i_item >= pool->n_items)
      return;
    pool->task(pool->data, i_item, i_thread);
  }
}

static void *run_worker(void *argument) {
  pool_worker *self = argument;
  conic_pool *pool = self->pool;
  unsigned long seen = 0;
  pthread_mutex_lock(&pool->mutex);
  for (;;) {
    while (!pool->stop && pool->generation == seen)
      pthread_cond_wait(&pool->work_ready, &pool->mutex);
    if (pool->stop)
      break;
    seen = pool->generation;
    pthread_mutex_unlock(&pool->mutex);
    do_items(pool, self->i_thread);
    pthread_mutex_lock(&pool->mutex);
    if (--pool->n_busy == 0)
      pthread_cond_signal(&pool->work_done);
  }
  pthread_mutex_unlock(&pool->mutex);
  return NULL;
}

conic_status conic_pool_create(conic_context *context, conic_pool **pool) {
  int n_wanted = context->options.threads - 1;
  *pool = NULL;
  conic_pool *made = conic_memory_allocate_zeroed(context, 1, sizeof *made + (size_t)n_wanted * sizeof(pool_worker));
  if (!made)
    return CONIC_ERROR_MEMORY;
  pthread_mutex_init(&made->mutex, NULL);
  pthread_cond_init(&made->work_ready, NULL);
  pthread_cond_init(&made->work_done, NULL);
  while (made->n_workers < n_wanted) {
    pool_worker *next = &made->workers[made->n_workers];
    next->pool = made;
    next->i_thread = made->n_workers + 1;
    if (pthread_create(&next->thread, NULL, run_worker, next) != 0)
      break;
    made->n_workers++;
  }
  context->options.threads = made->n_workers + 1; /* those that there are */
  *pool = made;
  return CONIC_OK;
}

void conic_pool_destroy(conic_context *context, conic_pool *pool) {
  if (!pool)
    return;
  pthread_mutex_lock(&pool->mutex);
  pool->stop = 1;
  pthread_cond_broadcast(&pool->work_ready);
  pthread_mutex_unlock(&pool->mutex);
  for (int i = 0; i < pool->n_workers; i++)
    pthread_join(pool->workers[i].thread, NULL);
  pthread_cond_destroy(&pool->work_done);
  pthread_cond_destroy(&pool->work_ready);
  pthread_mutex_destroy(&pool->mutex);
  conic_memory_release(context, pool);
}

void conic_parallel_for(conic_context *context, size_t n_items, conic_task *task, void *data) {
  conic_pool *pool = context->pool;
  if (n_items <= 1 || pool->n_workers == 0) {
    for (size_t i_item = 0; i_item < n_items; i_item++)
      task(data, i_item, 0);
    return;
  }
  pthread_mutex_lock(&pool->mutex);
  pool->task = task;
  pool->data = data;
  pool->n_items = n_items;
  atomic_store_explicit(&pool->next_item, 0, memory_order_relaxed);
  pool->n_busy = pool->n_workers;
  pool->generation++;
  pthread_cond_broadcast(&pool->work_ready);
  pthread_mutex_unlock(&pool->mutex);
  do_items(pool, 0);
  pthread_mutex_lock(&pool->mutex);
  while (pool->n_busy)
    pthread_cond_wait(&pool->work_done, &pool->mutex);
  pthread_mutex_unlock(&pool->mutex);
}

typedef struct run {
  conic_task *task;
  void *data;
  size_t first;
} run;

static void do_item_of_run(void *data, size_t i_item, int i_thread) {
  const run *now = data;
  now->task(now->data, now->first + i_item, i_thread);
}

conic_status conic_parallel_runs(conic_context *context, const char *name, double from, double to, size_t n_items,
                                 size_t n_a_run, conic_task *task, void *data) {
  run now = {task, data, 0};
  for (; now.first < n_items; now.first += n_a_run) {
    size_t n_left = n_items - now.first;
    conic_status status = conic_progress(context, name, from + (to - from) * ((double)now.first / (double)n_items));
    if (status != CONIC_OK)
      return status;
    conic_parallel_for(context, n_left < n_a_run ? n_left : n_a_run, do_item_of_run, &now);
  }
  return CONIC_OK;
}

typedef struct telling {
  conic_context *context;
  const char *name;
  double from, to;
  size_t n_items;
  conic_task *task;
  void *data;
  atomic_size_t n_done;
  atomic_int is_stopped;
  conic_status status; /* the calling thread's */
} telling;

static void do_told_item(void *data, size_t i_item, int i_thread) {
  telling *t = data;
  if (atomic_load(&t->is_stopped))
    return;
  if (i_thread == 0) {
    double share = (double)atomic_load(&t->n_done) / (double)t->n_items;
    t->status = conic_progress(t->context, t->name, t->from + (t->to - t->from) * share);
    if (t->status != CONIC_OK) {
      atomic_store(&t->is_stopped, 1);
      return;
    }
  }
  t->task(t->data, i_item, i_thread);
  atomic_fetch_add(&t->n_done, 1);
}

conic_status conic_parallel_told(conic_context *context, const char *name, double from, double to, size_t n_items,
                                 conic_task *task, void *data) {
  telling t = {.context = context,
               .name = name,
               .from = from,
               .to = to,
               .n_items = n_items,
               .task = task,
               .data = data,
               .status = CONIC_OK};
  conic_parallel_for(context, n_items, do_told_item, &t);
  return t.status;
}
