/* What wasi-libc lacks of <pthread.h>, for a process that has one thread: none starts, and locks are always free. */
#pragma once

#include <errno.h>

#define __NEED_pthread_t
#define __NEED_pthread_attr_t
#define __NEED_pthread_mutexattr_t
#define __NEED_pthread_condattr_t
#define __NEED_pthread_mutex_t
#define __NEED_pthread_cond_t
#define __NEED_pthread_once_t
#include <bits/alltypes.h>

#define PTHREAD_MUTEX_INITIALIZER                                                                                      \
  {                                                                                                                    \
    {                                                                                                                  \
      { 0 }                                                                                                            \
    }                                                                                                                  \
  }
#define PTHREAD_ONCE_INIT 0

static inline int pthread_once(pthread_once_t *done, void (*begin)(void)) {
  if (!*done)
    begin();
  *done = 1;
  return 0;
}

static inline int pthread_create(pthread_t *thread, const void *attributes, void *(*run)(void *), void *argument) {
  (void)thread, (void)attributes, (void)run, (void)argument;
  return EAGAIN;
}

static inline int pthread_join(pthread_t thread, void **result) {
  (void)thread, (void)result;
  return EINVAL;
}

static inline int pthread_mutex_init(pthread_mutex_t *mutex, const void *attributes) {
  (void)mutex, (void)attributes;
  return 0;
}

static inline int pthread_mutex_lock(pthread_mutex_t *mutex) {
  (void)mutex;
  return 0;
}

static inline int pthread_mutex_unlock(pthread_mutex_t *mutex) {
  (void)mutex;
  return 0;
}

static inline int pthread_mutex_destroy(pthread_mutex_t *mutex) {
  (void)mutex;
  return 0;
}

static inline int pthread_cond_init(pthread_cond_t *condition, const void *attributes) {
  (void)condition, (void)attributes;
  return 0;
}

static inline int pthread_cond_wait(pthread_cond_t *condition, pthread_mutex_t *mutex) {
  (void)condition, (void)mutex;
  return 0;
}

static inline int pthread_cond_signal(pthread_cond_t *condition) {
  (void)condition;
  return 0;
}

static inline int pthread_cond_destroy(pthread_cond_t *condition) {
  (void)condition;
  return 0;
}

static inline int pthread_cond_broadcast(pthread_cond_t *condition) {
  return pthread_cond_signal(condition);
}
