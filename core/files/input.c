#include "core/files/input.h"

#include <stdarg.h>
#include <unistd.h>

#include "core/files/file.h"
#include "core/files/guard.h"
#include "core/files/number.h"

/* Progress is reported this often: a few times a second on a fast disk. */
static const uint64_t report_bytes = 64u << 20;

static conic_status check_kind(conic_input *input) {
  conic_disk_entry found;
  if (!conic_disk_look_at(input->descriptor, &found))
    return conic_fail(input->context, CONIC_ERROR_INPUT, "%s: cannot read: %s", input->name, strerror(errno));
  if (found.is_folder)
    return conic_fail(input->context, CONIC_ERROR_INPUT, "%s: cannot read: it is a directory", input->name);
  conic_status status = conic_guard_note(input->context, input->name, &found);
  if (status != CONIC_OK)
    return status;
  if (found.is_file) { /* standard input may be a file that was read in part */
    int64_t start = conic_disk_position(input->descriptor);
    input->has_size = start >= 0 && found.n_bytes >= (uint64_t)start;
    input->start_bytes = input->has_size ? (uint64_t)start : 0;
    input->size_bytes = input->has_size ? found.n_bytes - (uint64_t)start : 0;
  }
  return CONIC_OK;
}

conic_status conic_input_open(conic_context *context, const char *path, conic_input *input) {
  int is_standard = strcmp(path, "-") == 0;
  memset(input, 0, sizeof *input);
  input->context = context;
  input->name = is_standard ? "standard input" : path;
  input->line = 1;
  input->descriptor = is_standard ? STDIN_FILENO : conic_disk_open(path);
  if (input->descriptor < 0)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: cannot read: %s", path, strerror(errno));
  conic_status status = check_kind(input);
  if (status == CONIC_OK) {
    input->window = conic_memory_allocate(context, CONIC_INPUT_WINDOW, 1);
    status = input->window ? CONIC_OK : CONIC_ERROR_MEMORY;
  }
  if (status != CONIC_OK)
    conic_input_close(input);
  return status;
}

void conic_input_close(conic_input *input) {
  if (input->descriptor > STDIN_FILENO)
    close(input->descriptor);
  conic_memory_release(input->context, input->window);
  memset(input, 0, sizeof *input);
}

static conic_status report_progress(conic_input *input) {
  uint64_t end = input->window_offset + input->filled;
  int is_last = end >= input->size_bytes && input->reported_bytes > 0 && input->reported_bytes < end;
  if (!input->has_size || (end - input->reported_bytes < report_bytes && !is_last))
    return CONIC_OK;
  input->reported_bytes = end;
  double fraction = (double)end / (double)input->size_bytes;
  return conic_progress(input->context, "read", fraction < 1.0 ? fraction : 1.0);
}

static ptrdiff_t read_on(const conic_input *input, size_t n_bytes) {
  unsigned char *to = input->window + input->filled;
  return input->has_jumped ? conic_disk_read_at(input->descriptor, to, n_bytes,
                                                input->start_bytes + input->window_offset + input->filled)
                           : conic_disk_read(input->descriptor, to, n_bytes);
}

conic_status conic_input_fill(conic_input *input, size_t count) {
  if (conic_input_available(input) >= count || input->is_at_end)
    return CONIC_OK;
  input->filled -= input->next;
  memmove(input->window, input->window + input->next, input->filled);
  input->window_offset += input->next;
  input->next = 0;
  while (input->filled < count && !input->is_at_end) {
    ptrdiff_t n = read_on(input, CONIC_INPUT_WINDOW - input->filled);
    if (n < 0 && errno == EINTR) { /* a signal may ask to stop while a pipe is waited for */
      conic_status status = conic_progress(input->context, "read", 0.0);
      if (status != CONIC_OK)
        return status;
      continue;
    }
    if (n < 0)
      return conic_fail(input->context, CONIC_ERROR_INPUT, "%s: cannot read: %s (at byte %llu)", input->name,
                        strerror(errno), (unsigned long long)input->window_offset + input->filled);
    input->filled += (size_t)n;
    input->is_at_end = n == 0;
  }
  return report_progress(input);
}

