/* Hand-made files for the readers' tests: a temporary folder, and a context that keeps its last message. */
#pragma once

#include <stdarg.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/support/check.h"
#include "tests/support/folder.h"

static char files_folder[FOLDER_ROOM];
static char files_message[1024], files_warning[1024]; /* the last ones */
static int files_warnings;                            /* how many there were */

static inline void files_log(void *cookie, conic_log_level level, const char *message) {
  (void)cookie;
  if (level == CONIC_LOG_ERROR)
    snprintf(files_message, sizeof files_message, "%s", message);
  if (level == CONIC_LOG_WARNING) {
    snprintf(files_warning, sizeof files_warning, "%s", message);
    files_warnings++;
  }
}

static inline conic_context *files_context(void) {
  conic_context_options options;
  conic_context *context;
  conic_context_options_init(&options);
  options.log = files_log;
  options.threads = 1;
  folder_make(files_folder);
  if (conic_context_create(&options, &context) != CONIC_OK)
    exit(1);
  return context;
}

/* The path of NAME in the temporary folder. Four may be in use at a time. */
static inline const char *files_path(const char *name) {
  static char paths[4][FOLDER_ROOM + 96];
  static int i_path;
  char *path = paths[i_path++ & 3];
  snprintf(path, sizeof paths[0], "%s/%s", files_folder, name);
  return path;
}

static inline const char *files_write_bytes(const char *name, const void *bytes, size_t n) {
  const char *path = files_path(name);
  FILE *file = fopen(path, "wb");
  if (!file || fwrite(bytes, 1, n, file) != n || fclose(file) != 0)
    exit(1);
  return path;
}

static inline const char *files_write(const char *name, const char *text) {
  return files_write_bytes(name, text, strlen(text));
}

static inline void files_end(conic_context *context) {
  conic_context_destroy(context);
  CHECK(rmdir(files_folder) == 0); /* every test removes its files */
}

/* The call must have failed as INPUT with a message that has all of the texts (up to the null). */
static inline void files_check_failed(const char *what, conic_status status, ...) {
  va_list texts;
  va_start(texts, status);
  for (const char *text = va_arg(texts, const char *); text; text = va_arg(texts, const char *))
    if (status != CONIC_ERROR_INPUT || !strstr(files_message, text)) {
      fprintf(stderr, "%s: status %d, message '%s' lacks '%s'\n", what, (int)status, files_message, text);
      check_failures++;
    }
  va_end(texts);
  files_message[0] = 0;
}

/* Its bytes, which the caller frees, and how many; 0 and null: it is not there. */
static inline size_t files_read(const char *path, unsigned char **bytes) {
  FILE *file = fopen(path, "rb");
  *bytes = NULL;
  if (!file)
    return 0;
  fseek(file, 0, SEEK_END);
  size_t n = (size_t)ftell(file);
  rewind(file);
  *bytes = malloc(n + 1);
  if (!*bytes || fread(*bytes, 1, n, file) != n)
    exit(1);
  fclose(file);
  return n;
}
