/* The system's files, where systems differ: disk_posix.c and disk_windows.c. Names are UTF-8 everywhere, and files may
 * exceed 2 GiB. A failing function says why in errno. Descriptors are the C library's, for close and fileno; programs
 * that are started do not inherit them, and bytes are never converted as text. */
#pragma once

#include "core/base/base.h"

typedef struct conic_disk_entry {
  int is_file, is_folder; /* neither: a device, a pipe … */
  unsigned permissions;
  uint64_t n_bytes;
  uint64_t device, number;  /* equal for two names of the same file */
  int64_t modified_seconds; /* since 1970 */
} conic_disk_entry;

/* Looks at what a name leads to, or a descriptor stands for; returns 0 where nothing is there. */
int conic_disk_look(const char *path, conic_disk_entry *entry);
int conic_disk_look_at(int descriptor, conic_disk_entry *entry);

/* Whether this program may. A folder that can be written can be entered, too. */
int conic_disk_can_read(const char *path);
int conic_disk_can_write_in(const char *folder);

/* As fopen. */
FILE *conic_disk_open_stream(const char *path, const char *mode);

/* Descriptors, below 0 on failure: to read; to write a new file; to read and write a file that may exist; and to write
 * and read a file without a name, or one that loses its name when it is closed in any way. `pattern` says where, and
 * ends in XXXXXX, which change. */
int conic_disk_open(const char *path);
int conic_disk_create(const char *path);
int conic_disk_open_to_change(const char *path);
int conic_disk_create_nameless(char *pattern);
/* A stream of a file without a name, in the folder for temporary files. */
FILE *conic_disk_open_nameless(void);
/* Sets the permissions, where the disk has any. */
void conic_disk_permit(int descriptor, unsigned permissions);

/* As read, pread and pwrite: the number of bytes may be less than asked for, 0 at the end, and below 0 on errors. The
 * last two do not move the place where reading goes on. */
ptrdiff_t conic_disk_read(int descriptor, void *bytes, size_t n_bytes);
ptrdiff_t conic_disk_read_at(int descriptor, void *bytes, size_t n_bytes, uint64_t at);
ptrdiff_t conic_disk_write_at(int descriptor, const void *bytes, size_t n_bytes, uint64_t at);
/* Ends a file after so many bytes; 0 on failure. */
int conic_disk_cut(int descriptor, uint64_t n_bytes);
/* Where reading goes on; below 0 for a pipe. */
int64_t conic_disk_position(int descriptor);

/* Maps a whole file that is not empty, for reading; null on failure. Pages that are given back are read again from the
 * file when needed. */
void *conic_disk_map(int descriptor, size_t n_bytes);
void conic_disk_unmap(void *bytes, size_t n_bytes);
void conic_disk_give_back(void *bytes, size_t n_bytes);

/* These return 0 on failure. Renaming replaces the file that has the name. An open file can be removed, too. */
int conic_disk_rename(const char *from, const char *to);
int conic_disk_remove(const char *path);
int conic_disk_make_folder(const char *path);
int conic_disk_remove_folder(const char *path); /* it must be empty */

/* The target of a symbolic link, without a terminating zero; returns its length, or 0: it is no link, or the room is
 * too small. */
size_t conic_disk_read_link(const char *path, char *target, size_t room);

/* Whether a character separates folders from names, and whether a name begins at a root. */
int conic_disk_is_separator(char c);
int conic_disk_is_absolute(const char *path);

/* Names in a folder, in any order, with "." and "..". */
typedef struct conic_disk_folder {
  void *listing;   /* null: the folder cannot be read */
  char name[1024]; /* the last one */
} conic_disk_folder;

int conic_disk_open_folder(const char *path, conic_disk_folder *folder);
/* Valid until the next call; null after the last. */
const char *conic_disk_next_name(conic_disk_folder *folder);
/* Also for a folder that could not be opened. */
void conic_disk_close_folder(conic_disk_folder *folder);

/* Whether the process of that number has surely ended. */
int conic_disk_is_writer_gone(long process);
