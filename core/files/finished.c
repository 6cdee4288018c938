#include "core/files/finished.h"

#include "core/files/disk.h"

enum { N_DIGITS = CONIC_SHA256_ROOM - 1, MOST_BYTES = 1 << 30 };

/* --- lines --- */

/* Reads digits from *text and moves it past them; 0 where there are none or the number is too large. */
static int take_digits(const char **text, const char *end, uint64_t *number) {
  const char *c = *text;
  for (*number = 0; c < end && *c >= '0' && *c <= '9' && *number < UINT64_MAX / 10; c++)
    *number = 10 * *number + (uint64_t)(*c - '0');
  int is_one = c > *text;
  *text = c;
  return is_one;
}

static int begins_with(const char *line, const char *end, const char *word) {
  size_t n = strlen(word);
  return (size_t)(end - line) > n && memcmp(line, word, n) == 0;
}

/* "file SHA256 BYTES NAME" */
static int parse_file(const char *line, const char *end, conic_finished_file *file) {
  const char *c = line + 5;
  if (!begins_with(line, end, "file ") || end - c < N_DIGITS + 4)
    return 0;
  file->hash = c;
  for (int i = 0; i < N_DIGITS; i++, c++)
    if (!strchr("0123456789abcdef", *c) || !*c)
      return 0;
  if (*c++ != ' ' || !take_digits(&c, end, &file->n_bytes) || c + 1 >= end || *c++ != ' ')
    return 0;
  file->name = c;
  file->n_name = (size_t)(end - c);
  return memchr(c, '\0', file->n_name) == NULL;
}

int conic_finished_next_file(const conic_finished *list, size_t *at, conic_finished_file *file) {
  const char *line = list->text + *at, *end = memchr(line, '\n', list->n_bytes - *at);
  if (!end || !parse_file(line, end, file))
    return 0;
  *at = (size_t)(end + 1 - list->text);
  return 1;
}

int conic_finished_next(const conic_finished *list, size_t *at, conic_finished_part *part) {
  conic_finished_file file;
  const char *end;
  for (int has_files = 0; *at < list->n_bytes; *at = (size_t)(end + 1 - list->text)) {
    const char *line = list->text + *at;
    end = memchr(line, '\n', list->n_bytes - *at);
    if (!end)
      return 0;
    if (parse_file(line, end, &file)) {
      part->files_at = has_files ? part->files_at : *at;
      has_files = 1;
    } else if (has_files) {
      part->words = line;
      part->n_words = (size_t)(end - line);
      *at += part->n_words + 1;
      return 1;
    }
  }
  return 0;
}

int conic_finished_numbers(const conic_finished_part *part, const char *word, uint64_t *numbers, int n_numbers) {
  const char *c = part->words + strlen(word), *end = part->words + part->n_words;
  int is_it = begins_with(part->words, end, word);
  for (int i = 0; i < n_numbers && is_it; i++)
    is_it = c < end && *c++ == ' ' && take_digits(&c, end, &numbers[i]);
  return is_it && c == end;
}

/* --- the whole --- */

void conic_finished_release(conic_context *context, conic_finished *list) {
  conic_memory_release(context, list->text);
  memset(list, 0, sizeof *list);
}

void conic_finished_write_head(FILE *stream, const char *what, const char *key) {
  fprintf(stream, "conic %s 1\nkey %s\n", what, key);
}

void conic_finished_write_part(FILE *stream, const conic_finished *list, const conic_finished_part *part) {
  const char *begin = list->text + part->files_at;
  fwrite(begin, 1, (size_t)(part->words - begin) + part->n_words + 1, stream);
}

size_t conic_finished_file_head(const char *hash, uint64_t n_bytes, char head[CONIC_FINISHED_HEAD_ROOM]) {
  return (size_t)snprintf(head, CONIC_FINISHED_HEAD_ROOM, "file %s %llu ", hash, (unsigned long long)n_bytes);
}

static conic_status check_head(conic_context *context, const char *path, const char *what, const char *key,
                               const conic_finished *list) {
  char first[64];
  size_t n = (size_t)snprintf(first, sizeof first, "conic %s 1\nkey ", what);
  if (list->n_bytes < n + N_DIGITS + 1 || memcmp(list->text, first, n) != 0)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: cannot go on: it is no list of finished %s", path, what);
  if (memcmp(list->text + n, key, N_DIGITS) != 0)
    return conic_fail(context, CONIC_ERROR_INPUT,
                      "%s: cannot go on: it was begun with other inputs or options, or by another version", path);
  return CONIC_OK;
}

conic_status conic_finished_read(conic_context *context, const char *path, const char *what, const char *key,
                                 conic_finished *list) {
  conic_disk_entry entry = {0};
  memset(list, 0, sizeof *list);
  FILE *stream = conic_disk_open_stream(path, "rb");
  if (!stream || !conic_disk_look_at(fileno(stream), &entry) || !entry.is_file || entry.n_bytes > MOST_BYTES) {
    conic_fail(context, CONIC_ERROR_INPUT, "%s: cannot read: %s", path,
               stream ? "it is no such file" : strerror(errno));
    if (stream)
      fclose(stream);
    return CONIC_ERROR_INPUT;
  }
  list->text = conic_memory_allocate(context, (size_t)entry.n_bytes + 1, 1);
  list->n_bytes = list->text ? fread(list->text, 1, (size_t)entry.n_bytes, stream) : 0;
  fclose(stream);
  return list->text ? check_head(context, path, what, key, list) : CONIC_ERROR_MEMORY;
}

/* --- files --- */

conic_status conic_file_hash(const char *path, uint64_t *n_bytes, char hash[CONIC_SHA256_ROOM]) {
  char bytes[1 << 16];
  conic_sha256 sum;
  FILE *stream = conic_disk_open_stream(path, "rb");
  if (!stream)
    return CONIC_ERROR_IO;
  conic_sha256_begin(&sum);
  for (size_t n; (n = fread(bytes, 1, sizeof bytes, stream)) > 0;)
    conic_sha256_add(&sum, bytes, n);
  int is_read = !ferror(stream);
  fclose(stream);
  *n_bytes = sum.n_bytes;
  conic_sha256_end(&sum, hash);
  return is_read ? CONIC_OK : CONIC_ERROR_IO;
}

int conic_finished_is_there(const char *folder, const conic_finished_file *file) {
  char path[4096], hash[CONIC_SHA256_ROOM];
  size_t n_folder = strlen(folder);
  conic_disk_entry entry;
  uint64_t n_bytes;
  if (file->n_name + n_folder >= sizeof path)
    return 0;
  memcpy(path, folder, n_folder);
  memcpy(path + n_folder, file->name, file->n_name);
  path[n_folder + file->n_name] = '\0';
  return conic_disk_look(path, &entry) && entry.is_file && entry.n_bytes == file->n_bytes &&
         conic_file_hash(path, &n_bytes, hash) == CONIC_OK && n_bytes == file->n_bytes &&
         memcmp(hash, file->hash, CONIC_SHA256_ROOM - 1) == 0;
}
