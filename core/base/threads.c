#include "core/base/threads.h"

#include "core/base/base.h"
#include "core/base/context_struct.h"

enum { LINE_BYTES = 64 };

/* Each worker sleeps on a condition of its own: many that wake by one would queue for its mutex. */
typedef struct pool_worker {
  _Alignas(LINE_BYTES) conic_pool *pool;
  int i_thread;
  pthread_t thread;
  pthread_mutex_t mutex;
  pthread_cond_t work_ready;
  uint64_t wanted; /* the generation that it was called for */
  int stop;
} pool_worker;

struct conic_pool {
  pthread_mutex_t mutex;
  pthread_cond_t work_done;
  int n_workers, n_called;   /* n_called: workers needed for the items */
  int n_used;                /* conic_parallel_limit: threads that may work, with the calling one */
  conic_region_watch *watch; /* null: not told */
  void *watch_cookie;

  conic_task task;
  void *data;
  size_t n_items;
  _Alignas(LINE_BYTES) atomic_size_t next_item;
  /* Generation, DOOR_CLOSED, and how many workers are inside. Workers that come when it is closed stay out, so nobody
   * waits for late ones. */
  _Alignas(LINE_BYTES) _Atomic(uint64_t) door;

  pool_worker workers[];
};

static const uint64_t DOOR_CLOSED = 1 << 15, DOOR_INSIDE = DOOR_CLOSED - 1;
enum { GENERATION_SHIFT = 16 };

static void do_items(conic_pool *pool, int i_thread) {
  for (;;) {
    size_t i_item = atomic_fetch_add_explicit(&pool->next_item, 1, memory_order_relaxed);
    if (i_item >= pool->n_items)
      return;
    conic_task_do(pool->task, pool->data, i_item, i_thread);
  }
}

static int enter_region(conic_pool *pool, uint64_t generation) {
  uint64_t door = atomic_load(&pool->door);
  while (door >> GENERATION_SHIFT == generation && !(door & DOOR_CLOSED))
    if (atomic_compare_exchange_weak(&pool->door, &door, door + 1))
      return 1;
  return 0;
}

static void leave_region(conic_pool *pool) {
  uint64_t before = atomic_fetch_sub(&pool->door, 1);
  if (!(before & DOOR_CLOSED) || (before & DOOR_INSIDE) != 1)
    return;
  pthread_mutex_lock(&pool->mutex);
  pthread_cond_signal(&pool->work_done);
  pthread_mutex_unlock(&pool->mutex);
}

/* Each thread wakes two more, so that the last one starts after log2(threads) steps. */
static void call_two(conic_pool *pool, int i_thread, uint64_t generation) {
  for (int i = 2 * i_thread; i < 2 * i_thread + 2 && i < pool->n_called; i++) {
    pool_worker *worker = &pool->workers[i];
    pthread_mutex_lock(&worker->mutex);
    worker->wanted = generation;
    pthread_cond_signal(&worker->work_ready);
    pthread_mutex_unlock(&worker->mutex);
  }
}

/* The next generation that the worker is called for; 0: it is to end. */
static uint64_t wait_for_call(pool_worker *self, uint64_t seen) {
  pthread_mutex_lock(&self->mutex);
  while (!self->stop && self->wanted == seen)
    pthread_cond_wait(&self->work_ready, &self->mutex);
  uint64_t generation = self->stop ? 0 : self->wanted;
  pthread_mutex_unlock(&self->mutex);
  return generation;
}

static void *run_worker(void *argument) {
  pool_worker *self = argument;
  uint64_t generation = 0;
  while ((generation = wait_for_call(self, generation))) {
    if (!enter_region(self->pool, generation))
      continue;
    call_two(self->pool, self->i_thread, generation);
    do_items(self->pool, self->i_thread);
    leave_region(self->pool);
  }
  return NULL;
}

static int start_worker(conic_pool *pool) {
  pool_worker *next = &pool->workers[pool->n_workers];
  next->pool = pool;
  next->i_thread = pool->n_workers + 1;
  pthread_mutex_init(&next->mutex, NULL);
  pthread_cond_init(&next->work_ready, NULL);
  if (pthread_create(&next->thread, NULL, run_worker, next) == 0) {
    pool->n_workers++;
    return 1;
  }
  pthread_cond_destroy(&next->work_ready);
  pthread_mutex_destroy(&next->mutex);
  return 0;
}

conic_status conic_pool_create(conic_context *context, conic_pool **pool) {
  int n_wanted = context->options.threads - 1;
  *pool = NULL;
  conic_pool *made = conic_memory_allocate_zeroed(context, 1, sizeof *made + (size_t)n_wanted * sizeof(pool_worker));
  if (!made)
    return CONIC_ERROR_MEMORY;
  pthread_mutex_init(&made->mutex, NULL);
  pthread_cond_init(&made->work_done, NULL);
  while (made->n_workers < n_wanted && start_worker(made))
    ;
  context->options.threads = made->n_used = made->n_workers + 1; /* those that the system gave */
  *pool = made;
  return CONIC_OK;
}

