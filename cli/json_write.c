#include "cli/json_write.h"

#include <inttypes.h>

#include "cli/host_keeps.h"
#include "core/files/file.h"

/* What has_items remembers of each open object or array. */
enum { HAS_ITEMS = 1, IS_ARRAY = 2, HAS_LINES = 4, MAX_DEPTH = 32 };

/* The length of the UTF-8 sequence that begins at `text`; 0 where it is none. */
static int sequence_length(const unsigned char *text) {
  int length = text[0] < 0x80   ? 1
               : text[0] < 0xC2 ? 0
               : text[0] < 0xE0 ? 2
               : text[0] < 0xF0 ? 3
               : text[0] < 0xF5 ? 4
                                : 0;
  for (int i = 1; i < length; i++)
    if ((text[i] & 0xC0) != 0x80)
      return 0;
  int is_overlong = (text[0] == 0xE0 && text[1] < 0xA0) || (text[0] == 0xF0 && text[1] < 0x90);
  int is_no_character = (text[0] == 0xED && text[1] >= 0xA0) || (text[0] == 0xF4 && text[1] >= 0x90);
  return is_overlong || is_no_character ? 0 : length;
}

/* File names may hold any byte; the JSON stays valid: what is not UTF-8 becomes the replacement character. */
static void print_text(FILE *to, const char *value) {
  const unsigned char *text = (const unsigned char *)value;
  fputc('"', to);
  while (*text) {
    int length = sequence_length(text);
    if (length == 0)
      fputs("\xEF\xBF\xBD", to);
    else if (*text == '"' || *text == '\\')
      fprintf(to, "\\%c", *text);
    else if (*text < 0x20)
      fprintf(to, "\\u%04x", *text);
    else
      fwrite(text, 1, (size_t)length, to);
    text += length ? length : 1;
  }
  fputc('"', to);
}

static void new_line(cli_json *json) {
  fprintf(json->to, "\n%*s", 2 * json->depth, "");
}

/* Objects have an item a line; arrays of plain values stay on one line. */
static void begin_item(cli_json *json, const char *key, int is_object) {
  int *state = &json->has_items[json->depth - 1];
  if (*state & HAS_ITEMS)
    fputc(',', json->to);
  if (!(*state & IS_ARRAY) || is_object) {
    new_line(json);
    *state |= HAS_LINES;
  } else if (*state & HAS_ITEMS)
    fputc(' ', json->to);
  *state |= HAS_ITEMS;
  if (key) {
    print_text(json->to, key);
    fputs(": ", json->to);
  }
}

static void open_level(cli_json *json, char bracket, int state) {
  if (json->depth >= MAX_DEPTH)
    abort(); /* a command's mistake, not an input's: what is nested is written in its source */
  fputc(bracket, json->to);
  json->has_items[json->depth++] = state;
}

void cli_json_begin(cli_json *json, FILE *to) {
  memset(json, 0, sizeof *json);
  json->to = to;
  open_level(json, '{', 0);
}

/* What a host is told in the place of text; 0: there is none. */
static int is_told_to_host(const cli_json *json, char type, const char *key, const void *value, size_t n_bytes) {
  if (json->host)
    cli_host_note(json->host, type, key, value, n_bytes);
  return json->host != NULL;
}

void cli_json_object(cli_json *json, const char *key) {
  if (is_told_to_host(json, 'o', key, NULL, 0))
    return;
  begin_item(json, key, 1);
  open_level(json, '{', 0);
}

void cli_json_array(cli_json *json, const char *key) {
  if (is_told_to_host(json, 'a', key, NULL, 0))
    return;
  begin_item(json, key, 0);
  open_level(json, '[', IS_ARRAY);
}

void cli_json_close(cli_json *json) {
  if (is_told_to_host(json, 'e', NULL, NULL, 0))
    return;
  int state = json->has_items[--json->depth];
  if (state & HAS_LINES)
    new_line(json);
  fputc(state & IS_ARRAY ? ']' : '}', json->to);
}

int cli_json_end(cli_json *json) {
  while (json->depth > 0)
    cli_json_close(json);
  fputc('\n', json->to);
  return fflush(json->to) == 0 && !ferror(json->to);
}

void cli_json_text(cli_json *json, const char *key, const char *value) {
  if (is_told_to_host(json, value ? 't' : 'z', key, value, value ? strlen(value) + 1 : 0))
    return;
  begin_item(json, key, 0);
  if (value)
    print_text(json->to, value);
  else
    fputs("null", json->to);
}

