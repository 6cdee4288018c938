#include "core/base/context_struct.h"

#include <stdarg.h>

#include "core/base/base.h"
#include "core/base/loan_find.h"
#include "core/base/machine.h"

enum { N_KEPT = sizeof((conic_context *)0)->kept / sizeof *((conic_context *)0)->kept };

static void *default_allocate(void *cookie, size_t bytes) {
  (void)cookie;
  return malloc(bytes);
}

static void default_release(void *cookie, void *pointer) {
  (void)cookie;
  free(pointer);
}

CONIC_DEFINE_OPTIONS(conic_context_options, .max_texture_bytes = (size_t)4 << 30)

conic_status conic_context_create(const conic_context_options *options, conic_context **context) {
  conic_context_options settings;
  if (!context)
    return CONIC_ERROR_ARGUMENT;
  *context = NULL;
  conic_context_options_init(&settings);
  if (options) {
    if (!conic_options_take(&settings, options) || settings.threads < 0 || settings.threads > CONIC_MAX_THREADS ||
        !settings.allocate != !settings.release)
      return CONIC_ERROR_ARGUMENT;
  }
  if (!settings.allocate) {
    settings.allocate = default_allocate;
    settings.release = default_release;
  }
  if (!settings.threads) {
    int n = conic_machine_threads();
    settings.threads = n < CONIC_MAX_THREADS ? n : CONIC_MAX_THREADS;
  }
  conic_context *made = settings.allocate(settings.allocator_cookie, sizeof *made);
  if (!made)
    return CONIC_ERROR_MEMORY;
  memset(made, 0, sizeof *made);
  made->options = settings;
  pthread_mutex_init(&made->outputs_lock, NULL);
  conic_status status = conic_pool_create(made, &made->pool);
  if (status != CONIC_OK) {
    pthread_mutex_destroy(&made->outputs_lock);
    settings.release(settings.allocator_cookie, made);
    return status;
  }
  *context = made;
  return CONIC_OK;
}

void conic_context_destroy(conic_context *context) {
  if (!context)
    return;
  conic_pool_destroy(context, context->pool);
  conic_take_back_loans(context);
  for (size_t i = 0; i < context->n_inputs; i++)
    conic_memory_release(context, context->inputs[i].path);
  conic_memory_release(context, context->inputs);
  for (conic_lasting *block = context->lasting, *next; block; block = next) {
    next = block->next;
    conic_memory_release(context, block);
  }
  for (int i = 0; i < N_KEPT; i++)
    conic_memory_release(context, context->kept[i]);
  pthread_mutex_destroy(&context->outputs_lock);
  context->options.release(context->options.allocator_cookie, context);
}

int conic_context_threads(const conic_context *context) {
  return context->options.threads;
}

/* Each block is preceded by its size and the pointer that the allocator gave, so that any allocator serves aligned
 * blocks. */
static const size_t alignment_bytes = 64;

/* Large blocks of zeros come from the system as such: whoever writes to them first touches them, on its thread. */
static void *take_zeros(const conic_context *context, size_t bytes) {
  if (context->options.allocate == default_allocate)
    return calloc(1, bytes);
  void *raw = context->options.allocate(context->options.allocator_cookie, bytes);
  return raw ? memset(raw, 0, bytes) : NULL;
}

static size_t size_of_block(const void *block) {
  size_t bytes;
  memcpy(&bytes, (const char *)block - sizeof(void *) - sizeof bytes, sizeof bytes);
  return bytes;
}

void conic_memory_keep(conic_context *context, void *pointer) {
  for (int i = 0; pointer && context->options.large_pages && i < N_KEPT; i++) {
    void *none = NULL;
    if (atomic_compare_exchange_strong(&context->kept[i], &none, pointer))
      return;
  }
  conic_memory_release(context, pointer);
}

/* A kept block that is not much larger; null: there is none. */
static void *take_kept(conic_context *context, size_t bytes) {
  for (int i = 0; context->options.large_pages && i < N_KEPT; i++) {
    void *block = atomic_exchange(&context->kept[i], NULL);
    if (block && size_of_block(block) >= bytes && size_of_block(block) / 2 <= bytes)
      return block;
    conic_memory_keep(context, block);
  }
  return NULL;
}

static void *take_block(conic_context *context, size_t count, size_t size, int is_zeroed) {
  size_t limit = context->options.max_allocation_bytes ? context->options.max_allocation_bytes : SIZE_MAX;
  if (limit > SIZE_MAX - 2 * alignment_bytes)
    limit = SIZE_MAX - 2 * alignment_bytes;
  if (size && count > limit / size) {
    conic_fail(context, CONIC_ERROR_MEMORY, "%zu × %zu bytes of memory are over the limit", count, size);
    return NULL;
  }
  size_t bytes = count * size + 2 * alignment_bytes;
  void *kept = is_zeroed ? NULL : take_kept(context, count * size);
  if (kept)
    return kept;
  char *raw =
      is_zeroed ? take_zeros(context, bytes) : context->options.allocate(context->options.allocator_cookie, bytes);
  if (!raw) {
    conic_fail(context, CONIC_ERROR_MEMORY, "out of memory: %zu bytes asked for", count * size);
    return NULL;
  }
  size_t past = (uintptr_t)raw % alignment_bytes;
  char *aligned = raw + (2 * alignment_bytes - past);
  bytes -= 2 * alignment_bytes;
  memcpy(aligned - sizeof raw - sizeof bytes, &bytes, sizeof bytes);
  memcpy(aligned - sizeof raw, &raw, sizeof raw);
  return aligned;
}

