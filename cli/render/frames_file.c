#include "cli/render/frames_file.h"

#include <errno.h>
#include <string.h>

#include "core/base/memory.h"
#include "core/base/message.h"
#include "core/files/disk.h"
#include "core/files/file.h"

enum { N_DIGITS = CONIC_SHA256_ROOM - 1, MOST_BYTES = 1 << 30 };

static const char first_line[] = "conic frames 1\nkey ";

/* --- lines --- */

/* From *text, past its end; 0 where there is none or it is past all bounds. */
static int take_digits(const char **text, const char *end, uint64_t *number) {
  const char *c = *text;
  for (*number = 0; c < end && *c >= '0' && *c <= '9' && *number < UINT64_C(1) << 60; c++)
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
static int parse_file(const char *line, const char *end, cli_finished_file *file) {
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

/* "frame NUMBER" */
static int parse_frame(const char *line, const char *end, int n_frames, int *i_frame) {
  const char *c = line + 6;
  uint64_t number;
  if (!begins_with(line, end, "frame ") || !take_digits(&c, end, &number) || c != end || number >= (uint64_t)n_frames)
    return 0;
  *i_frame = (int)number;
  return 1;
}

int cli_frames_file_next(const cli_frames_file *frames, size_t *at, cli_finished_file *file) {
  const char *line = frames->text + *at, *end = memchr(line, '\n', frames->n_bytes - *at);
  if (!end || !parse_file(line, end, file))
    return 0;
  *at = (size_t)(end + 1 - frames->text);
  return 1;
}

/* --- the whole --- */

static void find_frames(cli_frames_file *frames) {
  size_t begin = SIZE_MAX, at = 0;
  const char *end;
  for (int i = 0; i < frames->n_frames; i++)
    frames->begins[i] = SIZE_MAX;
  for (; at < frames->n_bytes && (end = memchr(frames->text + at, '\n', frames->n_bytes - at));
       at = (size_t)(end + 1 - frames->text)) {
    cli_finished_file file;
    int i_frame;
    if (parse_file(frames->text + at, end, &file))
      begin = begin == SIZE_MAX ? at : begin;
    else {
      if (begin != SIZE_MAX && parse_frame(frames->text + at, end, frames->n_frames, &i_frame))
        frames->begins[i_frame] = begin;
      begin = SIZE_MAX;
    }
  }
}

conic_status cli_frames_file_parse(conic_context *context, char *text, size_t n_bytes, int n_frames,
                                   cli_frames_file *frames) {
  *frames = (cli_frames_file){.text = text, .n_bytes = n_bytes, .n_frames = n_frames};
  frames->begins = conic_memory_allocate(context, (size_t)n_frames, sizeof *frames->begins);
  if (!frames->begins)
    return CONIC_ERROR_MEMORY;
  find_frames(frames);
  return CONIC_OK;
}

void cli_frames_file_release(conic_context *context, cli_frames_file *frames) {
  conic_memory_release(context, frames->text);
  conic_memory_release(context, frames->begins);
  memset(frames, 0, sizeof *frames);
}

static conic_status check_head(conic_context *context, const char *path, const char *key,
                               const cli_frames_file *frames) {
  size_t n = sizeof first_line - 1;
  if (frames->n_bytes < n + N_DIGITS + 1 || memcmp(frames->text, first_line, n) != 0)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: cannot go on: it is no list of finished frames", path);
  if (memcmp(frames->text + n, key, N_DIGITS) != 0)
    return conic_fail(context, CONIC_ERROR_INPUT,
                      "%s: cannot go on: it was begun with other inputs or options, or by another version", path);
  return CONIC_OK;
}

conic_status cli_frames_file_read(conic_context *context, const char *path, const char *key, int n_frames,
                                  cli_frames_file *frames) {
  conic_disk_entry entry = {0};
  memset(frames, 0, sizeof *frames);
  FILE *stream = conic_disk_open_stream(path, "rb");
  if (!stream || !conic_disk_look_at(fileno(stream), &entry) || !entry.is_file || entry.n_bytes > MOST_BYTES) {
    conic_fail(context, CONIC_ERROR_INPUT, "%s: cannot read: %s", path,
               stream ? "it is no such file" : strerror(errno));
    if (stream)
      fclose(stream);
    return CONIC_ERROR_INPUT;
  }
  char *text = conic_memory_allocate(context, (size_t)entry.n_bytes + 1, 1);
  size_t n_bytes = text ? fread(text, 1, (size_t)entry.n_bytes, stream) : 0;
  fclose(stream);
  conic_status status = text ? cli_frames_file_parse(context, text, n_bytes, n_frames, frames) : CONIC_ERROR_MEMORY;
  return status == CONIC_OK ? check_head(context, path, key, frames) : status;
}

conic_status cli_frames_file_write(conic_context *context, const char *path, const char *key,
                                   const cli_frames_file *frames) {
  conic_output *output;
  conic_status status = conic_output_open(context, path, &output);
  if (status != CONIC_OK)
    return status;
  FILE *stream = conic_output_stream(output);
  fprintf(stream, "%s%s\n", first_line, key); /* the stream remembers what fails, and commit says so */
  for (int i = 0; i < frames->n_frames; i++) {
    cli_finished_file file;
    size_t at = frames->begins[i], end = at;
    if (at == SIZE_MAX)
      continue;
    while (cli_frames_file_next(frames, &end, &file))
      ;
    fwrite(frames->text + at, 1, end - at, stream);
    fprintf(stream, "frame %d\n", i);
  }
  return conic_output_commit(output);
}

conic_status cli_file_hash(const char *path, uint64_t *n_bytes, char hash[CONIC_SHA256_ROOM]) {
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
