/* Ranges that wait, the first by priority first. */
#ifndef CONIC_RANGE_QUEUE_H
#define CONIC_RANGE_QUEUE_H

#include "lod/ranges/ranges.h"

typedef struct conic_queued_range {
  conic_range range;
  int n_failures;      /* so far */
  double not_before_s; /* of the monotonic clock */
} conic_queued_range;

/* A heap. Zero before the first use. */
typedef struct conic_range_queue {
  conic_queued_range *items;
  size_t n, room;
} conic_range_queue;

/* Errors: MEMORY. */
conic_status conic_range_queue_push(conic_context *context, conic_range_queue *queue, const conic_queued_range *item);

/* Takes the first whose time has come, and returns 1. Returns 0 where there is none; *wait_s is then how long until
 * there is one, or below 0 where the queue is empty. */
int conic_range_queue_pop(conic_range_queue *queue, double now_s, conic_queued_range *item, double *wait_s);

/* The first, or null. */
const conic_queued_range *conic_range_queue_first(const conic_range_queue *queue);

void conic_range_queue_release(conic_context *context, conic_range_queue *queue);

#endif
