/* A writer for the JSON that --json asks for: objects and arrays nest, keys come in call order. Numbers are printed so
 * that they read back as the same double; NaN and infinity become null. */
#pragma once

#include "conic/model.h"
#include "core/base/base.h"

struct cli_host;

typedef struct cli_json {
  FILE *to;
  struct cli_host *host;       /* null, or who gets records in the place of text (cli/host.h) */
  struct conic_output *output; /* of a session's --json */
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
void cli_json_hash(cli_json *json, const char *key, uint64_t value);                 /* 16 hex digits */
void cli_json_numbers(cli_json *json, const char *key, const double *values, int n); /* as an array */

/* Members from a table of {"KEY", value}, …: as an object of that key, or in the open object where it is null. */
#define cli_json_figures(json, key, ...) CLI_JSON_TABLE(cli_json_put_figures, cli_json_figure, json, key, __VA_ARGS__)
#define cli_json_counts(json, key, ...) CLI_JSON_TABLE(cli_json_put_counts, cli_json_counted, json, key, __VA_ARGS__)
#define cli_json_texts(json, key, ...) CLI_JSON_TABLE(cli_json_put_texts, cli_json_word, json, key, __VA_ARGS__)
#define CLI_JSON_TABLE(put, type, json, key, ...)                                                                      \
  put(json, key, (const type[]){__VA_ARGS__}, sizeof(type[]){__VA_ARGS__} / sizeof(type))

typedef struct cli_json_figure {
  const char *key;
  double value;
} cli_json_figure;

typedef struct cli_json_counted {
  const char *key;
  uint64_t value;
} cli_json_counted;

typedef struct cli_json_word {
  const char *key, *value;
} cli_json_word;

void cli_json_put_figures(cli_json *json, const char *key, const cli_json_figure *members, size_t n);
void cli_json_put_counts(cli_json *json, const char *key, const cli_json_counted *members, size_t n);
void cli_json_put_texts(cli_json *json, const char *key, const cli_json_word *members, size_t n);

/* The object "skipped": what was left out or put right, and why. */
void cli_json_skipped(cli_json *json, const conic_repairs *repairs);

struct cli_session;

/* Opens the session's --json file ("-" is standard output). Returns CLI_DONE or, after a message, the exit code; *json
 * is null then, and where none was asked for. Ended by cli_json_finish, which returns the exit code. */
int cli_json_open(struct cli_session *session, cli_json **json);
int cli_json_finish(cli_json *json);

/* The same of members that a function writes. */
int cli_json_write(struct cli_session *session, void (*members)(cli_json *json, const void *job), const void *job);

/* Whether standard output is for people, because --json does not go there. What a command was asked for is said there
 * to who wants it quiet, too. */
int cli_json_leaves_text(const struct cli_session *session);
