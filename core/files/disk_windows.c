#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <io.h>
#include <string.h>
#include <unistd.h>
#include <wchar.h>
#include <windows.h>

#include "core/files/disk.h"

/* Longer names are refused. */
enum { LONGEST_PATH = 4096 };

enum { SHARED = FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE };

static void note_error(void) {
  static const struct {
    DWORD system;
    int number;
  } errors[] = {{ERROR_FILE_NOT_FOUND, ENOENT},
                {ERROR_PATH_NOT_FOUND, ENOENT},
                {ERROR_INVALID_NAME, ENOENT},
                {ERROR_BAD_NETPATH, ENOENT},
                {ERROR_BAD_PATHNAME, ENOENT},
                {ERROR_ACCESS_DENIED, EACCES},
                {ERROR_SHARING_VIOLATION, EACCES},
                {ERROR_USER_MAPPED_FILE, EACCES},
                {ERROR_WRITE_PROTECT, EROFS},
                {ERROR_FILE_EXISTS, EEXIST},
                {ERROR_ALREADY_EXISTS, EEXIST},
                {ERROR_DIRECTORY, ENOTDIR},
                {ERROR_DISK_FULL, ENOSPC},
                {ERROR_HANDLE_DISK_FULL, ENOSPC},
                {ERROR_NOT_ENOUGH_MEMORY, ENOMEM},
                {ERROR_OUTOFMEMORY, ENOMEM},
                {ERROR_COMMITMENT_LIMIT, ENOMEM},
                {ERROR_BROKEN_PIPE, EPIPE},
                {ERROR_NO_DATA, EPIPE},
                {ERROR_INVALID_FUNCTION, EISDIR},
                {ERROR_TOO_MANY_OPEN_FILES, EMFILE},
                {ERROR_INVALID_HANDLE, EBADF},
                {ERROR_NOT_SUPPORTED, EOPNOTSUPP},
                {ERROR_FILENAME_EXCED_RANGE, ENAMETOOLONG}};
  const DWORD error = GetLastError();
  errno = EIO;
  for (size_t i = 0; i < sizeof errors / sizeof *errors; i++)
    if (errors[i].system == error)
      errno = errors[i].number;
}

/* Whether a call has worked; errno says why not. */
static int noted(BOOL has_worked) {
  if (!has_worked)
    note_error();
  return has_worked != 0;
}

static int widen(const char *path, wchar_t wide[LONGEST_PATH]) {
  if (MultiByteToWideChar(CP_UTF8, MB_ERR_INVALID_CHARS, path, -1, wide, LONGEST_PATH) > 0)
    return 1;
  errno = GetLastError() == ERROR_INSUFFICIENT_BUFFER ? ENAMETOOLONG : ENOENT;
  return 0;
}

/* Opens folders, too, so that they can be told from files. */
static HANDLE open_handle(const char *path, DWORD access, DWORD how, DWORD flags) {
  wchar_t wide[LONGEST_PATH];
  if (!widen(path, wide))
    return INVALID_HANDLE_VALUE;
  HANDLE handle = CreateFileW(wide, access, SHARED, NULL, how, flags | FILE_FLAG_BACKUP_SEMANTICS, NULL);
  if (handle == INVALID_HANDLE_VALUE)
    note_error();
  return handle;
}

static int describe_entry(HANDLE handle, conic_disk_entry *entry) {
  BY_HANDLE_FILE_INFORMATION found;
  memset(entry, 0, sizeof *entry);
  entry->permissions = 0666;
  DWORD type = GetFileType(handle);
  if (type == FILE_TYPE_PIPE || type == FILE_TYPE_CHAR)
    return 1;
  if (!noted(GetFileInformationByHandle(handle, &found)))
    return 0;
  entry->is_folder = (found.dwFileAttributes & FILE_ATTRIBUTE_DIRECTORY) != 0;
  entry->is_file = !entry->is_folder;
  entry->n_bytes = (uint64_t)found.nFileSizeHigh << 32 | found.nFileSizeLow;
  entry->device = found.dwVolumeSerialNumber;
  entry->number = (uint64_t)found.nFileIndexHigh << 32 | found.nFileIndexLow;
  uint64_t ticks = (uint64_t)found.ftLastWriteTime.dwHighDateTime << 32 | found.ftLastWriteTime.dwLowDateTime;
  entry->modified_seconds = (int64_t)(ticks / 10000000) - INT64_C(11644473600); /* from 1601 to 1970 */
  return 1;
}

