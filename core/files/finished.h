/* A file that says which parts of a long work are finished, as lines of text:
 *
 *   conic WHAT 1
 *   key KEY
 *   file SHA256 BYTES NAME      each file of a part
 *   PART                        to which they belong, in words of its own
 *
 * What is behind the last part's line means nothing, so that the file is valid whenever a run that appends to it is
 * ended. */
#ifndef CONIC_FINISHED_H
#define CONIC_FINISHED_H

#include <stdio.h>

#include "conic/context.h"
#include "core/files/sha256.h"

typedef struct conic_finished {
  char *text;
  size_t n_bytes;
} conic_finished;

/* A part, and where the lines of its files are. */
typedef struct conic_finished_part {
  size_t files_at;
  const char *words;
  size_t n_words; /* bytes */
} conic_finished_part;

typedef struct conic_finished_file {
  const char *hash, *name; /* 64 digits; as long as n_name */
  size_t n_name;
  uint64_t n_bytes;
} conic_finished_file;

/* Reads PATH, which is there. Errors: INPUT, MEMORY; also where it is of another key. */
conic_status conic_finished_read(conic_context *context, const char *path, const char *what, const char *key,
                                 conic_finished *list);
void conic_finished_release(conic_context *context, conic_finished *list);

/* The next part from *at on, which is 0 at first. 0: there is no more. */
int conic_finished_next(const conic_finished *list, size_t *at, conic_finished_part *part);
/* The next file of a part: *at is its `files_at` at first. 0: there is no more. */
int conic_finished_next_file(const conic_finished *list, size_t *at, conic_finished_file *file);

/* A part's "WORD NUMBER NUMBER …", with so many of them; whether it is that. */
int conic_finished_numbers(const conic_finished_part *part, const char *word, uint64_t *numbers, int n_numbers);

/* What a list begins with, and a part of another. The stream remembers what fails. */
void conic_finished_write_head(FILE *stream, const char *what, const char *key);
void conic_finished_write_part(FILE *stream, const conic_finished *list, const conic_finished_part *part);

/* Room for what is before a name in its line, and that, of a file of so many bytes. Returns how long it is. */
enum { CONIC_FINISHED_HEAD_ROOM = CONIC_SHA256_ROOM + 40 };
size_t conic_finished_file_head(const char *hash, uint64_t n_bytes, char head[CONIC_FINISHED_HEAD_ROOM]);

/* Whether a file has the length and the hash that are noted; its name is of the folder, which is empty or ends in a
 * separator. */
int conic_finished_is_there(const char *folder, const conic_finished_file *file);

/* The length and SHA-256 of a file. Errors: IO, without a message. */
conic_status conic_file_hash(const char *path, uint64_t *n_bytes, char hash[CONIC_SHA256_ROOM]);

#endif
