/* Memory through the context's allocator: counted sizes, no overflow, aligned for vectors. */
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "conic/context.h"

/* An array of a file that would have more bytes is wrong. */
#define CONIC_MOST_BYTES ((size_t)(SIZE_MAX / 2 < (uint64_t)1 << 40 ? SIZE_MAX / 2 : (uint64_t)1 << 40))

/* Room for `count` elements of `size` bytes, aligned to 64 bytes, contents undefined. Null where memory or the limit is
 * exceeded, which is logged then. Zero elements give a valid pointer. Thread-safe. */
void *conic_memory_allocate(conic_context *context, size_t count, size_t size);

/* conic_memory_allocate with all bytes zero. */
void *conic_memory_allocate_zeroed(conic_context *context, size_t count, size_t size);

/* A copy of that many bytes, or of text; null where there is no room. */
void *conic_memory_copy(conic_context *context, const void *from, size_t n_bytes);
char *conic_memory_copy_text(conic_context *context, const char *text);

/* Room for an array, by the address of its pointer. */
typedef struct conic_memory_room {
  void *array;
  size_t count, size;
  int is_zeroed;
} conic_memory_room;

#define CONIC_ROOM(array, count)                                                                                       \
  { &(array), (count), sizeof *(array), 0 }
#define CONIC_ZEROED(array, count)                                                                                     \
  { &(array), (count), sizeof *(array), 1 }

/* Allocates several arrays: conic_memory_allocate_these(context, CONIC_ROOM(a, n), CONIC_ZEROED(b, m)). All pointers
 * are set, to null where there was no room; the caller releases them whatever comes back. Errors: MEMORY. */
#define conic_memory_allocate_these(context, ...)                                                                      \
  conic_memory_allocate_all(context, (const conic_memory_room[]){__VA_ARGS__},                                         \
                            sizeof((const conic_memory_room[]){__VA_ARGS__}) / sizeof(conic_memory_room))
conic_status conic_memory_allocate_all(conic_context *context, const conic_memory_room *rooms, size_t n);

/* Moves `used` elements of an array into room for `count` (not below `used`) and releases the old; `array` is the
 * address of the pointer to it. On failure the array stays as it was. */
conic_status conic_memory_grow(conic_context *context, void *array, size_t used, size_t count, size_t size);

/* conic_memory_grow for an array with room for *room elements, if `wanted` are more: it gets half as much more than it
 * had, so that adding one by one takes little time. On failure the array and *room stay as they were. */
conic_status conic_memory_reserve(conic_context *context, void *array, size_t used, size_t wanted, size_t *room,
                                  size_t size);

/* Appends an element of `size` bytes to such an array of *n elements. On failure the array, *n and *room stay as they
 * were. The first function's element is zero; it is returned, or null. */
void *conic_memory_add(conic_context *context, void *array, size_t *n, size_t *room, size_t size);
conic_status conic_memory_append(conic_context *context, void *array, size_t *n, size_t *room, const void *element,
                                 size_t size);

/* Asks the system for large pages wherever one lies wholly within a block that will be used from end to end; the second
 * function only where the context has large_pages. Without support nothing happens. Thread-safe. */
void conic_memory_advise_large_pages(void *pointer, size_t bytes);
void conic_memory_prefer_large_pages(const conic_context *context, void *pointer, size_t bytes);

/* Rounded up to the alignment: the bytes of an array that another one follows in the same block. */
static inline size_t conic_memory_rounded(size_t bytes) {
  return (bytes + 63) / 64 * 64;
}

/* Releases what allocate gave; null is allowed. */
void conic_memory_release(conic_context *context, void *pointer);

/* The same of a block that is likely to be asked for again, as by the next picture: where the context has large_pages,
 * it is kept for that, so that the system need not clear its pages anew. */
void conic_memory_keep(conic_context *context, void *pointer);

/* Releases n blocks; null ones are allowed. */
void conic_memory_release_all(conic_context *context, void *const *pointers, size_t n);
/* Releases the blocks that are written out one after the other. */
#define conic_memory_release_these(context, ...)                                                                       \
  conic_memory_release_all(context, (void *[]){__VA_ARGS__}, sizeof((void *[]){__VA_ARGS__}) / sizeof(void *))
