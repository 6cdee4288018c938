/* Output files that appear under their name only when they are whole: written beside it, then renamed. A symbolic link
 * is followed, and what is replaced keeps its mode. */
#ifndef CONIC_FILE_H
#define CONIC_FILE_H

#include <stdio.h>

#include "conic/context.h"

typedef struct conic_output conic_output;

/* Opens PATH for writing ("-" is standard output). On success the caller owns *output. Errors: ARGUMENT (it is an
 * input: core/files/guard.h), MEMORY, IO. */
conic_status conic_output_open(conic_context *context, const char *path, conic_output **output);

/* The same of a regular file, but until then it is PART, which stays on failure, too, and of which what stands there is
 * not cut off. PART is to lie beside what PATH leads to (conic_file_follow). Errors: also IO where PATH is no file. */
conic_status conic_output_go_on(conic_context *context, const char *path, const char *part, conic_output **output);

/* Where to write; never null. */
FILE *conic_output_stream(conic_output *output);

/* Under which name it is written until then, for other processes that write to it, too; null: there is none. */
const char *conic_output_temporary(const conic_output *output);

/* Flushes, checks and renames; releases `output`, on failure too (then nothing new stands under PATH). Errors: IO. */
conic_status conic_output_commit(conic_output *output);

/* Commits what was written where `status` is OK; else abandons it and returns `status`. */
conic_status conic_output_end(conic_output *output, conic_status status);

/* Removes what was written and releases `output`; null is allowed. */
void conic_output_abandon(conic_output *output);

/* From now on `watch` is told of each file that was committed, by the name that it was opened by; null: nobody is. */
void conic_outputs_watch(conic_context *context, void (*watch)(void *cookie, const char *path), void *cookie);

/* Removes the temporary files of all outputs, for a program that ends now, whatever its other threads do: no output can
 * be committed, abandoned or opened after this. */
void conic_outputs_give_up(conic_context *context);

/* Removes what programs that were killed have left beside PATH of their outputs to it: hidden files named after
 * processes that are no more, and scratch files that kept their names, untouched for a minute, since others may write
 * to the same disk from elsewhere. For outputs that are too large to be left lying about. */
void conic_output_sweep(conic_context *context, const char *path);

/* What PATH is in the end, past symbolic links, be it there or not; 0 where the room is too small or links go round. */
int conic_file_follow(const char *path, char *target, size_t room);

/* What follows the last slash; and of that what follows its last dot, empty where there is none. */
const char *conic_file_name(const char *path);
const char *conic_file_ending(const char *path);

/* Whether PATH is a file that can be read: no folder, device or pipe, which a name in somebody else's file should not
 * lead to. */
int conic_file_is_there(const char *path);

/* The first bytes of such a file, as many as there are up to n_bytes; 0 where there is none. */
size_t conic_file_read_head(const char *path, void *head, size_t n_bytes);

/* Whether such a file begins with these bytes, 16 at most. */
int conic_file_begins_with(const char *path, const void *bytes, size_t n_bytes);

/* Whether PATH ends in "." and these lower-case letters, in either case whatever the locale is. */
int conic_file_has_ending(const char *path, const char *ending);

#endif