conic_status conic_input_read_at(const conic_input *input, uint64_t offset, void *bytes, size_t n, size_t *n_read) {
  for (*n_read = 0; *n_read < n;) {
    uint64_t at = offset + *n_read;
    ptrdiff_t n_now =
        conic_disk_read_at(input->descriptor, (char *)bytes + *n_read, n - *n_read, input->start_bytes + at);
    if (n_now < 0 && errno != EINTR)
      return conic_fail(input->context, CONIC_ERROR_INPUT, "%s: cannot read: %s (at byte %llu)", input->name,
                        strerror(errno), (unsigned long long)at);
    if (n_now == 0)
      break;
    *n_read += n_now > 0 ? (size_t)n_now : 0;
  }
  return CONIC_OK;
}

uint64_t conic_input_remaining_bytes(const conic_input *input) {
  uint64_t offset = conic_input_offset(input);
  if (!input->has_size)
    return UINT64_MAX;
  return offset < input->size_bytes ? input->size_bytes - offset : 0;
}

/* Jumps over bytes that need not be read. */
static void jump(conic_input *input, uint64_t count) {
  input->window_offset += input->next + count;
  input->next = input->filled = 0;
  input->has_jumped = 1;
}

conic_status conic_input_skip(conic_input *input, uint64_t count, uint64_t *skipped) {
  *skipped = 0;
  if (input->has_size && count > CONIC_INPUT_WINDOW && count <= conic_input_remaining_bytes(input)) {
    jump(input, count);
    *skipped = count;
  }
  while (*skipped < count) {
    conic_status status = conic_input_fill(input, 1);
    if (status != CONIC_OK)
      return status;
    uint64_t n = conic_input_available(input), left = count - *skipped;
    if (n == 0)
      break;
    n = n < left ? n : left;
    input->next += (size_t)n;
    *skipped += n;
  }
  return CONIC_OK;
}

/* Whether text of two bytes a character begins here: with its mark, or with four letters, digits or blanks of ASCII. */
static int is_utf16(const unsigned char *c, size_t n) {
  if (n >= 2 && ((c[0] == 0xFF && c[1] == 0xFE) || (c[0] == 0xFE && c[1] == 0xFF)))
    return 1;
  for (size_t first = 0; first < 2 && n >= 8; first++) {
    int is_text = 1;
    for (size_t i = 0; i < 8; i += 2)
      is_text &= c[i + 1 - first] == 0 && (c[i + first] < 0x7F && (c[i + first] >= 0x20 || c[i + first] == '\t'));
    if (is_text)
      return 1;
  }
  return 0;
}

conic_status conic_text_byte_order_mark(conic_context *context, const char *name, const unsigned char *bytes,
                                        size_t n_bytes, size_t *n_mark) {
  if (is_utf16(bytes, n_bytes))
    return conic_fail(context, CONIC_ERROR_INPUT,
                      "%s: this is UTF-16 text: save it as UTF-8 (iconv -f UTF-16 -t UTF-8 FILE > out) (at byte 0)",
                      name);
  *n_mark = n_bytes >= 3 && memcmp(bytes, "\xEF\xBB\xBF", 3) == 0 ? 3 : 0;
  return CONIC_OK;
}

conic_status conic_input_take(conic_input *input, uint64_t most, unsigned char **bytes, size_t *n_bytes) {
  uint64_t remaining = conic_input_remaining_bytes(input);
  size_t room = 0;
  conic_status status = CONIC_OK;
  *n_bytes = 0;
  if (remaining != UINT64_MAX)
    status = conic_memory_reserve(input->context, bytes, 0, (size_t)(remaining < most ? remaining : most), &room, 1);
  for (size_t n = 1; status == CONIC_OK && n > 0;) {
    status = conic_input_fill(input, 1);
    n = conic_input_available(input);
    n = n < most - *n_bytes ? n : (size_t)(most - *n_bytes);
    if (status == CONIC_OK)
      status = conic_memory_reserve(input->context, bytes, *n_bytes, *n_bytes + n, &room, 1);
    if (status == CONIC_OK && n > 0)
      memcpy(*bytes + *n_bytes, conic_input_bytes(input), n);
    input->next += status == CONIC_OK ? n : 0;
    *n_bytes += status == CONIC_OK ? n : 0;
  }
  return status;
}

