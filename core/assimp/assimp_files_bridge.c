#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/assimp/assimp_writer_bridge.h"

enum { MOST_SIDE_BYTES = 0x7FFFFFFF };

/* A file in memory that is read from `at` on. */
typedef struct memory_file {
  struct aiFile base;
  const unsigned char *bytes;
  unsigned char *own_bytes; /* null for the model itself */
  size_t n_bytes, at;
} memory_file;

void conic_assimp_send_bytes(conic_assimp_writer *w, const void *bytes, size_t n_bytes) {
  for (size_t done = 0; done < n_bytes && !w->is_failed;) {
    ssize_t n = write(w->request->descriptor, (const char *)bytes + done, n_bytes - done);
    if (n < 0 && errno == EINTR)
      continue;
    w->is_failed = n <= 0;
    done += n > 0 ? (size_t)n : 0;
  }
}

void conic_assimp_send(conic_assimp_writer *w, conic_assimp_record record, const void *bytes, size_t n_bytes) {
  record.n_bytes = n_bytes;
  conic_assimp_send_bytes(w, &record, sizeof record);
  conic_assimp_send_bytes(w, bytes, n_bytes);
}

void conic_assimp_send_failure(conic_assimp_writer *w, const char *why) {
  conic_assimp_send(w, (conic_assimp_record){.type = CONIC_ASSIMP_FAILED}, why, strlen(why));
  w->is_failed = 1;
}

static memory_file *file_of(struct aiFile *base) {
  return (memory_file *)base->UserData;
}

static size_t read_items(struct aiFile *base, char *to, size_t size, size_t count) {
  memory_file *file = file_of(base);
  size_t n = size ? (file->n_bytes - file->at) / size : 0;
  n = n < count ? n : count;
  memcpy(to, file->bytes + file->at, n * size);
  file->at += n * size;
  return n;
}

static size_t tell_place(struct aiFile *base) {
  return file_of(base)->at;
}

static size_t tell_size(struct aiFile *base) {
  return file_of(base)->n_bytes;
}

static enum aiReturn seek(struct aiFile *base, size_t offset, enum aiOrigin origin) {
  memory_file *file = file_of(base);
  size_t from = origin == aiOrigin_SET ? 0 : origin == aiOrigin_CUR ? file->at : file->n_bytes;
  size_t to = from + offset; /* an offset may be negative */
  if (to > file->n_bytes)
    return aiReturn_FAILURE;
  file->at = to;
  return aiReturn_SUCCESS;
}

static size_t write_nothing(struct aiFile *base, const char *from, size_t size, size_t count) {
  (void)base, (void)from, (void)size, (void)count;
  return 0;
}

static void flush_memory_file(struct aiFile *base) {
  (void)base;
}

/* Whether a name stays in the model's folder. */
static int is_below(const char *name) {
  if (name[0] == '/' || name[0] == '\0')
    return 0;
  for (const char *c = name; c; c = strchr(c, '/')) {
    c += *c == '/';
    if (strncmp(c, "..", 2) == 0 && (c[2] == '/' || c[2] == '\0'))
      return 0;
  }
  return 1;
}

static unsigned char *read_side_file(const char *path, size_t *n_bytes) {
  struct stat about;
  unsigned char *bytes = NULL;
  int descriptor = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0)
    return NULL;
  if (fstat(descriptor, &about) == 0 && S_ISREG(about.st_mode) && about.st_size <= MOST_SIDE_BYTES)
    bytes = malloc((size_t)about.st_size + 1);
  for (*n_bytes = 0; bytes && *n_bytes < (size_t)about.st_size;) {
    ssize_t n = read(descriptor, bytes + *n_bytes, (size_t)about.st_size - *n_bytes);
    if (n <= 0)
      break;
    *n_bytes += (size_t)n;
  }
  close(descriptor);
  return bytes;
}

/* A file beside the model; null where there is none that may be read. */
static unsigned char *read_beside(conic_assimp_writer *w, const char *name, size_t *n_bytes) {
  char path[4096];
  int n = snprintf(path, sizeof path, "%.*s%s", (int)w->request->folder_length, w->request->folder, name);
  if (!is_below(name) || n < 0 || (size_t)n >= sizeof path)
    return NULL;
  unsigned char *bytes = read_side_file(path, n_bytes);
  if (bytes)
    conic_assimp_send(w, (conic_assimp_record){.type = CONIC_ASSIMP_OPENED}, path, (size_t)n);
  return bytes;
}

static struct aiFile *open_memory_file(struct aiFileIO *io, const char *name, const char *mode) {
  conic_assimp_writer *w = (conic_assimp_writer *)io->UserData;
  if (strchr(mode, 'w') || strchr(mode, 'a') || strchr(mode, '+'))
    return NULL;
  memory_file *file = calloc(1, sizeof *file);
  if (!file)
    return NULL;
  while (strncmp(name, "./", 2) == 0)
    name += 2;
  if (strcmp(name, w->request->name) == 0) {
    file->bytes = w->request->bytes;
    file->n_bytes = w->request->n_bytes;
  } else
    file->bytes = file->own_bytes = read_beside(w, name, &file->n_bytes);
  if (!file->bytes) {
    free(file);
    return NULL;
  }
  file->base = (struct aiFile){read_items, write_nothing, tell_place, tell_size, seek, flush_memory_file, (char *)file};
  return &file->base;
}

static void close_memory_file(struct aiFileIO *io, struct aiFile *base) {
  (void)io;
  free(file_of(base)->own_bytes);
  free(file_of(base));
}

struct aiFileIO conic_assimp_files(conic_assimp_writer *w) {
  return (struct aiFileIO){open_memory_file, close_memory_file, (char *)w};
}
