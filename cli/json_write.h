/* A writer for the JSON that --json asks for: objects and arrays nest, keys come in call order. Numbers are printed so
 * that they read back as the same double; NaN and infinity become null. */
#ifndef CONIC_JSON_WRITE_H
#define CONIC_JSON_WRITE_H

#include <stdint.h>
#include <stdio.h>

#include "conic/model.h"

struct cli_host;

typedef struct cli_json {
  FILE *to;
  struct cli_host *host; /* null, or who gets records in the place of text (cli/host.h) */
  int depth, has_items[32];
} cli_json;

void cli_json_begin(cli_json *json, FILE *to);         /* opens the outermost object */
int cli_json_end(cli_json *json);                      /* closes it with a newline; 0 where writing failed */
void cli_json_object(cli_json *json, const char *key); /* key is null inside an array */
void cli_json_array(cli_json *json, const char *key);
void cli_json_close(cli_json *json);                                     /* the innermost object or array */
void cli_json_text(cli_json *json, const char *key, const char *value);  /* null becomes null */
void cli_json_value(cli_json *json, const char *key, const char *value); /* which is JSON; null becomes null */
void cli_json_number(cli_json *json, const char *key, double value);
void cli_json_count(cli_json *json, const char *key, uint64_t value);
void cli_json_bool(cli_json *json, const char *key, int value);
void cli_json_hash(cli_json *json, const char *key, uint64_t value); /* 16 hex digits */

/* The object "skipped": what was left out or put right, and why. */
void cli_json_skipped(cli_json *json, const conic_repairs *repairs);

struct cli_session;

/* Opens the session's --json file ("-" is standard output) for cli_json; null where none was asked for or, after a
 * message, where it can't be written (*exit_code is then set). Ended by cli_json_finish, which returns the exit code.
 */
typedef struct cli_json_file cli_json_file;
cli_json *cli_json_open(struct cli_session *session, cli_json_file **file, int *exit_code);
int cli_json_finish(cli_json_file *file);

#endif
