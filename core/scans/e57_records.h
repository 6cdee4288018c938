/* The records of an E57 scan: a stream of bits for each column, in packets. */
#ifndef CONIC_E57_RECORDS_H
#define CONIC_E57_RECORDS_H

#include "core/scans/e57_tree.h"

enum { CONIC_E57_BLOCK = 256 };

/* Bytes of a column that have been read and not yet decoded. */
typedef struct conic_e57_stream {
  unsigned char *bytes;
  size_t n, room;
  uint64_t bit; /* of the next value, from the first byte on */
  int is_wanted;
} conic_e57_stream;

typedef struct conic_e57_records {
  conic_e57_file *file;
  const conic_e57_scan *scan;
  uint64_t packet; /* offset of the next packet in the file */
  uint64_t n_left; /* records */
  conic_e57_stream streams[CONIC_E57_MOST_COLUMNS];
} conic_e57_records;

/* Begins with the first record. The caller then says which streams it wants; their columns together take some bits a
 * record. The caller closes it, on failure too. Errors: INPUT. */
conic_status conic_e57_records_open(conic_e57_file *file, const conic_e57_scan *scan, conic_e57_records *records);
void conic_e57_records_close(conic_e57_records *records);

/* Makes the next records ready, at most CONIC_E57_BLOCK; *n says how many, 0 past the last. Errors: INPUT, MEMORY. */
conic_status conic_e57_records_fill(conic_e57_records *records, size_t *n);

/* Takes the next n values of a wanted column, at most as many as are ready. */
void conic_e57_records_take(conic_e57_records *records, int column, size_t n, double *values);

#endif
