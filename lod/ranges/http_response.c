#include "lod/ranges/http_response.h"

#include <strings.h>

enum { MOST_HEADER_BYTES = 1 << 16 };

/* A number, and what follows it: null where there is none, or one past 2⁶⁴. */
static const char *read_number(const char *text, uint64_t *number) {
  if (*text < '0' || *text > '9')
    return NULL;
  for (*number = 0; *text >= '0' && *text <= '9'; text++) {
    uint64_t digit = (uint64_t)(*text - '0');
    if (*number > (UINT64_MAX - digit) / 10)
      return NULL;
    *number = 10 * *number + digit;
  }
  return text;
}

/* "HTTP/1.1 206 Partial Content": a response begins, and what an earlier one said is void. */
static void begin_response(conic_http_response *response, const char *line) {
  uint64_t status = 0;
  size_t n_bytes = response->n_bytes;
  memset(response, 0, sizeof *response);
  response->n_bytes = n_bytes;
  const char *space = strchr(line, ' ');
  if (space && read_number(space + 1, &status) && status < 1000)
    response->status = (int)status;
}

/* "bytes 0-65535/1234567" */
static void take_range(conic_http_response *response, const char *text) {
  response->has_range = 0;
  if (strncasecmp(text, "bytes", 5) != 0)
    return;
  for (text += 5; *text == ' ' || *text == '\t';)
    text++;
  const char *rest = read_number(text, &response->first);
  if (rest && *rest == '-')
    rest = read_number(rest + 1, &response->last);
  else
    rest = NULL;
  if (rest && *rest == '/')
    rest = read_number(rest + 1, &response->size);
  else
    rest = NULL;
  response->has_range = rest && *rest == '\0' && response->first <= response->last && response->last < response->size;
}

static void take_length(conic_http_response *response, const char *text) {
  const char *rest = read_number(text, &response->length);
  response->has_length = rest && *rest == '\0';
}

static void take_tag(conic_http_response *response, const char *text) {
  size_t length = strlen(text);
  response->tag[0] = '\0';
  if (text[0] == '"' && length < sizeof response->tag)
    memcpy(response->tag, text, length + 1);
}

/* What stands behind a header's name; null where it is another one. */
static const char *value_of(const char *line, const char *name) {
  size_t length = strlen(name);
  if (strncasecmp(line, name, length) != 0 || line[length] != ':')
    return NULL;
  for (line += length + 1; *line == ' ' || *line == '\t';)
    line++;
  return line;
}

int conic_http_header(conic_http_response *response, const char *line, size_t n_bytes) {
  char text[256] = "";
  const char *value;
  response->n_bytes += n_bytes;
  if (response->n_bytes > MOST_HEADER_BYTES)
    return 0;
  while (n_bytes > 0 && (line[n_bytes - 1] == '\n' || line[n_bytes - 1] == '\r' || line[n_bytes - 1] == ' '))
    n_bytes--;
  if (n_bytes >= sizeof text) /* none of ours is that long */
    return 1;
  memcpy(text, line, n_bytes);
  text[n_bytes] = '\0';
  if (strncmp(text, "HTTP/", 5) == 0)
    begin_response(response, text);
  else if ((value = value_of(text, "Content-Range")))
    take_range(response, value);
  else if ((value = value_of(text, "Content-Length")))
    take_length(response, value);
  else if ((value = value_of(text, "Content-Encoding")))
    response->is_packed = *value != '\0' && strcasecmp(value, "identity") != 0;
  else if ((value = value_of(text, "ETag")))
    take_tag(response, value);
  return 1;
}
