/* Output files that appear under their name only when they are whole: written beside it, then renamed. Symbolic links
 * are followed, and a replaced file's mode is kept. */
#pragma once

#include "core/base/base.h"

typedef struct conic_output conic_output;

/* Opens PATH for writing ("-" is standard output). On success the caller owns *output. Errors: ARGUMENT (it is an
 * input: core/files/guard.h), MEMORY, IO. */
conic_status conic_output_open(conic_context *context, const char *path, conic_output **output);

/* conic_output_open for a regular file that is PART until it is committed. PART stays on failure, too, and its contents
 * are kept when it is opened. PART must lie beside the file that PATH leads to (conic_file_follow). Errors: also IO
 * where PATH is not a regular file. */
conic_status conic_output_go_on(conic_context *context, const char *path, const char *part, conic_output **output);

/* Where to write; never null. */
FILE *conic_output_stream(conic_output *output);

/* The name under which it is written until then, for other processes that write to it, too; null: there is none. */
const char *conic_output_temporary(const conic_output *output);

/* Flushes, checks and renames; releases `output`, on failure too (then PATH stays as it was). Errors: IO. */
conic_status conic_output_commit(conic_output *output);

/* Commits the output if `status` is OK; else abandons it and returns `status`. */
conic_status conic_output_end(conic_output *output, conic_status status);

/* Removes what was written and releases `output`; null is allowed. */
void conic_output_abandon(conic_output *output);

/* From now on `watch` is told of each committed file, by the name with which it was opened; null: not told. */
void conic_outputs_watch(conic_context *context, void (*watch)(void *cookie, const char *path), void *cookie);

/* Removes the temporary files of all outputs, for a program that ends now, whatever its other threads do. No output can
 * be committed, abandoned or opened after this. */
void conic_outputs_give_up(conic_context *context);

/* Removes the files that killed programs left beside PATH when writing to it: hidden files named after processes that
 * have ended, and scratch files that kept their names. They must be untouched for a minute, since other machines may
 * write to the same disk. Opening an output does it; who needs room on the disk long before does it himself. Errors:
 * MEMORY. */
conic_status conic_output_sweep(conic_context *context, const char *path);

/* Follows PATH through symbolic links, whether the file exists or not; 0 where the room is too small or links go
 * round. */
int conic_file_follow(const char *path, char *target, size_t room);

/* The part after the last slash; and of that the part after the last dot, empty where there is none. */
const char *conic_file_name(const char *path);
const char *conic_file_ending(const char *path);

/* Whether PATH is a regular file that can be read. A name in somebody else's file should not lead to a folder, device
 * or pipe. */
int conic_file_is_there(const char *path);

/* The first bytes of such a file, at most n_bytes; returns how many, or 0 where there is none. */
size_t conic_file_read_head(const char *path, void *head, size_t n_bytes);

/* Whether such a file begins with these bytes, 16 at most. */
int conic_file_begins_with(const char *path, const void *bytes, size_t n_bytes);

/* Whether PATH ends in "." and these lower-case letters, in either case, in any locale. */
int conic_file_has_ending(const char *path, const char *ending);