void cli_json_value(cli_json *json, const char *key, const char *value) {
  begin_item(json, key, 0);
  fputs(value ? value : "null", json->to);
}

void cli_json_number(cli_json *json, const char *key, double value) {
  char text[40];
  const int is_finite = value - value == 0.0;
  if (is_told_to_host(json, is_finite ? 'n' : 'z', key, &value, is_finite ? sizeof value : 0))
    return;
  begin_item(json, key, 0);
  if (!is_finite) {
    fputs("null", json->to);
    return;
  }
  for (int digits = 15; digits <= 17; digits++) {
    snprintf(text, sizeof text, "%.*g", digits, value);
    if (strtod(text, NULL) == value)
      break;
  }
  fputs(text, json->to);
}

void cli_json_count(cli_json *json, const char *key, uint64_t value) {
  if (is_told_to_host(json, 'c', key, &value, sizeof value))
    return;
  begin_item(json, key, 0);
  fprintf(json->to, "%" PRIu64, value);
}

void cli_json_bool(cli_json *json, const char *key, int value) {
  const char truth = value != 0;
  if (is_told_to_host(json, 'b', key, &truth, 1))
    return;
  begin_item(json, key, 0);
  fputs(value ? "true" : "false", json->to);
}

void cli_json_hash(cli_json *json, const char *key, uint64_t value) {
  char text[17];
  snprintf(text, sizeof text, "%016" PRIx64, value);
  cli_json_text(json, key, text);
}

int cli_json_open(cli_session *session, cli_json **json) {
  *json = NULL;
  if (!session->json_path || !cli_session_speaks(session))
    return CLI_DONE;
  cli_json *made = calloc(1, sizeof *made);
  if (!made)
    return cli_error(CLI_RESOURCE, "%s: out of memory", session->json_path);
  conic_output *output = NULL;
  conic_status status = session->host ? CONIC_OK : conic_output_open(session->context, session->json_path, &output);
  if (status != CONIC_OK) {
    free(made);
    return cli_exit_of(status);
  }
  if (session->host)
    cli_host_release(session->host);
  else
    cli_json_begin(made, conic_output_stream(output));
  made->host = session->host;
  made->output = output;
  *json = made;
  return CLI_DONE;
}

int cli_json_finish(cli_json *json) {
  conic_status status = CONIC_OK;
  if (json->host)
    status = json->host->facts_are_lost ? CONIC_ERROR_MEMORY : CONIC_OK;
  else {
    cli_json_end(json); /* what it says of a file's stream, commit finds again */
    status = conic_output_commit(json->output);
  }
  free(json);
  return cli_exit_of(status);
}

int cli_json_write(cli_session *session, void (*members)(cli_json *json, const void *job), const void *job) {
  cli_json *json;
  int exit_code = cli_json_open(session, &json);
  if (!json)
    return exit_code;
  members(json, job);
  return cli_json_finish(json);
}

int cli_json_leaves_text(const cli_session *session) {
  return !(session->json_path && strcmp(session->json_path, "-") == 0);
}

void cli_json_numbers(cli_json *json, const char *key, const double *values, int n) {
  cli_json_array(json, key);
  for (int i = 0; i < n; i++)
    cli_json_number(json, NULL, values[i]);
  cli_json_close(json);
}

/* A list of members: an object, or members of the present one where the key is null. */
#define PUT_MEMBERS(function, member, put)                                                                             \
  void function(cli_json *json, const char *key, const member *members, size_t n) {                                    \
    if (key)                                                                                                           \
      cli_json_object(json, key);                                                                                      \
    for (size_t i = 0; i < n; i++)                                                                                     \
      put(json, members[i].key, members[i].value);                                                                     \
    if (key)                                                                                                           \
      cli_json_close(json);                                                                                            \
  }
PUT_MEMBERS(cli_json_put_figures, cli_json_figure, cli_json_number)
PUT_MEMBERS(cli_json_put_counts, cli_json_counted, cli_json_count)
PUT_MEMBERS(cli_json_put_texts, cli_json_word, cli_json_text)

void cli_json_skipped(cli_json *json, const conic_repairs *repairs) {
  cli_json_counts(json, "skipped", {"nan", repairs->nan}, {"zero", repairs->zero}, {"duplicate", repairs->duplicate},
                  {"isolated", repairs->isolated}, {"failed", repairs->failed}, {"clip", repairs->clip});
}
