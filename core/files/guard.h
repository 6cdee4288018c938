/* What a context has read, so that a program never writes over it, whatever names a file has and whoever named it. */
#ifndef CONIC_GUARD_H
#define CONIC_GUARD_H

#include "conic/context.h"
#include "core/files/disk.h"

/* From now on, as if nothing had been read before, what is opened for reading is noted, and opening it for writing
 * fails; but for what `replaceable`, which may be null, is now the name of. */
void conic_guard_inputs(conic_context *context, const char *replaceable);

/* Notes a file that is open for reading, or is about to be. Errors: MEMORY. */
conic_status conic_guard_note(conic_context *context, const conic_disk_entry *read);

/* The same of a file by its name; one that is not there is no input. */
conic_status conic_guard_note_path(conic_context *context, const char *path);

/* How many bytes the files have together that were noted so far. */
uint64_t conic_guard_bytes(const conic_context *context);

/* Whether a file that is there may be written over: not if it was read. Errors: ARGUMENT. */
conic_status conic_guard_check(conic_context *context, const char *path, const conic_disk_entry *existing);

#endif
