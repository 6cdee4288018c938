/* The system's files, where systems differ: disk_posix.c and disk_windows.c. Names are UTF-8 everywhere, and nothing
 * ends at 2 GiB. What fails says why in errno. Descriptors are the C library's, for close and fileno; they are not
 * handed on to programs that are started, and bytes are never taken for text. */
#ifndef CONIC_DISK_H
#define CONIC_DISK_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

typedef struct conic_disk_entry {
  int is_file, is_folder; /* neither: a device, a pipe … */
  unsigned permissions;
  uint64_t n_bytes;
  uint64_t device, number;  /* the same two: the same file, whatever its names */
  int64_t modified_seconds; /* since 1970 */
} conic_disk_entry;

/* What a name leads to, or a descriptor is of; 0: nothing that can be seen. */
int conic_disk_look(const char *path, conic_disk_entry *entry);
int conic_disk_look_at(int descriptor, conic_disk_entry *entry);

/* Whether this program may. Folders that can be written can be entered, too. */
int conic_disk_can_read(const char *path);
int conic_disk_can_write_in(const char *folder);

/* As fopen. */
FILE *conic_disk_open_stream(const char *path, const char *mode);

/* Descriptors, below 0 on failure: to read; to write a file that was not there; to read and write one that may be
 * there; and a file to write and read that has no name, or loses it when it is closed, however that comes. `pattern`
 * says where, and ends in XXXXXX, which change. */
int conic_disk_open(const char *path);
int conic_disk_create(const char *path);
int conic_disk_open_to_change(const char *path);
int conic_disk_create_nameless(char *pattern);
/* A stream of such a file, in the folder for temporary ones. */
FILE *conic_disk_open_nameless(void);
/* A disk without such is none the worse. */
void conic_disk_permit(int descriptor, unsigned permissions);

/* As read, pread and pwrite: fewer bytes than were asked for may come or go, none at the end, and below 0 is an error.
 * The last two leave alone where reading goes on. */
ptrdiff_t conic_disk_read(int descriptor, void *bytes, size_t n_bytes);
ptrdiff_t conic_disk_read_at(int descriptor, void *bytes, size_t n_bytes, uint64_t at);
ptrdiff_t conic_disk_write_at(int descriptor, const void *bytes, size_t n_bytes, uint64_t at);
/* Ends a file after so many bytes; 0 on failure. */
int conic_disk_cut(int descriptor, uint64_t n_bytes);
/* Where reading goes on; below 0: that can not be said of a pipe. */
int64_t conic_disk_position(int descriptor);

/* The whole of a file that is not empty, for reading; null on failure. Pages that are given back come again from the
 * file. */
void *conic_disk_map(int descriptor, size_t n_bytes);
void conic_disk_unmap(void *bytes, size_t n_bytes);
void conic_disk_give_back(void *bytes, size_t n_bytes);

/* 0 on failure. Renaming replaces what has the name. A file that is open can be removed, too. */
int conic_disk_rename(const char *from, const char *to);
int conic_disk_remove(const char *path);
int conic_disk_make_folder(const char *path);
int conic_disk_remove_folder(const char *path); /* which is empty */

/* Where a symbolic link leads, without a zero, and how long that is; 0: it is no link, or it leads too far. */
size_t conic_disk_read_link(const char *path, char *target, size_t room);

/* What stands between folders and names, and whether a name begins at a root, whatever folder the program is in. */
int conic_disk_is_separator(char c);
int conic_disk_is_absolute(const char *path);

/* Names in a folder, in any order, with "." and "..". */
typedef struct conic_disk_folder {
  void *listing;   /* null: it cannot be read */
  char name[1024]; /* the last one */
} conic_disk_folder;

int conic_disk_open_folder(const char *path, conic_disk_folder *folder);
/* Valid until the next call; null after the last. */
const char *conic_disk_next_name(conic_disk_folder *folder);
/* Fine where it was not opened. */
void conic_disk_close_folder(conic_disk_folder *folder);

/* Whether a process of that number is surely no more. */
int conic_disk_is_writer_gone(long process);

#endif
