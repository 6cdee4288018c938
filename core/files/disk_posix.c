#include <dirent.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/base/byte_order.h"
#include "core/files/disk.h"

static void describe_entry(const struct stat *found, conic_disk_entry *entry) {
  *entry = (conic_disk_entry){.is_file = S_ISREG(found->st_mode),
                              .is_folder = S_ISDIR(found->st_mode),
                              .permissions = found->st_mode & 0777,
                              .n_bytes = found->st_size > 0 ? (uint64_t)found->st_size : 0,
                              .device = (uint64_t)found->st_dev,
                              .number = (uint64_t)found->st_ino,
                              .modified_seconds = (int64_t)found->st_mtime};
}

int conic_disk_look(const char *path, conic_disk_entry *entry) {
  struct stat found;
  if (stat(path, &found) != 0)
    return 0;
  describe_entry(&found, entry);
  return 1;
}

int conic_disk_look_at(int descriptor, conic_disk_entry *entry) {
  struct stat found;
  if (fstat(descriptor, &found) != 0)
    return 0;
  describe_entry(&found, entry);
  return 1;
}

int conic_disk_can_read(const char *path) {
  return access(path, R_OK) == 0;
}

int conic_disk_can_write_in(const char *folder) {
  return access(folder, W_OK | X_OK) == 0;
}

FILE *conic_disk_open_stream(const char *path, const char *mode) {
  return fopen(path, mode);
}

int conic_disk_open(const char *path) {
  return open(path, O_RDONLY | O_CLOEXEC);
}

int conic_disk_create(const char *path) {
  return open(path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
}

int conic_disk_open_to_change(const char *path) {
  return open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0666);
}

/* Linux makes files that never had a name, so that nothing is left of a process that is killed at that moment. Disks
 * that cannot, and other systems, give them a name for a moment. */
static int create_unnamed(char *pattern) {
#ifdef O_TMPFILE
  char *name = strrchr(pattern, '/');
  const char first = name ? name[1] : 0;
  if (name)
    name[1] = 0;
  int descriptor = open(name ? pattern : ".", O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (name)
    name[1] = first;
  return descriptor;
#else
  (void)pattern;
  return -1;
#endif
}

int conic_disk_create_nameless(char *pattern) {
  int descriptor = create_unnamed(pattern);
  if (descriptor >= 0)
    return descriptor;
  descriptor = mkstemp(pattern);
  if (descriptor >= 0) {
    unlink(pattern);
    fcntl(descriptor, F_SETFD, FD_CLOEXEC);
  }
  return descriptor;
}

FILE *conic_disk_open_nameless(void) {
  return tmpfile();
}

void conic_disk_permit(int descriptor, unsigned permissions) {
  if (fchmod(descriptor, (mode_t)permissions) != 0)
    errno = 0;
}

ptrdiff_t conic_disk_read(int descriptor, void *bytes, size_t n_bytes) {
  return read(descriptor, bytes, n_bytes);
}

ptrdiff_t conic_disk_read_at(int descriptor, void *bytes, size_t n_bytes, uint64_t at) {
  return pread(descriptor, bytes, n_bytes, (off_t)at);
}

ptrdiff_t conic_disk_write_at(int descriptor, const void *bytes, size_t n_bytes, uint64_t at) {
  return pwrite(descriptor, bytes, n_bytes, (off_t)at);
}

int conic_disk_cut(int descriptor, uint64_t n_bytes) {
  return ftruncate(descriptor, (off_t)n_bytes) == 0;
}

int64_t conic_disk_position(int descriptor) {
  return lseek(descriptor, 0, SEEK_CUR);
}

void *conic_disk_map(int descriptor, size_t n_bytes) {
  const int access = PROT_READ | (CONIC_IS_BIG_ENDIAN ? PROT_WRITE : 0); /* records may be turned round in place */
  void *bytes = mmap(NULL, n_bytes, access, MAP_PRIVATE, descriptor, 0);
  return bytes == MAP_FAILED ? NULL : bytes;
}

void conic_disk_unmap(void *bytes, size_t n_bytes) {
  munmap(bytes, n_bytes);
}

void conic_disk_give_back(void *bytes, size_t n_bytes) {
  madvise(bytes, n_bytes, MADV_DONTNEED);
}

int conic_disk_rename(const char *from, const char *to) {
  return rename(from, to) == 0;
}

int conic_disk_remove(const char *path) {
  return unlink(path) == 0;
}

int conic_disk_make_folder(const char *path) {
  return mkdir(path, 0777) == 0;
}

int conic_disk_remove_folder(const char *path) {
  return rmdir(path) == 0;
}

size_t conic_disk_read_link(const char *path, char *target, size_t room) {
  ssize_t length = readlink(path, target, room);
  return length > 0 && (size_t)length < room ? (size_t)length : 0;
}

int conic_disk_is_separator(char c) {
  return c == '/';
}

int conic_disk_is_absolute(const char *path) {
  return path[0] == '/';
}

int conic_disk_open_folder(const char *path, conic_disk_folder *folder) {
  folder->listing = opendir(path);
  return folder->listing != NULL;
}

const char *conic_disk_next_name(conic_disk_folder *folder) {
  const struct dirent *entry = folder->listing ? readdir(folder->listing) : NULL;
  return entry ? entry->d_name : NULL;
}

void conic_disk_close_folder(conic_disk_folder *folder) {
  if (folder->listing)
    closedir(folder->listing);
  folder->listing = NULL;
}

int conic_disk_is_writer_gone(long process) {
  return kill((pid_t)process, 0) != 0 && errno == ESRCH;
}
