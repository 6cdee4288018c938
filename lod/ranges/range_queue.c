/* Ranges that wait, the first by priority first. */
#include "lod/ranges/ranges_backend.h"

/* By priority, then by place in the file, so that neighbours follow each other. */
static int is_sooner(const conic_queued_range *a, const conic_queued_range *b) {
  if (a->range.priority != b->range.priority)
    return a->range.priority < b->range.priority;
  return a->range.offset < b->range.offset;
}

static void swap(conic_queued_range *a, conic_queued_range *b) {
  conic_queued_range kept = *a;
  *a = *b;
  *b = kept;
}

static void rise(conic_range_queue *queue, size_t i) {
  while (i > 0 && is_sooner(&queue->items[i], &queue->items[(i - 1) / 2])) {
    swap(&queue->items[i], &queue->items[(i - 1) / 2]);
    i = (i - 1) / 2;
  }
}

static void sink(conic_range_queue *queue, size_t i) {
  for (;;) {
    size_t least = i;
    for (size_t child = 2 * i + 1; child <= 2 * i + 2; child++)
      if (child < queue->n && is_sooner(&queue->items[child], &queue->items[least]))
        least = child;
    if (least == i)
      return;
    swap(&queue->items[i], &queue->items[least]);
    i = least;
  }
}

conic_status conic_range_queue_push(conic_context *context, conic_range_queue *queue, const conic_queued_range *item) {
  conic_status status = conic_memory_append(context, &queue->items, &queue->n, &queue->room, item, sizeof *item);
  if (status == CONIC_OK)
    rise(queue, queue->n - 1);
  return status;
}

/* Few ranges wait for their time, and only after failures: then all are looked through. */
int conic_range_queue_pop(conic_range_queue *queue, double now_s, conic_queued_range *item) {
  if (queue->n == 0)
    return 0;
  size_t best = 0;
  if (queue->items[0].not_before_s > now_s) {
    best = queue->n;
    for (size_t i = 0; i < queue->n; i++)
      if (queue->items[i].not_before_s <= now_s &&
          (best == queue->n || is_sooner(&queue->items[i], &queue->items[best])))
        best = i;
    if (best == queue->n)
      return 0;
  }
  *item = queue->items[best];
  queue->items[best] = queue->items[--queue->n];
  if (best < queue->n) {
    rise(queue, best);
    sink(queue, best);
  }
  return 1;
}

void conic_range_queue_release(conic_context *context, conic_range_queue *queue) {
  conic_memory_release(context, queue->items);
  memset(queue, 0, sizeof *queue);
}
