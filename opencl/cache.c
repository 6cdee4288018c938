#include "opencl/cache.h"

#include <sys/stat.h>
#include <unistd.h>

#include "core/image/image_common.h"

/* What a file begins with. */
typedef struct cache_head {
  char magic[8];
  uint64_t n_bytes, hash;
} cache_head;

static const char magic[8] = {'c', 'o', 'n', 'i', 'c', 'C', 'L', '1'};

void conic_cache_path(const char *folder, const char *name, uint64_t hash, char *path, size_t room) {
  int n = snprintf(path, room, "%s/%s-%016llx.bin", folder, name, (unsigned long long)hash);
  if (n < 0 || (size_t)n >= room)
    path[0] = 0;
}

static int read_whole_entry(conic_context *context, FILE *file, unsigned char **bytes, size_t *n_bytes) {
  struct stat about;
  cache_head head;
  if (fstat(fileno(file), &about) != 0 || fread(&head, sizeof head, 1, file) != 1 ||
      memcmp(head.magic, magic, sizeof magic) != 0 || about.st_size < (off_t)sizeof head ||
      head.n_bytes != (uint64_t)about.st_size - sizeof head)
    return 0;
  *bytes = conic_memory_allocate(context, (size_t)head.n_bytes, 1);
  *n_bytes = (size_t)head.n_bytes;
  if (*bytes && fread(*bytes, 1, *n_bytes, file) == *n_bytes && conic_hash_bytes(*bytes, *n_bytes) == head.hash)
    return 1;
  conic_memory_release(context, *bytes);
  return 0;
}

int conic_cache_read(conic_context *context, const char *path, unsigned char **bytes, size_t *n_bytes) {
  FILE *file = fopen(path, "rbe");
  if (!file)
    return 0;
  int is_read = read_whole_entry(context, file, bytes, n_bytes);
  fclose(file);
  return is_read;
}

/* The folders above a file. */
static void make_folders(const char *path) {
  char folder[4096];
  for (size_t i = 1; path[i] && i < sizeof folder; i++)
    if (path[i] == '/') {
      memcpy(folder, path, i);
      folder[i] = 0;
      mkdir(folder, 0700);
    }
}

static int write_whole(const char *path, const cache_head *head, const unsigned char *bytes, size_t n_bytes) {
  FILE *file = fopen(path, "wbxe");
  if (!file)
    return 0;
  int is_written = fwrite(head, sizeof *head, 1, file) == 1 && fwrite(bytes, 1, n_bytes, file) == n_bytes;
  is_written &= fclose(file) == 0;
  if (!is_written)
    remove(path);
  return is_written;
}

void conic_cache_write(conic_context *context, const char *path, const unsigned char *bytes, size_t n_bytes) {
  char temporary[4200];
  cache_head head = {.n_bytes = n_bytes, .hash = conic_hash_bytes(bytes, n_bytes)};
  memcpy(head.magic, magic, sizeof magic);
  make_folders(path);
  snprintf(temporary, sizeof temporary, "%s.%ld", path, (long)getpid());
  if (!write_whole(temporary, &head, bytes, n_bytes) || rename(temporary, path) != 0)
    conic_log(context, CONIC_LOG_INFO, "%s: the program is not kept: %s", path, strerror(errno));
}
