/* A priority queue of slots: the least key first, of equal keys the lowest slot. */
#pragma once

#include <stddef.h>
#include <stdint.h>

typedef struct conic_heap {
  size_t n;
  uint32_t *slots; /* room for all; the caller's */
  double *keys;    /* by slot; the caller's */
} conic_heap;

static inline int conic_heap_is_before(const conic_heap *heap, uint32_t a, uint32_t b) {
  return heap->keys[a] < heap->keys[b] || (heap->keys[a] == heap->keys[b] && a < b);
}

/* The slot's key is set before, and stays while it is in the queue. */
static inline void conic_heap_push(conic_heap *heap, uint32_t slot) {
  size_t i = heap->n++;
  for (; i > 0 && conic_heap_is_before(heap, slot, heap->slots[(i - 1) / 2]); i = (i - 1) / 2)
    heap->slots[i] = heap->slots[(i - 1) / 2];
  heap->slots[i] = slot;
}

/* Takes the first away; the queue must not be empty. */
static inline uint32_t conic_heap_pop(conic_heap *heap) {
  uint32_t first = heap->slots[0], moved = heap->slots[--heap->n];
  size_t i = 0;
  for (size_t child = 1; child < heap->n; child = 2 * i + 1) {
    if (child + 1 < heap->n && conic_heap_is_before(heap, heap->slots[child + 1], heap->slots[child]))
      child++;
    if (!conic_heap_is_before(heap, heap->slots[child], moved))
      break;
    heap->slots[i] = heap->slots[child];
    i = child;
  }
  heap->slots[i] = moved;
  return first;
}
