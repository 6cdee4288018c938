/* Notes what a context has read, so that a program never writes over it, whatever names the files have. */
#ifndef CONIC_GUARD_H
#define CONIC_GUARD_H

#include "conic/context.h"
#include "core/files/disk.h"

/* From now on every file opened for reading is noted, and cannot be opened for writing; earlier ones are forgotten. The
 * file that `replaceable` (may be null) now names is exempt. */
void conic_guard_inputs(conic_context *context, const char *replaceable);

/* Notes a file that is open for reading, or will be at once. Errors: MEMORY. */
conic_status conic_guard_note(conic_context *context, const conic_disk_entry *read);

/* Notes a file by its name; a missing file is no input. */
conic_status conic_guard_note_path(conic_context *context, const char *path);

/* The bytes of all files noted so far. */
uint64_t conic_guard_bytes(const conic_context *context);

/* Whether an existing file may be written over: not if it was read. Errors: ARGUMENT. */
conic_status conic_guard_check(conic_context *context, const char *path, const conic_disk_entry *existing);

#endif
