/* A team whose processes are threads of a test. */
#pragma once

#include <pthread.h>

#include "core/base/team.h"
#include "tests/support/check.h"

enum { THREAD_TEAM_MOST = 8 };

typedef struct thread_team_message {
  struct thread_team_message *next;
  size_t n_bytes;
} thread_team_message;

typedef struct thread_team {
  int count;
  pthread_mutex_t lock;
  pthread_cond_t changed;
  thread_team_message *waiting[THREAD_TEAM_MOST][THREAD_TEAM_MOST]; /* from, to; the first sent is the first */
  void (*run)(const conic_team *team, void *cookie);
  void *cookie;
} thread_team;

/* What a thread has of it. */
typedef struct thread_team_seat {
  thread_team *all;
  conic_team team;
} thread_team_seat;

static inline void thread_team_send(void *data, int to, const void *bytes, size_t n_bytes) {
  thread_team_seat *seat = data;
  thread_team_message *message = malloc(sizeof *message + n_bytes);
  if (!message)
    exit(1);
  *message = (thread_team_message){NULL, n_bytes};
  if (n_bytes)
    memcpy(message + 1, bytes, n_bytes);
  pthread_mutex_lock(&seat->all->lock);
  thread_team_message **at = &seat->all->waiting[seat->team.index][to];
  while (*at)
    at = &(*at)->next;
  *at = message;
  pthread_cond_broadcast(&seat->all->changed);
  pthread_mutex_unlock(&seat->all->lock);
}

/* What is handed out lies behind the message's head. */
static inline void *thread_team_receive(void *data, int from, size_t *n_bytes) {
  thread_team_seat *seat = data;
  thread_team_message **at = &seat->all->waiting[from][seat->team.index];
  pthread_mutex_lock(&seat->all->lock);
  while (!*at)
    pthread_cond_wait(&seat->all->changed, &seat->all->lock);
  thread_team_message *message = *at;
  *at = message->next;
  pthread_mutex_unlock(&seat->all->lock);
  *n_bytes = message->n_bytes;
  return message + 1;
}

static inline void thread_team_release(void *data, void *bytes) {
  (void)data;
  free((thread_team_message *)bytes - 1);
}

static inline void *thread_team_collect(void *data, const void *bytes, size_t n_bytes, size_t *sizes) {
  thread_team_seat *seat = data;
  size_t n = 0;
  thread_team_message *all = malloc(sizeof *all);
  for (int to = 0; to < seat->all->count; to++)
    thread_team_send(data, to, bytes, n_bytes);
  for (int from = 0; from < seat->all->count; from++) {
    void *part = thread_team_receive(data, from, &sizes[from]);
    all = realloc(all, sizeof *all + n + sizes[from]);
    if (!all)
      exit(1);
    memcpy((char *)(all + 1) + n, part, sizes[from]);
    n += sizes[from];
    thread_team_release(data, part);
  }
  return all + 1;
}

static inline void *thread_team_sit(void *data) {
  thread_team_seat *seat = data;
  seat->all->run(&seat->team, seat->all->cookie);
  return NULL;
}

/* Runs it in so many threads, each with its number of the team, and waits for all. */
static inline void thread_team_run(int count, void (*run)(const conic_team *team, void *cookie), void *cookie) {
  thread_team all = {.count = count, .run = run, .cookie = cookie};
  thread_team_seat seats[THREAD_TEAM_MOST];
  pthread_t threads[THREAD_TEAM_MOST];
  pthread_mutex_init(&all.lock, NULL);
  pthread_cond_init(&all.changed, NULL);
  for (int i = 0; i < count; i++) {
    seats[i] = (thread_team_seat){
        &all, {i, count, &seats[i], thread_team_send, thread_team_receive, thread_team_release, thread_team_collect}};
    if (pthread_create(&threads[i], NULL, thread_team_sit, &seats[i]) != 0)
      exit(1);
  }
  for (int i = 0; i < count; i++)
    pthread_join(threads[i], NULL);
  pthread_cond_destroy(&all.changed);
  pthread_mutex_destroy(&all.lock);
}
