#include "mpi/hands.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

typedef struct parcel {
  struct parcel *next;
  size_t n_bytes;
  unsigned char bytes[];
} parcel;

static struct {
  pthread_mutex_t lock;
  pthread_cond_t changed;
  parcel *first, **end; /* the first is being sent */
  size_t n_bytes;
  int is_begun, is_ending;
  hands_send *send;
  pthread_t thread;
} hands = {.lock = PTHREAD_MUTEX_INITIALIZER, .changed = PTHREAD_COND_INITIALIZER, .end = &hands.first};

static void *send_all(void *unused) {
  (void)unused;
  pthread_mutex_lock(&hands.lock);
  while (hands.first || !hands.is_ending) {
    parcel *p = hands.first;
    if (!p) {
      pthread_cond_wait(&hands.changed, &hands.lock);
      continue;
    }
    pthread_mutex_unlock(&hands.lock);
    hands.send(p->bytes, p->n_bytes);
    pthread_mutex_lock(&hands.lock);
    hands.first = p->next;
    hands.end = hands.first ? hands.end : &hands.first;
    hands.n_bytes -= p->n_bytes;
    free(p);
    pthread_cond_broadcast(&hands.changed);
  }
  pthread_mutex_unlock(&hands.lock);
  return NULL;
}

int hands_put(const void *bytes, size_t n_bytes, hands_send *send) {
  parcel *p = malloc(sizeof *p + n_bytes);
  if (!p)
    return 0;
  *p = (parcel){.n_bytes = n_bytes};
  if (n_bytes)
    memcpy(p->bytes, bytes, n_bytes);
  if (!hands.is_begun) {
    hands.send = send;
    hands.is_begun = pthread_create(&hands.thread, NULL, send_all, NULL) == 0;
  }
  if (!hands.is_begun) {
    free(p);
    return 0;
  }
  pthread_mutex_lock(&hands.lock);
  while (hands.first && (n_bytes > HANDS_ROOM || hands.n_bytes > HANDS_ROOM - n_bytes))
    pthread_cond_wait(&hands.changed, &hands.lock);
  *hands.end = p;
  hands.end = &p->next;
  hands.n_bytes += n_bytes;
  pthread_cond_broadcast(&hands.changed);
  pthread_mutex_unlock(&hands.lock);
  return 1;
}

void hands_wait(void) {
  pthread_mutex_lock(&hands.lock);
  while (hands.first)
    pthread_cond_wait(&hands.changed, &hands.lock);
  pthread_mutex_unlock(&hands.lock);
}

void hands_end(void) {
  if (!hands.is_begun)
    return;
  pthread_mutex_lock(&hands.lock);
  hands.is_ending = 1;
  pthread_cond_broadcast(&hands.changed);
  pthread_mutex_unlock(&hands.lock);
  pthread_join(hands.thread, NULL);
}