void *conic_memory_allocate(conic_context *context, size_t count, size_t size) {
  return take_block(context, count, size, 0);
}

void *conic_memory_allocate_zeroed(conic_context *context, size_t count, size_t size) {
  return take_block(context, count, size, 1);
}

void *conic_memory_copy(conic_context *context, const void *from, size_t n_bytes) {
  void *copy = conic_memory_allocate(context, n_bytes, 1);
  if (copy && n_bytes > 0)
    memcpy(copy, from, n_bytes);
  return copy;
}

char *conic_memory_copy_text(conic_context *context, const char *text) {
  return conic_memory_copy(context, text, strlen(text) + 1);
}

conic_status conic_memory_grow(conic_context *context, void *array, size_t used, size_t count, size_t size) {
  void *smaller, *larger = conic_memory_allocate(context, count, size);
  if (!larger)
    return CONIC_ERROR_MEMORY;
  memcpy(&smaller, array, sizeof smaller);
  if (smaller && used)
    memcpy(larger, smaller, used * size);
  conic_memory_release(context, smaller);
  memcpy(array, &larger, sizeof larger);
  return CONIC_OK;
}

conic_status conic_memory_reserve(conic_context *context, void *array, size_t used, size_t wanted, size_t *room,
                                  size_t size) {
  if (wanted <= *room)
    return CONIC_OK;
  size_t larger = wanted + wanted / 2 + 64;
  conic_status status = conic_memory_grow(context, array, used, larger, size);
  if (status == CONIC_OK)
    *room = larger;
  return status;
}

void *conic_memory_add(conic_context *context, void *array, size_t *n, size_t *room, size_t size) {
  unsigned char *elements;
  if (conic_memory_reserve(context, array, *n, *n + 1, room, size) != CONIC_OK)
    return NULL;
  memcpy(&elements, array, sizeof elements);
  return memset(elements + (*n)++ * size, 0, size);
}

conic_status conic_memory_append(conic_context *context, void *array, size_t *n, size_t *room, const void *element,
                                 size_t size) {
  void *added = conic_memory_add(context, array, n, room, size);
  if (added)
    memcpy(added, element, size);
  return added ? CONIC_OK : CONIC_ERROR_MEMORY;
}

void conic_memory_release(conic_context *context, void *pointer) {
  if (!pointer)
    return;
  void *raw;
  memcpy(&raw, (char *)pointer - sizeof raw, sizeof raw);
  context->options.release(context->options.allocator_cookie, raw);
}

conic_status conic_memory_allocate_all(conic_context *context, const conic_memory_room *rooms, size_t n) {
  conic_status status = CONIC_OK;
  for (size_t i = 0; i < n; i++) {
    void *block = rooms[i].is_zeroed ? conic_memory_allocate_zeroed(context, rooms[i].count, rooms[i].size)
                                     : conic_memory_allocate(context, rooms[i].count, rooms[i].size);
    status = block ? status : CONIC_ERROR_MEMORY;
    memcpy(rooms[i].array, &block, sizeof block);
  }
  return status;
}

void conic_memory_release_all(conic_context *context, void *const *pointers, size_t n) {
  for (size_t i = 0; i < n; i++)
    conic_memory_release(context, pointers[i]);
}

void conic_memory_prefer_large_pages(const conic_context *context, void *pointer, size_t bytes) {
  if (context->options.large_pages)
    conic_memory_advise_large_pages(pointer, bytes);
}

/* A message is one line. Names and words from files may hold line ends or commands to terminals. */
static void blank_controls(char *message) {
  for (char *c = message; *c; c++)
    if ((unsigned char)*c < 0x20 || *c == 0x7F)
      *c = '?';
}

static void log_arguments(conic_context *context, conic_log_level level, const char *format, va_list arguments) {
  char message[1024];
  if (!context || !context->options.log)
    return;
  vsnprintf(message, sizeof message, format, arguments);
  blank_controls(message);
  context->options.log(context->options.log_cookie, level, message);
}

conic_status(conic_fail)(conic_context *context, conic_status status, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  log_arguments(context, CONIC_LOG_ERROR, format, arguments);
  va_end(arguments);
  return status;
}

void conic_log(conic_context *context, conic_log_level level, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  log_arguments(context, level, format, arguments);
  va_end(arguments);
}

conic_status conic_progress(conic_context *context, const char *task, double fraction) {
  if (!context->options.progress)
    return CONIC_OK;
  if (context->options.progress(context->options.progress_cookie, task, fraction))
    return conic_fail(context, CONIC_ERROR_CANCELLED, "%s: cancelled", task);
  return CONIC_OK;
}

const char *conic_status_string(conic_status status) {
  switch (status) {
  case CONIC_OK:
    return "done";
  case CONIC_ERROR_ARGUMENT:
    return "wrong argument";
  case CONIC_ERROR_INPUT:
    return "unusable input";
  case CONIC_ERROR_MEMORY:
    return "out of memory";
  case CONIC_ERROR_IO:
    return "cannot write";
  case CONIC_ERROR_UNSUPPORTED:
    return "not available";
  case CONIC_ERROR_CANCELLED:
    return "cancelled";
  }
  return "unknown status";
}

uint64_t conic_context_next_version(conic_context *context) {
  return (UINT64_C(1) << 63) + atomic_fetch_add(&context->n_versions, 1);
}
