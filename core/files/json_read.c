#include "core/files/json_read.h"

#include "core/files/input.h"
#include "core/files/number.h"

static const size_t largest_file = 16u << 20;

static void begin_json(conic_context *context, const char *name, conic_json *json) {
  memset(json, 0, sizeof *json);
  json->context = context;
  json->name = name;
  json->line = 1;
}

/* From the start of its text, of n bytes. */
static conic_status begin_reading(conic_json *json, size_t n) {
  if (n == 0)
    return conic_fail(json->context, CONIC_ERROR_INPUT, "%s: the file is empty (line 1)", json->name);
  json->next = (const char *)json->text;
  json->end = json->next + n;
  return CONIC_OK;
}

conic_status conic_json_open(conic_context *context, const char *path, conic_json *json) {
  conic_input input;
  size_t n = 0;
  begin_json(context, path, json);
  conic_status status = conic_input_open(context, path, &input);
  if (status != CONIC_OK)
    return status;
  json->name = input.name;
  status = conic_input_skip_mark(&input);
  if (status == CONIC_OK)
    status = conic_input_take_rest(&input, largest_file, &json->text, &n);
  if (status == CONIC_OK)
    status = begin_reading(json, n);
  conic_input_close(&input);
  if (status != CONIC_OK)
    conic_json_close(json);
  return status;
}

conic_status conic_json_take(conic_context *context, const char *name, const void *bytes, size_t n_bytes,
                             conic_json *json) {
  begin_json(context, name, json);
  json->text = conic_memory_copy(context, bytes, n_bytes);
  if (!json->text)
    return CONIC_ERROR_MEMORY;
  conic_status status = begin_reading(json, n_bytes);
  if (status != CONIC_OK)
    conic_json_close(json);
  return status;
}

void conic_json_close(conic_json *json) {
  conic_memory_release(json->context, json->text);
  memset(json, 0, sizeof *json);
}

conic_status conic_json_wrong(conic_json *json, const char *what) {
  if (json->status == CONIC_OK && json->is_silent)
    json->status = CONIC_ERROR_INPUT;
  else if (json->status == CONIC_OK)
    json->status = conic_fail(json->context, CONIC_ERROR_INPUT, "%s: %s (line %llu)", json->name, what,
                              (unsigned long long)json->line);
  return json->status;
}

static void skip_blanks(conic_json *json) {
  for (; json->next < json->end; json->next++) {
    char c = *json->next;
    if (c != ' ' && c != '\t' && c != '\r' && c != '\n')
      break;
    json->line += c == '\n';
  }
}

/* The next character that is no blank; 0 at the end. */
static char peek(conic_json *json) {
  skip_blanks(json);
  return (char)(json->next < json->end ? *json->next : 0);
}

static conic_status begin_text(conic_json *json, char opening, const char *what) {
  if (json->status != CONIC_OK)
    return json->status;
  if (peek(json) != opening)
    return conic_json_wrong(json, what);
  if (json->depth == CONIC_JSON_DEPTH)
    return conic_json_wrong(json, "nested too deeply");
  json->next++;
  json->is_first[json->depth++] = 1;
  return CONIC_OK;
}

conic_status conic_json_begin_object(conic_json *json) {
  return begin_text(json, '{', "an object is expected");
}

conic_status conic_json_begin_array(conic_json *json) {
  return begin_text(json, '[', "an array is expected");
}

/* Past the comma to the next member or item, or past the closing character. */
static int next_part(conic_json *json, char closing) {
  if (json->status != CONIC_OK)
    return 0;
  char c = peek(json);
  if (c == closing) {
    json->next++;
    json->depth--;
    return 0;
  }
  if (!json->is_first[json->depth - 1]) {
    if (c != ',') {
      conic_json_wrong(json, c ? "a comma or the end of the list is expected" : "the file ends too early");
      return 0;
    }
    json->next++;
  }
  json->is_first[json->depth - 1] = 0;
  return 1;
}

static int hex_digit(char c) {
  return c >= '0' && c <= '9' ? c - '0' : (c | 0x20) >= 'a' && (c | 0x20) <= 'f' ? (c | 0x20) - 'a' + 10 : -1;
}

