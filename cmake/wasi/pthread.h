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

#define CONIC_SUCCEEDS(function, ...)                                                                                  \
  static inline int function(__VA_ARGS__) {                                                                            \
    return 0;                                                                                                          \
  }
#define CONIC_UNUSED __attribute__((unused))
CONIC_SUCCEEDS(pthread_mutex_init, CONIC_UNUSED pthread_mutex_t *mutex, CONIC_UNUSED const void *attributes)
CONIC_SUCCEEDS(pthread_mutex_lock, CONIC_UNUSED pthread_mutex_t *mutex)
CONIC_SUCCEEDS(pthread_mutex_unlock, CONIC_UNUSED pthread_mutex_t *mutex)
CONIC_SUCCEEDS(pthread_mutex_destroy, CONIC_UNUSED pthread_mutex_t *mutex)
CONIC_SUCCEEDS(pthread_cond_init, CONIC_UNUSED pthread_cond_t *condition, CONIC_UNUSED const void *attributes)
CONIC_SUCCEEDS(pthread_cond_wait, CONIC_UNUSED pthread_cond_t *condition, CONIC_UNUSED pthread_mutex_t *mutex)
CONIC_SUCCEEDS(pthread_cond_signal, CONIC_UNUSED pthread_cond_t *condition)
CONIC_SUCCEEDS(pthread_cond_broadcast, CONIC_UNUSED pthread_cond_t *condition)
CONIC_SUCCEEDS(pthread_cond_destroy, CONIC_UNUSED pthread_cond_t *condition)
