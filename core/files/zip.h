/* ZIP archives in memory: a file in one by its name; and writing one, of files that are stored as they are. */
#ifndef CONIC_ZIP_H
#define CONIC_ZIP_H

#include <stdint.h>
#include <stdio.h>

#include "conic/context.h"

typedef struct conic_zip {
  conic_context *context;
  const char *name; /* for messages */
  const unsigned char *bytes;
  size_t n_bytes, directory, n_entries; /* where the list of its files begins, and how many there are */
} conic_zip;

/* Looks for the list at the archive's end; `bytes` must outlive *zip. Errors: INPUT. */
conic_status conic_zip_open(conic_context *context, const char *name, const unsigned char *bytes, size_t n_bytes,
                            conic_zip *zip);

/* Whether the archive has a file of that name, whatever folder it lies in. */
int conic_zip_has(const conic_zip *zip, const char *file);

/* Its contents, whose sum is right, in a block that the caller releases; no more than `most_bytes`. Errors: INPUT,
 * MEMORY, UNSUPPORTED (it is deflated, and zlib is not there). */
conic_status conic_zip_read(const conic_zip *zip, const char *file, size_t most_bytes, unsigned char **contents,
                            size_t *n_contents);

/* The sum of ZIP, gzip and PNG. */
uint32_t conic_zip_sum(const unsigned char *bytes, size_t n);

enum { CONIC_ZIP_MOST_FILES = 16 };

/* An archive that is being written to a stream from its start; begins as {.to = stream}. */
typedef struct conic_zip_writer {
  FILE *to;
  uint32_t offset;
  int n_files, is_failed;
  struct {
    char name[40];
    uint32_t sum, n_bytes, offset;
  } files[CONIC_ZIP_MOST_FILES];
} conic_zip_writer;

/* Adds a file; 0 where writing failed, or the archive would not end before 4 GiB. */
int conic_zip_add(conic_zip_writer *writer, const char *name, const unsigned char *bytes, size_t n_bytes);
/* Writes the list; 0 where anything failed. */
int conic_zip_end(conic_zip_writer *writer);

#endif