static void end_worker(pool_worker *worker) {
  pthread_mutex_lock(&worker->mutex);
  worker->stop = 1;
  pthread_cond_signal(&worker->work_ready);
  pthread_mutex_unlock(&worker->mutex);
}

void conic_pool_destroy(conic_context *context, conic_pool *pool) {
  if (!pool)
    return;
  for (int i = 0; i < pool->n_workers; i++)
    end_worker(&pool->workers[i]);
  for (int i = 0; i < pool->n_workers; i++) {
    pthread_join(pool->workers[i].thread, NULL);
    pthread_cond_destroy(&pool->workers[i].work_ready);
    pthread_mutex_destroy(&pool->workers[i].mutex);
  }
  pthread_cond_destroy(&pool->work_done);
  pthread_mutex_destroy(&pool->mutex);
  conic_memory_release(context, pool);
}

static void tell_watch(const conic_pool *pool, const char *name, size_t n_items, size_t n_done) {
  if (pool->watch && n_items)
    pool->watch(pool->watch_cookie, name, n_items, n_done);
}

static void do_items_alone(const conic_pool *pool, const char *name, size_t n_items, conic_task task, void *data) {
  tell_watch(pool, name, n_items, 0);
  for (size_t i_item = 0; i_item < n_items; i_item++) {
    conic_task_do(task, data, i_item, 0);
    tell_watch(pool, name, n_items, i_item + 1);
  }
}

void conic_parallel_plan(conic_context *context, int threads, conic_region_watch *watch, void *cookie) {
  context->options.threads = threads;
  context->pool->watch = watch;
  context->pool->watch_cookie = cookie;
}

void conic_parallel_limit(conic_context *context, int threads) {
  const int n_all = context->pool->n_workers + 1;
  context->pool->n_used = threads < 1 || threads > n_all ? n_all : threads;
}

int conic_parallel_threads(const conic_context *context) {
  return context->pool->watch ? context->options.threads : context->pool->n_used;
}

void conic_parallel_do(conic_context *context, const char *name, size_t n_items, conic_task task, void *data) {
  conic_pool *pool = context->pool;
  if (n_items <= 1 || pool->n_used <= 1) {
    do_items_alone(pool, name, n_items, task, data);
    return;
  }
  uint64_t generation = (atomic_load(&pool->door) >> GENERATION_SHIFT) + 1;
  pool->task = task;
  pool->data = data;
  pool->n_items = n_items;
  pool->n_called = n_items < (size_t)pool->n_used ? (int)(n_items - 1) : pool->n_used - 1;
  atomic_store_explicit(&pool->next_item, 0, memory_order_relaxed);
  atomic_store(&pool->door, generation << GENERATION_SHIFT);
  call_two(pool, 0, generation);
  do_items(pool, 0);
  if (!(atomic_fetch_or(&pool->door, DOOR_CLOSED) & DOOR_INSIDE))
    return;
  pthread_mutex_lock(&pool->mutex);
  while (atomic_load(&pool->door) & DOOR_INSIDE)
    pthread_cond_wait(&pool->work_done, &pool->mutex);
  pthread_mutex_unlock(&pool->mutex);
}

typedef struct run {
  conic_task task;
  void *data;
  size_t first;
} run;

static void do_item_of_run(void *data, size_t i_item, int i_thread) {
  const run *now = data;
  conic_task_do(now->task, now->data, now->first + i_item, i_thread);
}

conic_status conic_parallel_do_runs(conic_context *context, const char *name, double from, double to, size_t n_items,
                                    size_t n_a_run, conic_task task, void *data) {
  run now = {task, data, 0};
  for (; now.first < n_items; now.first += n_a_run) {
    size_t n_left = n_items - now.first;
    conic_status status = conic_progress(context, name, from + (to - from) * ((double)now.first / (double)n_items));
    if (status != CONIC_OK)
      return status;
    conic_parallel_region(context, name, n_left < n_a_run ? n_left : n_a_run, do_item_of_run, &now);
  }
  return CONIC_OK;
}

typedef struct telling {
  conic_context *context;
  const char *name;
  double from, to;
  size_t n_items;
  conic_task task;
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
  conic_task_do(t->task, t->data, i_item, i_thread);
  atomic_fetch_add(&t->n_done, 1);
}

conic_status conic_parallel_do_told(conic_context *context, const char *name, double from, double to, size_t n_items,
                                    conic_task task, void *data) {
  telling t = {.context = context,
               .name = name,
               .from = from,
               .to = to,
               .n_items = n_items,
               .task = task,
               .data = data,
               .status = CONIC_OK};
  conic_parallel_region(context, name, n_items, do_told_item, &t);
  return t.status;
}
