/* A strict reader of JSON files, value by value in the file's order. After an error every call fails (with one message
 * in all), so that callers may check at the end. */
#pragma once

#include "core/base/base.h"

enum { CONIC_JSON_DEPTH = 64, CONIC_JSON_KEY_ROOM = 64 };

typedef struct conic_json {
  conic_context *context;
  const char *name; /* of the file, for messages */
  unsigned char *text;
  const char *next, *end;
  uint64_t line;
  int depth;
  int is_first[CONIC_JSON_DEPTH]; /* nothing has been read yet of the object or array at that depth */
  conic_status status;
  int is_silent; /* for a caller that reports errors itself; 0 at first */
} conic_json;

/* Reads the whole file, of at most 16 MiB ("-" is standard input); `path` must outlive *json. On success the caller
 * ends it with conic_json_close. Errors: INPUT, MEMORY. */
conic_status conic_json_open(conic_context *context, const char *path, conic_json *json);
/* The same for JSON in memory, which is copied; `name` is for messages. Errors: INPUT, MEMORY. */
conic_status conic_json_take(conic_context *context, const char *name, const void *bytes, size_t n_bytes,
                             conic_json *json);
void conic_json_close(conic_json *json);

/* Enters an object or array: the next value must be one. */
conic_status conic_json_begin_object(conic_json *json);
conic_status conic_json_begin_array(conic_json *json);

int conic_json_is_object(conic_json *json); /* whether the next value is one */

/* To the next member's value. Returns 0 at the end of the object, which is then left, and after an error. Keys are cut
 * to the room. */
int conic_json_next_member(conic_json *json, char key[CONIC_JSON_KEY_ROOM]);

/* To the next item's value. Returns 0 at the end of the array, which is then left, and after an error. */
int conic_json_next_item(conic_json *json);

/* The next value, which must be a number. */
conic_status conic_json_number(conic_json *json, double *value);

/* The next value, which must be a string, in UTF-8; it is cut to the room. */
conic_status conic_json_text(conic_json *json, char *text, size_t room);

/* The room that holds all of the next value, if it is a string. */
size_t conic_json_text_room(conic_json *json);

/* A string that may be long, without a copy: its bytes as in the file, with escapes. */
conic_status conic_json_raw_text(conic_json *json, const char **text, size_t *length);

/* Up to n numbers of the next array, with NaN for null; others are skipped. *n_read says how many it has. */
conic_status conic_json_numbers(conic_json *json, double *values, size_t n, size_t *n_read);

/* The next value, which must be true or false. */
conic_status conic_json_truth(conic_json *json, int *is_true);

/* Skips the next value, of any kind. */
conic_status conic_json_skip(conic_json *json);

/* Nothing may follow. */
conic_status conic_json_end(conic_json *json);

/* Logs "FILE: what (line N)", unless something was wrong before. */
conic_status conic_json_wrong(conic_json *json, const char *what);
