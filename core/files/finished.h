/* A file that says which parts of a long work are finished, as lines of text:
 *
 *   conic WHAT 1
 *   key KEY
 *   file SHA256 BYTES NAME      each file of a part
 *   PART                        to which they belong, in words of its own
 *
 * What is behind the last part's line means nothing, so that the file is valid whenever a run that appends to it is
 * ended. */
#pragma once

#include "core/files/sha256.h"

typedef struct conic_finished {
  char *text;
  size_t n_bytes;
} conic_finished;

/* A part, and the place of its files' lines. */
typedef struct conic_finished_part {
  size_t files_at;
  const char *words;
  size_t n_words; /* bytes */
} conic_finished_part;

typedef struct conic_finished_file {
  const char *hash, *name; /* hash: 64 digits; name: n_name bytes */
  size_t n_name;
  uint64_t n_bytes;
} conic_finished_file;

/* Reads PATH, which exists. Errors: INPUT (also another key), MEMORY. */
conic_status conic_finished_read(conic_context *context, const char *path, const char *what, const char *key,
                                 conic_finished *list);
void conic_finished_release(conic_context *context, conic_finished *list);

/* The next part from *at on, which is 0 at first; returns 0 past the last. */
int conic_finished_next(const conic_finished *list, size_t *at, conic_finished_part *part);
/* The next file of a part: *at is the part's `files_at` at first; returns 0 past the last. */
int conic_finished_next_file(const conic_finished *list, size_t *at, conic_finished_file *file);

/* Reads a part "WORD NUMBER NUMBER …" with n_numbers numbers; returns 0 where it is something else. */
int conic_finished_numbers(const conic_finished_part *part, const char *word, uint64_t *numbers, int n_numbers);

/* Writes the beginning of a list, and a part of another list. The stream remembers failures. */
void conic_finished_write_head(FILE *stream, const char *what, const char *key);
void conic_finished_write_part(FILE *stream, const conic_finished *list, const conic_finished_part *part);

/* Writes what precedes the name in a line for a file of so many bytes; returns its length. The room is enough for
 * any. */
enum { CONIC_FINISHED_HEAD_ROOM = CONIC_SHA256_ROOM + 40 };
size_t conic_finished_file_head(const char *hash, uint64_t n_bytes, char head[CONIC_FINISHED_HEAD_ROOM]);

/* Whether a file has the noted length and hash. Its name is within `folder`, which is empty or ends in a separator. */
int conic_finished_is_there(const char *folder, const conic_finished_file *file);

/* The length and SHA-256 of a file. Errors: IO, without a message. */
conic_status conic_file_hash(const char *path, uint64_t *n_bytes, char hash[CONIC_SHA256_ROOM]);