/* The four digits of an escape; -1 where they are not there. */
static int read_code(conic_json *json) {
  int code = 0, n = 0;
  for (; n < 4 && json->next < json->end && hex_digit(*json->next) >= 0; n++)
    code = code * 16 + hex_digit(*json->next++);
  return n == 4 ? code : -1;
}

/* A character by its number, in UTF-8. Returns how many bytes it has. */
static int put_utf8(char to[4], int code) {
  static const int first[5] = {0, 0, 0xC0, 0xE0, 0xF0};
  int n = code < 0x80 ? 1 : code < 0x800 ? 2 : code < 0x10000 ? 3 : 4;
  for (int i = n - 1; i > 0; i--, code >>= 6)
    to[i] = (char)(0x80 | (code & 63));
  to[0] = (char)(first[n] | code);
  return n;
}

/* The rest of an escape \\u, whose second half may come behind it. What stands for no character becomes '?'. */
static int read_escaped(conic_json *json, char to[4]) {
  int code = read_code(json);
  if (code < 0) {
    conic_json_wrong(json, "a string has a wrong escape");
    return 0;
  }
  const char *behind = json->next;
  if (code >= 0xD800 && code < 0xDC00 && json->end - behind >= 2 && behind[0] == '\\' && behind[1] == 'u') {
    json->next += 2;
    int low = read_code(json);
    if (low >= 0xDC00 && low < 0xE000)
      return put_utf8(to, 0x10000 + ((code - 0xD800) << 10) + (low - 0xDC00));
    json->next = behind;
  }
  return put_utf8(to, code == 0 || (code >= 0xD800 && code < 0xE000) ? '?' : code);
}

/* One character of a string, escaped or not. Returns how many bytes it has; 0 after a message. */
static int read_character(conic_json *json, char to[4]) {
  static const char escapes[] = "\"\\/bfnrt", meanings[] = "\"\\/\b\f\n\r\t";
  unsigned char c = (unsigned char)*json->next++;
  if (c < 0x20) {
    conic_json_wrong(json, "a string has a control character or is not ended");
    return 0;
  }
  to[0] = (char)c;
  if (c != '\\')
    return 1;
  c = (unsigned char)(json->next < json->end ? *json->next++ : 0);
  const char *escape = c ? strchr(escapes, c) : NULL;
  if (c == 'u')
    return read_escaped(json, to);
  if (!escape) {
    conic_json_wrong(json, "a string has a wrong escape");
    return 0;
  }
  to[0] = meanings[escape - escapes];
  return 1;
}

/* Reads a string into `text`, cut to its room, but not within a character. */
static conic_status read_string(conic_json *json, char *text, size_t room) {
  size_t n = 0;
  int is_full = 0;
  json->next++;
  while (json->next < json->end && *json->next != '"') {
    char bytes[4];
    int n_bytes = read_character(json, bytes);
    if (n_bytes == 0)
      return json->status;
    is_full |= n + (size_t)n_bytes >= room;
    for (int i = 0; i < n_bytes && !is_full; i++)
      text[n++] = bytes[i];
  }
  text[n] = 0;
  if (json->next == json->end)
    return conic_json_wrong(json, "a string is not ended");
  json->next++;
  return CONIC_OK;
}

int conic_json_next_member(conic_json *json, char key[CONIC_JSON_KEY_ROOM]) {
  if (!next_part(json, '}'))
    return 0;
  if (peek(json) != '"') {
    conic_json_wrong(json, "a key in quotes is expected");
    return 0;
  }
  if (read_string(json, key, CONIC_JSON_KEY_ROOM) != CONIC_OK)
    return 0;
  if (peek(json) != ':') {
    conic_json_wrong(json, "a colon is expected after a key");
    return 0;
  }
  json->next++;
  return 1;
}

int conic_json_next_item(conic_json *json) {
  return next_part(json, ']');
}

static const char *skip_digits(const char *c, const char *end) {
  while (c < end && conic_is_digit(*c))
    c++;
  return c;
}

