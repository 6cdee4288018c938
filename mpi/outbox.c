#include "mpi/outbox.h"

#include <pthread.h>

#include "core/base/base.h"

typedef struct letter {
  struct letter *next;
  size_t n_bytes;
  unsigned char bytes[];
} letter;

static struct {
  pthread_mutex_t lock;
  pthread_cond_t changed;
  letter *first, **end; /* the first is being sent */
  size_t n_bytes;
  int is_begun, is_ending;
  outbox_send *send;
  pthread_t thread;
} outbox = {.lock = PTHREAD_MUTEX_INITIALIZER, .changed = PTHREAD_COND_INITIALIZER, .end = &outbox.first};

static void *send_all(void *unused) {
  (void)unused;
  pthread_mutex_lock(&outbox.lock);
  while (outbox.first || !outbox.is_ending) {
    letter *p = outbox.first;
    if (!p) {
      pthread_cond_wait(&outbox.changed, &outbox.lock);
      continue;
    }
    pthread_mutex_unlock(&outbox.lock);
    outbox.send(p->bytes, p->n_bytes);
    pthread_mutex_lock(&outbox.lock);
    outbox.first = p->next;
    outbox.end = outbox.first ? outbox.end : &outbox.first;
    outbox.n_bytes -= p->n_bytes;
    free(p);
    pthread_cond_broadcast(&outbox.changed);
  }
  pthread_mutex_unlock(&outbox.lock);
  return NULL;
}

int outbox_put(const void *bytes, size_t n_bytes, outbox_send *send) {
  letter *p = malloc(sizeof *p + n_bytes);
  if (!p)
    return 0;
  *p = (letter){.n_bytes = n_bytes};
  if (n_bytes)
    memcpy(p->bytes, bytes, n_bytes);
  if (!outbox.is_begun) {
    outbox.send = send;
    outbox.is_begun = pthread_create(&outbox.thread, NULL, send_all, NULL) == 0;
  }
  if (!outbox.is_begun) {
    free(p);
    return 0;
  }
  pthread_mutex_lock(&outbox.lock);
  while (outbox.first && (n_bytes > OUTBOX_ROOM || outbox.n_bytes > OUTBOX_ROOM - n_bytes))
    pthread_cond_wait(&outbox.changed, &outbox.lock);
  *outbox.end = p;
  outbox.end = &p->next;
  outbox.n_bytes += n_bytes;
  pthread_cond_broadcast(&outbox.changed);
  pthread_mutex_unlock(&outbox.lock);
  return 1;
}

void outbox_wait(void) {
  pthread_mutex_lock(&outbox.lock);
  while (outbox.first)
    pthread_cond_wait(&outbox.changed, &outbox.lock);
  pthread_mutex_unlock(&outbox.lock);
}

void outbox_end(void) {
  if (!outbox.is_begun)
    return;
  pthread_mutex_lock(&outbox.lock);
  outbox.is_ending = 1;
  pthread_cond_broadcast(&outbox.changed);
  pthread_mutex_unlock(&outbox.lock);
  pthread_join(outbox.thread, NULL);
}
