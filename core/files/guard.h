/* What a context has read, so that a program never writes over it, whatever names a file has and whoever named it. */
#ifndef CONIC_GUARD_H
#define CONIC_GUARD_H

#include "conic/context.h"
#include "core/files/disk.h"

/* From now on, as if nothing had been read before, what is opened for reading is noted, and opening it for writing
 * fails; but for what `replaceable`, which may be null, is now the name of. */
void conic_guard_inputs(conic_context *context, const char *replaceable);

/* Notes a file that is open for reading, or is about to be, and the name by which it was opened. Errors: MEMORY. */
conic_status conic_guard_note(conic_context *context, const char *path, const conic_disk_entry *read);

/* The same of a file by its name; one that is not there is no input. */
conic_status conic_guard_note_path(conic_context *context, const char *path);
/* And of a URL of so many bytes, over which nothing can be written. */
conic_status conic_guard_note_url(conic_context *context, const char *url, uint64_t n_bytes);

/* From now on, what is noted belongs to the next part of the work. */
void conic_guard_go_on(conic_context *context);

/* A file that was noted since then; its name is the context's own. */
typedef struct conic_guarded {
  const char *path;
  uint64_t n_bytes;
} conic_guarded;
/* The next one from *at on, which is 0 at first; 0: there is no more. */
int conic_guard_next(const conic_context *context, size_t *at, conic_guarded *read);

/* Whether a file that is there may be written over: not if it was read. Errors: ARGUMENT. */
conic_status conic_guard_check(conic_context *context, const char *path, const conic_disk_entry *existing);

#endif