static HANDLE handle_of(int descriptor) {
  return (HANDLE)_get_osfhandle(descriptor);
}

static int descriptor_of(HANDLE handle, int flags) {
  if (handle == INVALID_HANDLE_VALUE)
    return -1;
  int descriptor = _open_osfhandle((intptr_t)handle, flags | _O_BINARY | _O_NOINHERIT);
  if (descriptor < 0)
    CloseHandle(handle);
  return descriptor;
}

int conic_disk_look(const char *path, conic_disk_entry *entry) {
  HANDLE handle = open_handle(path, 0, OPEN_EXISTING, 0);
  if (handle == INVALID_HANDLE_VALUE)
    return 0;
  int is_there = describe_entry(handle, entry);
  CloseHandle(handle);
  return is_there;
}

int conic_disk_look_at(int descriptor, conic_disk_entry *entry) {
  return describe_entry(handle_of(descriptor), entry);
}

int conic_disk_can_read(const char *path) {
  HANDLE handle = open_handle(path, GENERIC_READ, OPEN_EXISTING, 0);
  if (handle == INVALID_HANDLE_VALUE)
    return 0;
  CloseHandle(handle);
  return 1;
}

int conic_disk_can_write_in(const char *folder) {
  conic_disk_entry entry;
  if (!conic_disk_look(folder, &entry))
    return 0;
  if (!entry.is_folder)
    errno = ENOTDIR;
  return entry.is_folder;
}

FILE *conic_disk_open_stream(const char *path, const char *mode) {
  HANDLE handle = mode[0] == 'r' ? open_handle(path, GENERIC_READ, OPEN_EXISTING, 0)
                                 : open_handle(path, GENERIC_WRITE, CREATE_ALWAYS, 0);
  int descriptor = descriptor_of(handle, mode[0] == 'r' ? _O_RDONLY : _O_WRONLY);
  FILE *stream = descriptor >= 0 ? fdopen(descriptor, mode[0] == 'r' ? "rb" : "wb") : NULL;
  if (!stream && descriptor >= 0)
    close(descriptor);
  return stream;
}

int conic_disk_open(const char *path) {
  return descriptor_of(open_handle(path, GENERIC_READ, OPEN_EXISTING, 0), _O_RDONLY);
}

int conic_disk_create(const char *path) {
  return descriptor_of(open_handle(path, GENERIC_WRITE | DELETE, CREATE_NEW, 0), _O_WRONLY);
}

int conic_disk_open_to_change(const char *path) {
  return descriptor_of(open_handle(path, GENERIC_READ | GENERIC_WRITE | DELETE, OPEN_ALWAYS, 0), _O_RDWR);
}

int conic_disk_create_nameless(char *pattern) {
  static const char letters[] = "0123456789abcdefghijklmnopqrstuvwxyz";
  LARGE_INTEGER ticks;
  char *end = pattern + strlen(pattern) - 6;
  QueryPerformanceCounter(&ticks);
  uint64_t number = (uint64_t)ticks.QuadPart * 7919 + GetCurrentThreadId();
  for (int attempt = 0; attempt < 100; attempt++, number += 104729) {
    for (uint64_t i = 0, rest = number; i < 6; i++, rest /= 36)
      end[i] = letters[rest % 36];
    HANDLE handle = open_handle(pattern, GENERIC_READ | GENERIC_WRITE | DELETE, CREATE_NEW,
                                FILE_ATTRIBUTE_TEMPORARY | FILE_FLAG_DELETE_ON_CLOSE);
    if (handle != INVALID_HANDLE_VALUE)
      return descriptor_of(handle, _O_RDWR);
    if (errno != EEXIST)
      break;
  }
  return -1;
}