conic_status conic_input_take_rest(conic_input *input, uint64_t most, unsigned char **bytes, size_t *n_bytes) {
  conic_status status = conic_input_take(input, most, bytes, n_bytes);
  return status == CONIC_OK && conic_input_available(input) > 0
             ? conic_fail(input->context, CONIC_ERROR_INPUT, "%s: files of this kind are read up to %llu MiB",
                          input->name, (unsigned long long)(most >> 20) + 1)
             : status;
}

conic_status conic_input_skip_mark(conic_input *input) {
  size_t n_mark = 0;
  conic_status status = conic_input_fill(input, 8);
  if (status == CONIC_OK)
    status = conic_text_byte_order_mark(input->context, input->name, conic_input_bytes(input),
                                        conic_input_available(input), &n_mark);
  input->next += n_mark;
  return status;
}

conic_status conic_input_line(conic_input *input, const char **text, size_t *length) {
  conic_status status = conic_input_fill(input, CONIC_INPUT_LONGEST_LINE + 1);
  size_t n = conic_input_available(input);
  if (status != CONIC_OK)
    return status;
  *text = (const char *)conic_input_bytes(input);
  const char *end = memchr(*text, '\n', n);
  *length = end ? (size_t)(end - *text) : n;
  return *length > CONIC_INPUT_LONGEST_LINE
             ? conic_input_wrong(input, "a line of more than %d bytes", CONIC_INPUT_LONGEST_LINE)
             : CONIC_OK;
}

/* The length of a \ and line end; 0 where something else is at `c`. */
static size_t continuation(const conic_input *input, const char *c, const char *end) {
  if (!input->continues_lines || *c != '\\')
    return 0;
  if (end - c >= 2 && c[1] == '\n')
    return 2;
  return end - c >= 3 && c[1] == '\r' && c[2] == '\n' ? 3 : 0;
}

static int is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

/* To the next byte that is neither blank nor part of a continuation. */
static conic_status skip_blanks(conic_input *input) {
  for (;;) {
    conic_status status = conic_input_fill(input, CONIC_INPUT_LONGEST_WORD + 4);
    if (status != CONIC_OK)
      return status;
    const char *c = (const char *)conic_input_bytes(input), *end = (const char *)input->window + input->filled;
    while (c < end && is_blank(*c))
      c++;
    input->next = (size_t)(c - (const char *)input->window);
    size_t continued = c < end ? continuation(input, c, end) : 0;
    input->next += continued;
    input->line += continued != 0;
    if (!continued && (c < end || input->is_at_end))
      break;
  }
  return conic_input_fill(input, CONIC_INPUT_LONGEST_WORD + 4);
}

conic_status conic_input_word(conic_input *input, const char **word, size_t *length) {
  conic_status status = skip_blanks(input);
  if (status != CONIC_OK)
    return status;
  const char *c = (const char *)conic_input_bytes(input), *end = (const char *)input->window + input->filled;
  *word = c;
  while (c < end && *c != '\n' && !is_blank(*c) && !continuation(input, c, end))
    c++;
  *length = (size_t)(c - *word);
  if (*length > CONIC_INPUT_LONGEST_WORD)
    return conic_input_wrong(input, "a word of more than %d bytes", CONIC_INPUT_LONGEST_WORD);
  input->next += *length;
  return CONIC_OK;
}

conic_status conic_input_rest(conic_input *input, const char **text, size_t *length) {
  conic_status status = skip_blanks(input);
  if (status == CONIC_OK)
    status = conic_input_line(input, text, length);
  while (status == CONIC_OK && *length > 0 && is_blank((*text)[*length - 1]))
    --*length;
  return status;
}

