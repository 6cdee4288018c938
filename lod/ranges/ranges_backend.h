/* A backend of lod/ranges/ranges.h. Its struct begins with a conic_ranges. */
#pragma once

#include <stdatomic.h>

#include "lod/ranges/ranges.h"

/* --- ranges that wait --- */

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

/* Takes the first whose time has come, and returns 1; or 0 where there is none. */
int conic_range_queue_pop(conic_range_queue *queue, double now_s, conic_queued_range *item);

void conic_range_queue_release(conic_context *context, conic_range_queue *queue);

typedef struct conic_ranges_backend {
  int (*next)(conic_ranges *ranges, double wait_seconds, conic_range_answer *answer);
  void (*release)(conic_ranges *ranges, conic_range_answer *answer);
  void (*cancel)(conic_ranges *ranges); /* what is under way; the queue is empty already; null: nothing ever is */
  int (*go_on)(conic_ranges *ranges);   /* starts what conic_ranges_go_on does: 1, or 0; null: nothing */
  void (*halt)(conic_ranges *ranges);   /* and ends it */
  void (*close)(conic_ranges *ranges);  /* releases all but the queue, the struct itself included */
} conic_ranges_backend;

struct conic_ranges {
  conic_context *context;
  const conic_ranges_backend *backend;
  uint64_t size;
  atomic_uint_fast64_t n_received; /* which a thread of the backend may add to */
  size_t n_pending;                /* asked for, not answered */
  int is_going_on;
  conic_range_queue queue;
};

conic_status conic_ranges_open_file(conic_context *context, const char *path, conic_ranges **ranges);
conic_status conic_ranges_open_url(conic_context *context, const char *url, const conic_ranges_options *options,
                                   conic_ranges **ranges);