FILE *conic_disk_open_nameless(void) {
  wchar_t folder[MAX_PATH + 1];
  char pattern[4 * MAX_PATH + 32];
  DWORD n = GetTempPathW(MAX_PATH + 1, folder);
  if (!n || n > MAX_PATH ||
      !WideCharToMultiByte(CP_UTF8, 0, folder, -1, pattern, (int)(sizeof pattern - 32), NULL, NULL)) {
    errno = ENOENT;
    return NULL;
  }
  int descriptor = conic_disk_create_nameless(strcat(pattern, ".conic-XXXXXX"));
  FILE *stream = descriptor >= 0 ? fdopen(descriptor, "w+b") : NULL;
  if (!stream && descriptor >= 0)
    close(descriptor);
  return stream;
}

/* Permissions here are a list, which a new file has from its folder. */
void conic_disk_permit(int descriptor, unsigned permissions) {
  (void)descriptor, (void)permissions;
}

enum { MOST_AT_ONCE = 1 << 30 };

static DWORD at_once(size_t n_bytes) {
  return n_bytes < MOST_AT_ONCE ? (DWORD)n_bytes : MOST_AT_ONCE;
}

static OVERLAPPED place(uint64_t at) {
  OVERLAPPED place = {.Offset = (DWORD)(at & 0xFFFFFFFF), .OffsetHigh = (DWORD)(at >> 32)};
  return place;
}

/* Not by _read, which would convert standard input as text. */
static ptrdiff_t read_some(int descriptor, void *bytes, size_t n_bytes, OVERLAPPED *at) {
  DWORD n = 0;
  if (ReadFile(handle_of(descriptor), bytes, at_once(n_bytes), &n, at) || GetLastError() == ERROR_HANDLE_EOF ||
      GetLastError() == ERROR_BROKEN_PIPE)
    return (ptrdiff_t)n;
  note_error();
  return -1;
}

ptrdiff_t conic_disk_read(int descriptor, void *bytes, size_t n_bytes) {
  return read_some(descriptor, bytes, n_bytes, NULL);
}

ptrdiff_t conic_disk_read_at(int descriptor, void *bytes, size_t n_bytes, uint64_t at) {
  OVERLAPPED from = place(at);
  const int64_t before = conic_disk_position(descriptor);
  ptrdiff_t n = read_some(descriptor, bytes, n_bytes, &from);
  SetFilePointerEx(handle_of(descriptor), (LARGE_INTEGER){.QuadPart = before}, NULL, FILE_BEGIN); /* reading moved it */
  return n;
}

ptrdiff_t conic_disk_write_at(int descriptor, const void *bytes, size_t n_bytes, uint64_t at) {
  OVERLAPPED to = place(at);
  const int64_t before = conic_disk_position(descriptor);
  DWORD n = 0;
  if (WriteFile(handle_of(descriptor), bytes, at_once(n_bytes), &n, &to)) {
    SetFilePointerEx(handle_of(descriptor), (LARGE_INTEGER){.QuadPart = before}, NULL, FILE_BEGIN);
    return (ptrdiff_t)n;
  }
  note_error();
  return -1;
}

int conic_disk_cut(int descriptor, uint64_t n_bytes) {
  errno = _chsize_s(descriptor, (int64_t)n_bytes);
  return errno == 0;
}

int64_t conic_disk_position(int descriptor) {
  LARGE_INTEGER none = {.QuadPart = 0}, here;
  HANDLE handle = handle_of(descriptor);
  return GetFileType(handle) == FILE_TYPE_DISK && SetFilePointerEx(handle, none, &here, FILE_CURRENT) ? here.QuadPart
                                                                                                      : -1;
}