/* Past a number as JSON defines it (no leading zeros, digits on both sides of the point); null where there is none. */
static const char *match_number(const char *c, const char *end) {
  if (c < end && *c == '-')
    c++;
  const char *digits = c;
  c = skip_digits(c, end);
  if (c == digits || (*digits == '0' && c - digits > 1))
    return NULL;
  if (c < end && *c == '.') {
    digits = ++c;
    c = skip_digits(c, end);
    if (c == digits)
      return NULL;
  }
  if (c < end && (*c | 0x20) == 'e') {
    c++;
    if (c < end && (*c == '-' || *c == '+'))
      c++;
    digits = c;
    c = skip_digits(c, end);
    if (c == digits)
      return NULL;
  }
  return c;
}

conic_status conic_json_number(conic_json *json, double *value) {
  if (json->status != CONIC_OK)
    return json->status;
  skip_blanks(json);
  const char *after = match_number(json->next, json->end);
  if (!after)
    return conic_json_wrong(json, "a number is expected");
  conic_number_parse(json->next, (size_t)(after - json->next), value);
  json->next = after;
  return CONIC_OK;
}

conic_status conic_json_text(conic_json *json, char *text, size_t room) {
  text[0] = 0;
  if (json->status != CONIC_OK)
    return json->status;
  return peek(json) == '"' ? read_string(json, text, room) : conic_json_wrong(json, "a string is expected");
}

int conic_json_is_object(conic_json *json) {
  return peek(json) == '{';
}

size_t conic_json_text_room(conic_json *json) {
  size_t n = 1;
  if (peek(json) == '"')
    for (const char *c = json->next + 1; c < json->end && *c != '"'; c++, n++)
      if (*c == '\\' && c + 1 < json->end) {
        c++;
        n++;
      }
  return n;
}

conic_status conic_json_raw_text(conic_json *json, const char **text, size_t *length) {
  char start[2];
  *text = "";
  *length = 0;
  if (json->status != CONIC_OK)
    return json->status;
  if (peek(json) != '"')
    return conic_json_wrong(json, "a string is expected");
  const char *first = json->next + 1;
  conic_status status = read_string(json, start, sizeof start);
  if (status == CONIC_OK) {
    *text = first;
    *length = (size_t)(json->next - 1 - first);
  }
  return status;
}

conic_status conic_json_numbers(conic_json *json, double *values, size_t n, size_t *n_read) {
  *n_read = 0;
  conic_json_begin_array(json);
  while (conic_json_next_item(json)) {
    double value = conic_double_of_bits(UINT64_C(0x7ff8000000000000));
    if (peek(json) == 'n')
      conic_json_skip(json);
    else
      conic_json_number(json, &value);
    if (*n_read < n)
      values[*n_read] = value;
    (*n_read)++;
  }
  return json->status;
}

conic_status conic_json_truth(conic_json *json, int *is_true) {
  if (json->status != CONIC_OK)
    return json->status;
  char c = peek(json);
  *is_true = c == 't';
  return c == 't' || c == 'f' ? conic_json_skip(json) : conic_json_wrong(json, "true or false is expected");
}

static conic_status skip_word(conic_json *json) {
  static const char *const words[] = {"true", "false", "null"};
  for (int i = 0; i < 3; i++) {
    size_t n = strlen(words[i]);
    if ((size_t)(json->end - json->next) >= n && memcmp(json->next, words[i], n) == 0) {
      json->next += n;
      return CONIC_OK;
    }
  }
  return conic_json_wrong(json, json->next < json->end ? "a value is expected" : "the file ends too early");
}

conic_status conic_json_skip(conic_json *json) {
  char key[CONIC_JSON_KEY_ROOM];
  double number;
  if (json->status != CONIC_OK)
    return json->status;
  char c = peek(json);
  if (c == '{') {
    conic_json_begin_object(json);
    while (conic_json_next_member(json, key))
      conic_json_skip(json);
  } else if (c == '[') {
    conic_json_begin_array(json);
    while (conic_json_next_item(json))
      conic_json_skip(json);
  } else if (c == '"')
    return read_string(json, key, sizeof key);
  else if (c == '-' || conic_is_digit(c))
    return conic_json_number(json, &number);
  else
    return skip_word(json);
  return json->status;
}

conic_status conic_json_end(conic_json *json) {
  skip_blanks(json);
  if (json->status == CONIC_OK && json->next < json->end)
    conic_json_wrong(json, "something follows the end");
  return json->status;
}