conic_status conic_input_numbers(conic_input *input, double *numbers, int room, int *n) {
  for (*n = 0;;) {
    const char *word;
    size_t length;
    double value;
    conic_status status = conic_input_word(input, &word, &length);
    if (status != CONIC_OK)
      return status;
    if (length == 0 || word[0] == '#')
      return CONIC_OK;
    if (conic_number_parse(word, length, &value) != length)
      return conic_input_wrong(input, "a value is not a number");
    if (*n == room)
      return conic_input_wrong(input, "too many values");
    numbers[(*n)++] = value;
  }
}

conic_status conic_input_wrong(const conic_input *input, const char *format, ...) {
  char what[1024];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(what, sizeof what, format, arguments);
  va_end(arguments);
  return conic_fail(input->context, CONIC_ERROR_INPUT, "%s: %s (line %llu)", input->name, what,
                    (unsigned long long)input->line);
}

size_t conic_input_beside(const conic_input *input, const char *file, size_t length, char *path, size_t room) {
  int folder = conic_disk_is_absolute(file) ? 0 : (int)(conic_file_name(input->name) - input->name);
  int n = snprintf(path, room, "%.*s%.*s", folder, input->name, (int)length, file);
  return n > 0 && (size_t)n < room ? (size_t)n : 0;
}

void conic_input_make_plain(char *name) {
  char *to = name;
  if (strncmp(name, "file://", 7) == 0)
    memmove(name, name + 7, strlen(name) - 6);
  for (const char *from = name; *from; from++, to++) {
    char digits[3] = {from[0] == '%' ? from[1] : '\0', from[0] == '%' && from[1] ? from[2] : '\0', '\0'}, *end;
    long code = strtol(digits, &end, 16);
    int is_code = end == digits + 2 && code > 0;
    *to = is_code ? (char)code : *from == '\\' ? '/' : *from;
    from += is_code ? 2 : 0;
  }
  *to = '\0';
}

static int is_beside(const conic_input *input, const char *name, char *path, size_t room) {
  return *name && conic_input_beside(input, name, strlen(name), path, room) && conic_file_is_there(path);
}

int conic_input_find(const conic_input *input, const char *name, size_t length, char *path, size_t room) {
  char plain[CONIC_INPUT_LONGEST_WORD + 1];
  snprintf(plain, sizeof plain, "%.*s", (int)length, name);
  if (is_beside(input, plain, path, room))
    return 1;
  conic_input_make_plain(plain);
  const char *slash = strrchr(plain, '/');
  if (is_beside(input, plain, path, room) || (slash && is_beside(input, slash + 1, path, room)))
    return 1;
  conic_input_beside(input, name, length, path, room);
  return 0;
}

conic_status conic_input_next_line(conic_input *input, int *is_done) {
  *is_done = 0;
  for (;;) {
    conic_status status = conic_input_fill(input, 1);
    if (status != CONIC_OK)
      return status;
    size_t available = conic_input_available(input);
    const unsigned char *bytes = conic_input_bytes(input), *line_end = memchr(bytes, '\n', available);
    if (line_end) {
      input->next += (size_t)(line_end - bytes) + 1;
      input->line++;
      return CONIC_OK;
    }
    input->next = input->filled;
    if (available == 0) {
      *is_done = 1;
      return CONIC_OK;
    }
  }
}

int conic_input_is(const char *word, size_t length, const char *keyword) {
  return length == strlen(keyword) && memcmp(word, keyword, length) == 0;
}

conic_status conic_input_read_statements(conic_input *input, const conic_input_statement *statements, size_t n,
                                         void *reader) {
  conic_status status = CONIC_OK;
  for (int is_done = 0; status == CONIC_OK && !is_done;) {
    const char *word;
    size_t length, i = 0;
    status = conic_input_word(input, &word, &length);
    while (status == CONIC_OK && i < n && !conic_input_is(word, length, statements[i].keyword))
      i++;
    if (status == CONIC_OK && i < n)
      status = statements[i].read(reader);
    if (status == CONIC_OK)
      status = conic_input_next_line(input, &is_done);
  }
  return status;
}
