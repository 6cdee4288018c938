/* ZIP archives in memory: finding a file by its name; and writing an archive of files that are stored unpacked. */
#pragma once

#include "core/base/base.h"

typedef struct conic_zip {
  conic_context *context;
  const char *name; /* for messages */
  const unsigned char *bytes;
  size_t n_bytes, directory, n_entries; /* directory: where the list of its n_entries files begins */
} conic_zip;

/* Finds the list at the archive's end; `bytes` must outlive *zip. Errors: INPUT. */
conic_status conic_zip_open(conic_context *context, const char *name, const unsigned char *bytes, size_t n_bytes,
                            conic_zip *zip);

enum { CONIC_ZIP_NAME = 128, CONIC_ZIP_MOST_FILES = 64 };

/* Copies the name of the file at *at of the list, and moves *at to the next; 0: there is none. It begins at 0. A longer
 * name is cut off. */
int conic_zip_next(const conic_zip *zip, size_t *at, char name[CONIC_ZIP_NAME]);

/* Whether the archive has a file of that name, in any folder. */
int conic_zip_has(const conic_zip *zip, const char *file);

/* Its contents, with their sum checked, in a block that the caller releases; at most `most_bytes`. Errors: INPUT,
 * MEMORY, UNSUPPORTED (it is deflated, and zlib is not there). */
conic_status conic_zip_read(const conic_zip *zip, const char *file, size_t most_bytes, unsigned char **contents,
                            size_t *n_contents);

/* The CRC-32 of ZIP, gzip and PNG. */
uint32_t conic_zip_sum(const unsigned char *bytes, size_t n);

/* An archive that is written to a stream from its start; begins as {.to = stream}. */
typedef struct conic_zip_writer {
  FILE *to;
  uint32_t offset;
  int n_files, is_failed;
  struct {
    char name[CONIC_ZIP_NAME];
    uint32_t sum, n_bytes, offset;
  } files[CONIC_ZIP_MOST_FILES];
} conic_zip_writer;

/* Adds a file; 0 where writing failed, or the archive would not end before 4 GiB. */
int conic_zip_add(conic_zip_writer *writer, const char *name, const unsigned char *bytes, size_t n_bytes);
/* Writes the list; 0 where anything failed. */
int conic_zip_end(conic_zip_writer *writer);
