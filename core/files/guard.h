/* Notes what a context has read, so that a program never writes over it, whatever names the files have. */
#pragma once

#include "core/files/disk.h"

/* From now on every file opened for reading is noted, and cannot be opened for writing; earlier ones are forgotten. The
 * file that `replaceable` (may be null) now names is exempt. */
void conic_guard_inputs(conic_context *context, const char *replaceable);

/* Notes a file that is open for reading, or is about to be, and the name by which it was opened. Errors: MEMORY. */
conic_status conic_guard_note(conic_context *context, const char *path, const conic_disk_entry *read);

/* Notes a file by its name; a missing file is no input. */
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

/* Whether an existing file may be written over: not if it was read. Errors: ARGUMENT. */
conic_status conic_guard_check(conic_context *context, const char *path, const conic_disk_entry *existing);