void *conic_disk_map(int descriptor, size_t n_bytes) {
  HANDLE mapping = CreateFileMappingW(handle_of(descriptor), NULL, PAGE_READONLY, 0, 0, NULL);
  void *bytes = mapping ? MapViewOfFile(mapping, FILE_MAP_READ, 0, 0, n_bytes) : NULL;
  if (!bytes)
    note_error();
  if (mapping)
    CloseHandle(mapping);
  return bytes;
}

void conic_disk_unmap(void *bytes, size_t n_bytes) {
  (void)n_bytes;
  UnmapViewOfFile(bytes);
}

void conic_disk_give_back(void *bytes, size_t n_bytes) {
  VirtualUnlock(bytes, n_bytes); /* fails, as the pages are not locked, but gives them back */
}

int conic_disk_rename(const char *from, const char *to) {
  wchar_t wide_from[LONGEST_PATH], wide_to[LONGEST_PATH];
  return widen(from, wide_from) && widen(to, wide_to) &&
         noted(MoveFileExW(wide_from, wide_to, MOVEFILE_REPLACE_EXISTING));
}

int conic_disk_remove(const char *path) {
  wchar_t wide[LONGEST_PATH];
  return widen(path, wide) && noted(DeleteFileW(wide));
}

int conic_disk_remove_folder(const char *path) {
  wchar_t wide[LONGEST_PATH];
  return widen(path, wide) && noted(RemoveDirectoryW(wide));
}

int conic_disk_make_folder(const char *path) {
  wchar_t wide[LONGEST_PATH];
  return widen(path, wide) && noted(CreateDirectoryW(wide, NULL));
}

/* Follows the link to its end. */
size_t conic_disk_read_link(const char *path, char *target, size_t room) {
  wchar_t wide[LONGEST_PATH];
  DWORD attributes = widen(path, wide) ? GetFileAttributesW(wide) : INVALID_FILE_ATTRIBUTES;
  if (attributes == INVALID_FILE_ATTRIBUTES || !(attributes & FILE_ATTRIBUTE_REPARSE_POINT))
    return 0;
  HANDLE handle = open_handle(path, 0, OPEN_EXISTING, 0);
  DWORD length = handle == INVALID_HANDLE_VALUE ? 0 : GetFinalPathNameByHandleW(handle, wide, LONGEST_PATH, 0);
  if (handle != INVALID_HANDLE_VALUE)
    CloseHandle(handle);
  if (!length || length >= LONGEST_PATH || room < 2)
    return 0;
  int n = WideCharToMultiByte(CP_UTF8, 0, wide, (int)length, target, (int)room - 1, NULL, NULL);
  return n > 0 ? (size_t)n : 0;
}

int conic_disk_is_separator(char c) {
  return c == '/' || c == '\\' || c == ':';
}

int conic_disk_is_absolute(const char *path) {
  return path[0] == '/' || path[0] == '\\' || (path[0] && path[1] == ':');
}

int conic_disk_open_folder(const char *path, conic_disk_folder *folder) {
  wchar_t wide[LONGEST_PATH];
  folder->listing = widen(path, wide) ? _wopendir(wide) : NULL;
  return folder->listing != NULL;
}

const char *conic_disk_next_name(conic_disk_folder *folder) {
  for (const struct _wdirent *entry; folder->listing && (entry = _wreaddir(folder->listing));)
    if (WideCharToMultiByte(CP_UTF8, 0, entry->d_name, -1, folder->name, sizeof folder->name, NULL, NULL))
      return folder->name;
  return NULL;
}

void conic_disk_close_folder(conic_disk_folder *folder) {
  if (folder->listing)
    _wclosedir(folder->listing);
  folder->listing = NULL;
}

int conic_disk_is_writer_gone(long process) {
  HANDLE handle = OpenProcess(PROCESS_QUERY_LIMITED_INFORMATION, FALSE, (DWORD)process);
  if (!handle)
    return GetLastError() == ERROR_INVALID_PARAMETER;
  DWORD code;
  int is_gone = GetExitCodeProcess(handle, &code) && code != STILL_ACTIVE;
  CloseHandle(handle);
  return is_gone;
}
