/* The records of an E57 scan: a stream of bits for each column, in packets. */
#ifndef CONIC_E57_RECORDS_H
#define CONIC_E57_RECORDS_H

#include "core/scans/e57_tree.h"

enum { CONIC_E57_BLOCK = 256 };

/* Bytes of a column that have come and are not decoded yet. */
typedef struct conic_e57_stream {
  unsigned char *bytes;
  size_t n, room;
  uint64_t bit; /* where the next value begins, from the first byte on */
  int is_wanted;
} conic_e57_stream;

typedef struct conic_e57_records {
  conic_e57_file *file;
  const conic_e57_scan *scan;
  uint64_t packet; /* offset of the next, in the file */
  uint64_t n_left; /* records */
  conic_e57_stream streams[CONIC_E57_MOST_COLUMNS];
} conic_e57_records;

/* Begins with the first record; then the caller says which streams it wants, whose columns take some bits together.
 * What it begins is closed, on failure too. Errors: INPUT. */
conic_status conic_e57_records_open(conic_e57_file *file, const conic_e57_scan *scan, conic_e57_records *records);
void conic_e57_records_close(conic_e57_records *records);

/* How many of the next records are there, CONIC_E57_BLOCK at most; 0: no more are left. Errors: INPUT, MEMORY. */
conic_status conic_e57_records_fill(conic_e57_records *records, size_t *n);

/* The next n values of a column that is wanted, no more than are there. */
void conic_e57_records_take(conic_e57_records *records, int column, size_t n, double *values);

#endif
