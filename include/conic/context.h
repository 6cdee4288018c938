/* The context: where memory comes from, where messages go, how many threads compute.
 *
 * Every call takes one. A context may be used by one thread at a time; two contexts are independent. The
 * library has no state outside them. */
#ifndef CONIC_CONTEXT_H
#define CONIC_CONTEXT_H

#include <stddef.h>

#include "conic/isa.h"
#include "conic/status.h"

CONIC_BEGIN_C

typedef struct conic_context conic_context;

typedef enum conic_log_level {
  CONIC_LOG_ERROR = 0,   /* why the call that is about to return fails: one line */
  CONIC_LOG_WARNING = 1, /* the call goes on, but its caller may want to know */
  CONIC_LOG_INFO = 2
} conic_log_level;

/* Fill with conic_context_options_init, then change what differs. Callbacks may be null. */
typedef struct conic_context_options {
  size_t size; /* sizeof(conic_context_options), set by the init function */

  /* Memory. `allocate` returns null on failure; both are called from any of the context's threads, so they must
   * be thread-safe. Default: malloc and free. */
  void *(*allocate)(void *cookie, size_t bytes);
  void (*release)(void *cookie, void *pointer);
  void *allocator_cookie;

  /* Messages, in UTF-8 and without a newline. `message` is valid during the call only. Called on the thread that has
   * the message: any of the context's, and several at a time. Default: dropped. */
  void (*log)(void *cookie, conic_log_level level, const char *message);
  void *log_cookie;

  /* Progress of long work: `task` names it ("read", "render" …), `fraction` grows from 0 to 1. Called on the
   * calling thread, a few times a second at most. A non-zero answer cancels: the call returns
   * CONIC_ERROR_CANCELLED and leaves nothing behind. */
  int (*progress)(void *cookie, const char *task, double fraction);
  void *progress_cookie;

  /* Threads that compute, the calling one included; 0: as many as the machine has. The results never depend on it. */
  int threads;

  /* Not 0: splats, records and pictures ask the system for pages of 2 MiB (Linux: madvise). Frames of large models are
   * some 5 % faster. The first use of memory is faster too, or slower where a virtual machine takes long to give large
   * pages. For programs that draw many frames. */
  int large_pages;

  /* No single allocation is larger than this; 0: no limit. */
  size_t max_allocation_bytes;

  /* The instruction set of all loops, except in calls whose own options name another. A set that is not here makes
   * these calls fail with UNSUPPORTED. */
  conic_isa isa;

  /* The textures of files together take no more memory than this. A call that would read one more fails with INPUT
   * before it is decoded. 0: no limit. */
  size_t max_texture_bytes;

  /* Not 0: a glTF may name buffers and pictures that do not lie in its folder or below it. */
  int allows_outside;
} conic_context_options;

/* malloc and free, no messages, no progress, all threads, no limit but 4 GiB of textures, the widest instructions. */
CONIC_API void conic_context_options_init_sized(conic_context_options *options, size_t size);
#define conic_context_options_init(options) conic_context_options_init_sized(options, sizeof *(options))

/* Creates a context; `options` may be null for the defaults. On success the caller owns *context and ends it with
 * conic_context_destroy; on failure *context is null. Errors: ARGUMENT, MEMORY. */
CONIC_API conic_status conic_context_create(const conic_context_options *options, conic_context **context);

/* Ends the context and its threads; null is allowed. Everything made with it must have been released before. */
CONIC_API void conic_context_destroy(conic_context *context);

/* The number of threads that compute, at least 1. */
CONIC_API int conic_context_threads(const conic_context *context);

CONIC_END_C
#endif
